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
    PathRandom(std::uint64_t sequence, std::uint32_t path) : sequence_(sequence), path_(path) {}

    glm::dvec2 next2() {
        const std::uint64_t bits = mix_bits(sequence_ + ++dimension_ * 0x9E3779B97F4A7C15u);
        const auto seed = static_cast<std::uint32_t>(bits);
        const std::uint32_t index = scrambled(path_, seed);
        std::uint32_t second = 0;
        for (std::uint32_t i = index, direction = 1u << 31; i != 0;
             i >>= 1, direction ^= direction >> 1)
            second ^= (i & 1u) != 0 ? direction : 0u;
        const auto seed_u = static_cast<std::uint32_t>(bits >> 32);
        const auto seed_v = static_cast<std::uint32_t>(mix_bits(bits));
        return {unit(scrambled(reversed(index), seed_u)), unit(scrambled(second, seed_v))};
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
    // The higher bits decide whether a bit is flipped (Laine and Karras).
    static std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
        x = reversed(x) + seed;
        x ^= x * 0x6C50B47Cu;
        x ^= x * 0xB82F1E52u;
        x ^= x * 0xC7AFE638u;
        x ^= x * 0x8D22F6E6u;
        return reversed(x);
    }

    std::uint64_t sequence_, dimension_ = 0;
    std::uint32_t path_;
};

} // namespace tessera::corpus
