// Procedural textures. They use only an integer hash and + - * floor on doubles, so the result is
// the same on every machine. Pure and thread-safe.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace tessera::corpus {

enum class Pattern : std::uint8_t { flat, checker, stripes, noise, bricks, tiles };

// A hash of `x`: the finaliser of splitmix64.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

// The share of the second colour at `q`, 0..1. One unit of `q` is one pattern cell; |q| < 2^30.
double pattern_weight(Pattern pattern, const glm::dvec3& q);

// Smooth noise in 0..1: two octaves of value noise. The coarser one has one knot per unit of `q`.
double value_noise(const glm::dvec3& q);

} // namespace tessera::corpus
