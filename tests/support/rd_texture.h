// A small texture for tests of `tessera rd`.
#pragma once

#include "tools/lab/rd/rd_texture.h"

#include <cstddef>
#include <cstdint>

namespace tessera::test {

inline RdTexture small_texture(const Extent4& size = {8, 6, 5, 4}) {
    RdTexture texture;
    texture.name = "small, \"odd\".rgb";
    texture.label = "small";
    texture.desc = {size, SampleType::unorm8, 3};
    texture.texels.resize(texture.texel_count() * 3, std::byte{128});
    for (std::size_t i = 0; i < texture.texels.size() / 3; ++i) // three in four are background
        if (i % 4 == 0)
            for (std::size_t c = 0; c < 3; ++c)
                texture.texels[3 * i + c] = std::byte(static_cast<std::uint8_t>(i * (c + 3) % 200));
    describe_texels(texture);
    return texture;
}

} // namespace tessera::test
