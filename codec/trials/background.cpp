#include "codec/trials/background.h"

#include <algorithm>
#include <map>

namespace tessera {

std::array<std::uint16_t, 4> find_background(const Sample& sample, const TextureDesc& desc) {
    std::map<std::uint64_t, std::uint64_t> counts;
    const std::size_t size = desc.texel_bytes();
    std::uint64_t previous = 0, run = 0;
    const auto flush = [&] {
        if (run > 0)
            counts[previous] += run;
    };
    for (const auto& tile : sample.tiles) {
        const auto& texels = tile.texels;
        for (std::size_t at = 0; at < texels.size(); at += size) {
            if (tile.is_free(at / size))
                continue;
            std::uint64_t texel = 0;
            for (std::size_t i = 0; i < size; ++i)
                texel |= std::to_integer<std::uint64_t>(texels[at + i]) << (8 * i);
            if (texel != previous) {
                flush();
                previous = texel;
                run = 0;
            }
            ++run;
        }
    }
    flush();
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](auto& a, auto& b) { return a.second < b.second; });
    std::array<std::uint16_t, 4> background{};
    const int bits = 8 * static_cast<int>(sample_bytes(desc.type));
    for (int c = 0; c < desc.channels && most != counts.end(); ++c)
        background[static_cast<std::size_t>(c)] =
            static_cast<std::uint16_t>(most->first >> (bits * c) & ((1u << bits) - 1));
    return background;
}

} // namespace tessera
