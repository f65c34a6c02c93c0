#include "codec/trials/background.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

namespace tessera {
namespace {

constexpr std::size_t stride = 16; // texels

// Adds how often each texel that matters is there.
void count_runs(const TileTexels& tile, std::size_t size,
                std::unordered_map<std::uint64_t, std::uint64_t>& counts) {
    const std::byte* const texels = tile.texels.data();
    const std::size_t count = tile.texels.size() / size;
    const bool all_matter = tile.matters.empty();
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
        end = begin + 1;
        if (!all_matter && tile.is_free(begin))
            continue;
        const std::byte* const first = texels + begin * size;
        // Long runs in strides.
        while (all_matter && end + stride <= count &&
               std::memcmp(texels + (end - 1) * size, texels + end * size, stride * size) == 0)
            end += stride;
        while (end < count && (all_matter || !tile.is_free(end)) &&
               std::memcmp(first, texels + end * size, size) == 0)
            ++end;
        std::uint64_t texel = 0;
        for (std::size_t i = 0; i < size; ++i)
            texel |= std::to_integer<std::uint64_t>(first[i]) << (8 * i);
        counts[texel] += end - begin;
    }
}

} // namespace

std::array<std::uint16_t, 4> find_background(const Sample& sample, const TextureDesc& desc) {
    std::unordered_map<std::uint64_t, std::uint64_t> counts;
    const std::size_t size = desc.texel_bytes();
    for (const TileTexels& tile : sample.tiles)
        count_runs(tile, size, counts);
    const auto most = std::max_element(
        counts.begin(), counts.end(), [](const auto& a, const auto& b) { // of equals the smallest
            return std::pair(a.second, b.first) < std::pair(b.second, a.first);
        });
    std::array<std::uint16_t, 4> background{};
    const int bits = 8 * static_cast<int>(sample_bytes(desc.type));
    for (int c = 0; c < desc.channels && most != counts.end(); ++c)
        background[static_cast<std::size_t>(c)] =
            static_cast<std::uint16_t>(most->first >> (bits * c) & ((1u << bits) - 1));
    return background;
}

} // namespace tessera
