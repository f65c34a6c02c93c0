// Writes a .glb that any viewer of glTF shows, and that carries .tess files (format/gltf/README.md).
#pragma once

#include "format/work.h"
#include "tools/gltf/glb_primitive.h"
#include "tools/support/json_text.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace tessera {

struct GlbOptions {
    MeshCompression mesh = MeshCompression::none;
    std::optional<int> jpeg_quality;   // 1..100: pictures are JPEGs; absent: PNGs
    std::uint32_t picture_side = 1024; // most pixels along a side of a picture
    unsigned threads = 0;              // 0: all cores; does not affect the bytes
    ProgressFunction progress{};
};

// What was written. Numbers of bytes are sums over all textures.
struct GlbReport {
    std::size_t textures = 0;
    std::uint64_t file = 0, mesh = 0, picture = 0, texture = 0;
    std::uint32_t width = 0, height = 0; // of the last picture, in pixels
    const char* picture_kind = "PNG";    // of the last picture
};

// A .tess file. `bytes` are its bytes if it is in memory; then `name` only names it. `name` is anything
// that open_tess_bytes() reads, also a .glb.
struct GlbInput {
    std::string name;
    std::span<const std::byte> bytes{};
};

// Writes the files with their meshes, and a picture of each, to `output`, which appears when it is
// complete. Each file is a node of its own, at the coordinates of its mesh; several of them are
// named after their files. A picture is the mean over the observers (draw_mean_picture()), which
// includes mirrored light. A surface with holes gets a PNG with alpha, because a JPEG has none. The
// triangles that a layer of opacity lets hide less than nine tenths of what is behind them somewhere are
// a primitive of their own, which blends. Errors: unsupported (a texture does not lie on a mesh, or the .glb would have
// 4 GiB); those of reading and drawing the files; io.
Result<GlbReport> write_glb(std::span<const GlbInput> inputs, const std::string& output,
                            const GlbOptions& options);

// "1.2 MB: mesh 30.1 kB, PNG of 512x512 401.2 kB, texture 168.2 kB"
std::string to_string(const GlbReport& report);
Json to_json(const GlbReport& report);

// What is missing from a file without a mesh, for messages of the tool.
inline constexpr const char* needs_mesh =
    "a .glb needs a mesh; bake with --proxy mesh, bake a model, or encode with --mesh";

} // namespace tessera
