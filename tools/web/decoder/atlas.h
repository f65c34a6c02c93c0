// Converts decoded texels to a picture that WebGL can sample.
#pragma once

#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// Receives texels of a box and writes RGBA with 8 bits per sample. Texel (u, v, s, t) is at x = (u
// - u0) * S + s, y = (v - v0) * T + t, with the row y = 0 first. Grey is copied to R, G and B,
// missing alpha is 255, and half floats are tone-mapped (tools/picture/tone_map.h).
class AtlasSink : public TexelSink {
public:
    // `box` must span all of s and t. `rgba` has 4 bytes per texel and must outlive the sink.
    AtlasSink(const TextureDesc& desc, const Box4& box, std::span<std::byte> rgba);
    Status write(const Box4& box, std::span<const std::byte> texels) override;

private:
    using PlaceWriter = void (*)(const std::uint8_t* texels, std::uint32_t ns, std::uint32_t nt,
                                 std::uint8_t* rgba, std::size_t stride);
    static PlaceWriter place_writer(const TextureDesc& desc);

    std::size_t texel_bytes_;
    Box4 box_;
    std::span<std::byte> rgba_;
    PlaceWriter write_place_;
};

} // namespace tessera
