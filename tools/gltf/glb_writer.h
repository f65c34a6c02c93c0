// Writes a .glb that any viewer of glTF shows, and that carries a .tess file (format/gltf/README.md).
#pragma once

#include "format/work.h"
#include "tools/support/json_text.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace tessera {

struct GlbOptions {
    bool draco = false;                // compress the mesh
    std::optional<int> jpeg_quality;   // 1..100: the picture is a JPEG; absent: a PNG
    std::uint32_t picture_side = 1024; // most pixels along a side of the picture
    unsigned threads = 0;              // 0: all cores; does not affect the bytes
    ProgressFunction progress{};
};

// What was written, in bytes.
struct GlbReport {
    std::uint64_t file = 0, mesh = 0, picture = 0, texture = 0;
    std::uint32_t width = 0, height = 0; // of the picture, in pixels
    const char* picture_kind = "PNG";
};

// Writes the .tess file `input` with its mesh and a picture of it to `output`, which appears when it
// is complete. `bytes` are those of the file if it is in memory; then `input` only names it. `input`
// is anything that open_tess_bytes() reads, also a .glb. The picture is the mean over the observers
// (draw_mean_picture()), which includes mirrored light. A surface with holes gets a PNG with alpha,
// because a JPEG has none. Errors: unsupported (the texture does not lie on a mesh, or the .glb
// would have 4 GiB); those of reading and drawing the file; io.
Result<GlbReport> write_glb(const std::string& input, std::span<const std::byte> bytes,
                            const std::string& output, const GlbOptions& options);

// "1.2 MB: mesh 30.1 kB, PNG of 512x512 401.2 kB, texture 168.2 kB"
std::string to_string(const GlbReport& report);
Json to_json(const GlbReport& report);

// What is missing from a file without a mesh, for messages of the tool.
inline constexpr const char* needs_mesh =
    "a .glb needs a mesh; bake with --proxy mesh, bake a model, or encode with --mesh";

} // namespace tessera
