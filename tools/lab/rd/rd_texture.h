// The texture that all codecs encode, held in memory.
#pragma once

#include "codec/encoder.h" // ProgressFunction
#include "format/texture.h"
#include "tools/support/texture_hints.h"
#include "tools/view/view_renderer.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct TextureRequest {
    std::string name;       // a texture file, a URL or a built-in scene
    unsigned samples = 16;  // rays per texel, for a scene
    bool on_sphere = false; // assume the scenes' sphere for a file that declares no surface
    bool crop = false;      // read only a small box in the middle
    TextureHints hints;     // hints.size also applies to a scene
};

struct RdTexture {
    std::string name;  // as requested
    std::string label; // usable as part of a file name
    TextureDesc desc;
    std::vector<std::byte> texels;      // dense, in the order of texture.h
    std::optional<SphereWindow> window; // absent: no views can be drawn
    std::string crop;                   // the box that was cut out, or empty
    std::string checksum;               // covers size, type and texels
    std::vector<std::byte> background;  // the most frequent texel value
    double background_share = 0;        // fraction of all texels, 0..1

    std::uint64_t texel_count() const { return tessera::texel_count(desc.size); }
    const std::byte* texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                           std::uint32_t t) const;
};

constexpr std::uint64_t max_rd_bytes = 4ull << 30; // texels; each codec needs two more copies

// Accepts the name of a file, a URL or a built-in scene. Reads no file. Errors: bad_argument, with
// the nearest scene.
Status check_rd_name(const std::string& name);

// Errors: bad_argument; unsupported, if the texture is larger than max_rd_bytes; those of reading.
Result<RdTexture> load_rd_texture(const TextureRequest& request, const ProgressFunction& progress);

// Computes the checksum and the background from the texels.
void describe_texels(RdTexture& texture);

} // namespace tessera
