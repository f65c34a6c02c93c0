// Random numbers of one light path. They come from hashes, so they do not depend on threads or
// order.
//
// The first two dimensions of Sobol's sequence with Owen scrambling by hashes, repeated with other
// scrambling for each further pair of dimensions (Burley 2020). The first n paths of a sequence
// cover every pair evenly.
#pragma once

#include "corpus/pattern.h"

#include <glm/vec2.hpp>

namespace tessera::corpus {

class PathRandom {
public:
    // All paths that are averaged have the same `sequence`.
    PathRandom(std::uint64_t sequence, std::uint32_t path)
        : sequence_(sequence), reversed_path_(reversed(path)) {}

    glm::dvec2 next2() {
        const std::uint64_t bits = mix_bits(sequence_ + ++dimension_ * 0x9E3779B97F4A7C15u);
        const auto seed = static_cast<std::uint32_t>(bits);
        const std::uint32_t index = scrambled(reversed_path_, seed);
        const auto seed_u = static_cast<std::uint32_t>(bits >> 32);
        const auto seed_v = static_cast<std::uint32_t>(mix_bits(bits));
        return {unit(scrambled(index, seed_u)), unit(scrambled(reversed_sobol(index), seed_v))};
    }
    double next() { return next2().x; }

private:
    static double unit(std::uint32_t x) { return (static_cast<double>(x) + 0.5) * 0x1p-32; }
    static std::uint32_t reversed(std::uint32_t x) {
        x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
        x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
        x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
        x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
        return x << 16 | x >> 16;
    }
    // The second dimension of Sobol's sequence, its bits in reversed order. The vector of bit j is the
    // polynomial (1 + x)^j modulo 2, so the sum of those of an index is the index as a polynomial in
    // 1 + x.
    static std::uint32_t reversed_sobol(std::uint32_t index) {
        index ^= index >> 1 & 0x55555555u;
        index ^= index >> 2 & 0x33333333u;
        index ^= index >> 4 & 0x0F0F0F0Fu;
        index ^= index >> 8 & 0x00FF00FFu;
        return index ^ index >> 16;
    }
    // Scrambles the number with these bits in reversed order. The higher bits decide whether a bit is
    // flipped (Laine and Karras).
    static std::uint32_t scrambled(std::uint32_t reversed_bits, std::uint32_t seed) {
        std::uint32_t x = reversed_bits + seed;
        x ^= x * 0x6C50B47Cu;
        x ^= x * 0xB82F1E52u;
        x ^= x * 0xC7AFE638u;
        x ^= x * 0x8D22F6E6u;
        return reversed(x);
    }

    std::uint64_t sequence_, dimension_ = 0;
    std::uint32_t reversed_path_;
};

} // namespace tessera::corpus
