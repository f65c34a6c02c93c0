// Checks whether an output can be written, and creates its folders.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tessera {

// Whether the name is that of a binary glTF file: x.glb.
bool is_glb_name(const std::string& path);

// Whether a file can be written to `path`: the path does not exist or is a regular file that may be
// written, and its folder exists, or can be created, and has room. A device or a folder is refused,
// because the final rename would destroy it or fail. Writes nothing. Errors: io; bad_argument (a
// URL).
Status check_output_path(const std::string& path);

// The part of that check that concerns the folders on the path, also behind a link. `bytes`: how
// many are going to be written at least.
Status check_parent_folders(const std::string& path, std::uint64_t bytes = 1);

// Creates the missing folders on the path. Errors: io.
Status make_parent_folders(const std::string& path);

// Writes a file and renames it into place when it is complete. Errors: io.
Status write_bytes(const std::string& path, std::span<const std::byte> bytes);

} // namespace tessera
