// The light that arrives at a place, as far as diffuse reflection depends on it.
#pragma once

#include "corpus/trace/lobes.h"

#include <array>

namespace tessera::corpus {

// Real spherical harmonics up to degree 2 (Ramamoorthi and Hanrahan, "An efficient representation for
// irradiance environment maps", 2001).
inline std::array<double, 9> harmonics_at(const glm::dvec3& d) {
    return {0.282095,
            0.488603 * d.y,
            0.488603 * d.z,
            0.488603 * d.x,
            1.092548 * d.x * d.y,
            1.092548 * d.y * d.z,
            0.315392 * (3.0 * d.z * d.z - 1.0),
            1.092548 * d.x * d.z,
            0.546274 * (d.x * d.x - d.y * d.y)};
}

// The diffuse lobe for a light at this cosine, per unit of diffuse colour.
inline double diffuse_lobe(double cosine) {
    return diffuse_colour({.diffuse = glm::dvec3(1.0)}).x * std::max(cosine, 0.0);
}

template <class Vector> struct ArrivingLight {
    Vector diffuse{0.0};              // that leaves a place without bumps, per unit of its colour
    std::array<Vector, 9> radiance{}; // in harmonics, for bumps

    ArrivingLight() = default;
    template <class Other>
    explicit ArrivingLight(const ArrivingLight<Other>& other) : diffuse(other.diffuse) {
        for (std::size_t i = 0; i < radiance.size(); ++i)
            radiance[i] = Vector(other.radiance[i]);
    }

    // Light from one direction at a place with this normal.
    void add(const glm::dvec3& direction, const glm::dvec3& light, const glm::dvec3& normal) {
        diffuse += light * diffuse_lobe(glm::dot(normal, direction));
        const std::array<double, 9> basis = harmonics_at(direction);
        for (std::size_t i = 0; i < basis.size(); ++i)
            radiance[i] += light * basis[i];
    }
    void add(const ArrivingLight& other, typename Vector::value_type share = 1) {
        diffuse += other.diffuse * share;
        for (std::size_t i = 0; i < radiance.size(); ++i)
            radiance[i] += other.radiance[i] * share;
    }
};

} // namespace tessera::corpus
