// The texels of a tile and their mask.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tessera {

// The number of masked texels.
inline std::uint64_t free_count(std::span<const std::byte> matters) {
    return static_cast<std::uint64_t>(std::ranges::count(matters, std::byte{0}));
}

// Whether a texel is masked. An empty mask masks none.
inline bool is_free(std::span<const std::byte> matters, std::size_t texel) {
    return !matters.empty() && matters[texel] == std::byte{0};
}

// Clears a mask that masks no texel.
inline void forget_needless_mask(std::vector<std::byte>& matters) {
    if (free_count(matters) == 0)
        matters.clear();
}

// Both members are dense boxes.
struct TileTexels {
    std::vector<std::byte> texels;
    // One byte per texel; 0 masks it: it may decode to any value. Empty: no texel is masked.
    std::vector<std::byte> matters;

    bool is_free(std::size_t texel) const { return tessera::is_free(matters, texel); }
    // Gives masked texels the values that they have in `others`.
    void replace_free(std::size_t texel_bytes, std::span<const std::byte> others) {
        for (std::size_t i = 0; i < matters.size(); ++i)
            if (is_free(i))
                std::memcpy(&texels[i * texel_bytes], &others[i * texel_bytes], texel_bytes);
    }
};

} // namespace tessera
