// Where outputs go: whether a file may be written there, and the folders on the way to it.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <span>
#include <string>

namespace tessera {

// Whether a file may be written there: a plain file or nothing, in a folder that exists or can be made.
// Renaming over a device or a folder would destroy it or fail after all the work. Writes nothing.
// Errors: io; bad_argument (a URL).
Status check_output_path(const std::string& path);

// The part of it that is about the folders that lead there.
Status check_parent_folders(const std::string& path);

// Makes those that are missing. Errors: io.
Status make_parent_folders(const std::string& path);

// A whole file, renamed into place when it is complete. Errors: io.
Status write_bytes(const std::string& path, std::span<const std::byte> bytes);

} // namespace tessera
