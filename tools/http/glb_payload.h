// Finds the .tess file that a binary glTF file carries (format/gltf/README.md).
#pragma once

#include "format/byte_source.h"
#include "format/status.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

inline constexpr const char* glb_extension = "TESSERA_texture_light_field";
inline constexpr const char* tess_mime_type = "application/vnd.tessera";

// Where the .tess file is in a .glb, in bytes. It may reach beyond the end of a file that is cut
// short.
struct GlbPayload {
    std::uint64_t offset = 0, length = 0;
};

// A name such as "scene.glb#1": the textures of a .glb with this extension are counted from 0.
struct GlbName {
    std::string file;
    std::optional<std::size_t> texture;
};
// Only names of .glb files have such an end. A path that exists as it is has none. Of a URL, the number
// is the fragment.
GlbName split_glb_name(const std::string& name);

// Reads the head and the JSON of a .glb, and returns the places of its textures with the extension, at
// least one. Errors, all with the source's name: invalid_file, with the place in the JSON; bad_argument
// (no texture has the extension); unsupported (glTF 1.0, JSON of more than 16 MiB); those of reading.
Result<std::vector<GlbPayload>> find_glb_payloads(ByteSource& file);

bool is_glb(ByteSource& file);

// The .tess file inside `file` if that is a .glb, under the same name; any other `file` as it is.
// texture: which one, counted from 0; absent: there must be only one. Errors: those of
// find_glb_payloads(); bad_argument (there is no such texture, or which of several is meant).
Result<std::unique_ptr<ByteSource>> unpack_glb(std::unique_ptr<ByteSource> file,
                                               std::optional<std::size_t> texture);

// The .glb that unpack_glb() found `source` in, or `source` itself.
const ByteSource& whole_file(const ByteSource& source);

} // namespace tessera
