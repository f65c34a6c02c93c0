// Random numbers and directions in double precision.
#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <random>

namespace tessera::test {

inline std::mt19937_64 generator(std::uint64_t seed) {
    return std::mt19937_64{seed};
}

inline double uniform(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

inline glm::dvec3 unit_vector(std::mt19937_64& random) {
    for (;;) {
        const glm::dvec3 x{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
        const double length = glm::length(x);
        if (length > 0.1 && length <= 1.0)
            return x / length;
    }
}

} // namespace tessera::test
