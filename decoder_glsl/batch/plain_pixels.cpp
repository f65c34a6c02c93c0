#include "decoder_glsl/batch/plain_pixels.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace tessera {
namespace {

// The source channel of each pixel channel; 4 is the constant 1.
std::array<std::size_t, 4> channels_of(int channels) {
    switch (channels) {
    case 1:
        return {0, 0, 0, 4};
    case 2:
        return {0, 0, 0, 1};
    case 3:
        return {0, 1, 2, 4};
    default:
        return {0, 1, 2, 3};
    }
}

} // namespace

Box4 box_of_layer(const TexelPlan& plan, const Extent4& size, std::uint32_t layer) {
    const std::uint32_t folds_u = std::max(plan.folds_u, 1u);
    const std::uint32_t u = layer % folds_u * plan.fold_u, v = layer / folds_u * plan.fold_v;
    return {
        {u, v, 0, 0},
        {std::min(u + plan.fold_u, size[0]), std::min(v + plan.fold_v, size[1]), size[2], size[3]}};
}

void put_pixels(const TextureDesc& desc, const Box4& box, std::span<const std::byte> texels,
                std::uint32_t width, std::span<std::byte> pixels) {
    const std::size_t bytes = sample_bytes(desc.type);
    std::array<std::byte, 2> one{};
    store_sample(one.data(), traits_of(desc.type).one, desc.type);
    const std::array<std::size_t, 4> from = channels_of(desc.channels);
    const Extent4 n = box.extent();
    const std::byte* texel = texels.data();
    for (std::uint32_t v = 0; v < n[1]; ++v)
        for (std::uint32_t u = 0; u < n[0]; ++u)
            for (std::uint32_t t = 0; t < n[3]; ++t) {
                const std::size_t row = std::size_t{v} * n[3] + t;
                std::byte* pixel =
                    pixels.data() + (row * width + std::size_t{u} * n[2]) * 4 * bytes;
                for (std::uint32_t s = 0; s < n[2]; ++s, texel += desc.texel_bytes())
                    for (const std::size_t c : from) {
                        std::memcpy(pixel, c < 4 ? texel + c * bytes : one.data(), bytes);
                        pixel += bytes;
                    }
            }
}

} // namespace tessera
