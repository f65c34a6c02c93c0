// The texels of a tile, and which of them matter.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tessera {

// How many of the texels of a mask do not matter.
inline std::uint64_t free_count(std::span<const std::byte> matters) {
    return static_cast<std::uint64_t>(std::ranges::count(matters, std::byte{0}));
}

// An empty mask: all texels matter.
inline bool is_free(std::span<const std::byte> matters, std::size_t texel) {
    return !matters.empty() && matters[texel] == std::byte{0};
}

// So that texels that all matter are texels without a mask.
inline void forget_needless_mask(std::vector<std::byte>& matters) {
    if (free_count(matters) == 0)
        matters.clear();
}

// Both in dense box order.
struct TileTexels {
    std::vector<std::byte> texels;
    // One a texel; 0: it does not matter, and may decode to anything. Empty: all matter.
    std::vector<std::byte> matters;

    bool is_free(std::size_t texel) const { return tessera::is_free(matters, texel); }
    // Gives the texels that do not matter the values of `others`.
    void replace_free(std::size_t texel_bytes, std::span<const std::byte> others) {
        for (std::size_t i = 0; i < matters.size(); ++i)
            if (is_free(i))
                std::memcpy(&texels[i * texel_bytes], &others[i * texel_bytes], texel_bytes);
    }
};

} // namespace tessera
