// Random paths of the texels of an atlas.
#pragma once

#include "corpus/trace/path_random.h"

#include <algorithm>
#include <bit>

namespace tessera::corpus {

// Neighbouring texels have neighbouring parts of one sequence, so the paths of a group of texels
// cover all directions as evenly as those of one texel, and a filter averages their errors out
// (Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling error via
// hierarchical ordering of pixels", 2020).
class TexelPaths {
public:
    TexelPaths(std::uint64_t sequence, unsigned count, std::uint32_t u, std::uint32_t v)
        : sequence_(mix_bits(sequence + (std::uint64_t{v >> 8} << 32 | u >> 8))),
          first_((spread(u & 255u) | spread(v & 255u) << 1) *
                 std::bit_ceil(std::min(count, most))) {}

    PathRandom operator[](unsigned i) const { return {sequence_, first_ + i}; }

private:
    static constexpr unsigned most = 1u << 16; // more paths would be those of the next texel

    // The bits of a byte, at every second place.
    static constexpr std::uint32_t spread(std::uint32_t x) {
        x = (x | x << 4) & 0x0F0Fu;
        x = (x | x << 2) & 0x3333u;
        return (x | x << 1) & 0x5555u;
    }

    std::uint64_t sequence_;
    std::uint32_t first_;
};

} // namespace tessera::corpus
