// Finds the .tess file that a binary glTF file carries (format/gltf/README.md).
#pragma once

#include "format/byte_source.h"
#include "format/status.h"

#include <memory>

namespace tessera {

inline constexpr const char* glb_extension = "TESSERA_texture_light_field";
inline constexpr const char* tess_mime_type = "application/vnd.tessera";

// Where the .tess file is in a .glb, in bytes. It may reach beyond the end of a file that is cut
// short.
struct GlbPayload {
    std::uint64_t offset = 0, length = 0;
};

// Reads the head and the JSON of a .glb. Errors, all with the source's name: invalid_file, with the
// place in the JSON; bad_argument (no texture has the extension); unsupported (glTF 1.0, JSON of
// more than 16 MiB, several textures have the extension); those of reading.
Result<GlbPayload> find_glb_payload(ByteSource& file);

// The .tess file inside `file` if that is a .glb, under the same name; any other `file` as it is.
// Errors: those of find_glb_payload().
Result<std::unique_ptr<ByteSource>> unpack_glb(std::unique_ptr<ByteSource> file);

// The .glb that unpack_glb() found `source` in, or `source` itself.
const ByteSource& whole_file(const ByteSource& source);

} // namespace tessera
