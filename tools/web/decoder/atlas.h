// Decoded texels as the picture that WebGL samples.
#pragma once

#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// Takes the texels of some surface places, all directions of each, and writes RGBA with 8 bits a sample,
// rows from the top: texel (u, v, s, t) stands at x = (u - u0) * S + s, y = (v - v0) * T + t. Grey
// becomes RGB, alpha that is not there 255, half-floats are tone-mapped (tools/picture/tone_map.h).
class AtlasSink : public TexelSink {
public:
    // `box` spans all of s and t; `rgba` has 4 bytes for each of its texels and outlives the sink.
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
