// The texture that all codecs are given, whole in memory.
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
    std::string name;       // a file that the other verbs read, or a built-in scene
    unsigned samples = 16;  // of a scene, per texel
    bool on_sphere = false; // a file that does not say so lies on the scenes' sphere
    bool crop = false;      // only a small box in the middle
    TextureHints hints;     // the size is also that of a scene
};

struct RdTexture {
    std::string name;  // as asked for
    std::string label; // a part of a file's name
    TextureDesc desc;
    std::vector<std::byte> texels;      // dense, order as in texture.h
    std::optional<SphereWindow> window; // absent: no views can be drawn
    std::string crop;                   // the box that was cut out, or empty
    std::string checksum;               // of size, type and texels
    std::vector<std::byte> background;  // the texel that occurs most often
    double background_share = 0;        // of all texels

    std::uint64_t texel_count() const { return tessera::texel_count(desc.size); }
    const std::byte* texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                           std::uint32_t t) const;
};

constexpr std::uint64_t max_rd_bytes = 4ull << 30; // of texels; each codec needs them twice more

// Whether a texture may have this name: a file's, a URL or that of a scene. Reads nothing. Errors:
// bad_argument, with the nearest scene.
Status check_rd_name(const std::string& name);

// Errors: bad_argument; unsupported, where it is larger than max_rd_bytes; those of reading it.
Result<RdTexture> load_rd_texture(const TextureRequest& request, const ProgressFunction& progress);

// Fills in what follows from the texels: checksum, background.
void describe_texels(RdTexture& texture);

} // namespace tessera
