// Positions and directions that are difficult to sample at, and the accuracy that single precision
// can reach there. Shared by the tests of the CPU's and the GPU's sampler.
#pragma once

#include "format/sampler.h"
#include "tests/support/angular_maps.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace tessera::test {

constexpr double pi = std::numbers::pi;

inline glm::dvec3 texel_normal(const Extent4& size, std::uint32_t u, std::uint32_t v) {
    return sphere_normal((u + 0.5) / size[axis_u], (v + 0.5) / size[axis_v]);
}

struct Probe {
    glm::vec3 n, d; // single precision: the exact input of both samplers
};

class ProbeMaker {
public:
    explicit ProbeMaker(const Extent4& size) : size_(size) {}

    // Goes through all pairs of a kind of position and a kind of direction.
    Probe make(unsigned i) {
        const glm::dvec3 n = place(i % 5);
        const glm::dvec3 d = direction(i / 5 % 5, n);
        return {glm::vec3(n * std::exp(real(-5, 5))), glm::vec3(d)};
    }

private:
    double real(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    // Random sign; the bound of the magnitude is random, 10^-9 to 10^-1.
    double tiny() { return real(-1, 1) * std::pow(10, real(-9, -1)); }

    glm::dvec3 place(unsigned kind) {
        const double u = real(0, 1), v = std::asin(real(-1, 1)) / pi + 0.5;
        const auto grid = [&](double x, std::uint32_t n) { // borders and centres of texels
            return std::round(x * n * 2) / (n * 2) + tiny() / n;
        };
        switch (kind) {
        case 0:
            return sphere_normal(u, v);
        case 1:
            return sphere_normal(grid(u, size_[axis_u]), grid(v, size_[axis_v]));
        case 2:
            return sphere_normal(tiny(), v);
        case 3:
            return sphere_normal(u, u < 0.5 ? std::abs(tiny()) : 1 - std::abs(tiny()));
        default: // on the axis except for rounding
            return {tiny() * 1e-6, u < 0.5 ? 1 : -1, u < 0.25 ? 0 : tiny() * 1e-6};
        }
    }

    glm::dvec3 direction(unsigned kind, const glm::dvec3& n) {
        const glm::dvec2 at = sphere_place(n);
        const auto texel = [](double x, std::uint32_t count) {
            return std::min(static_cast<std::uint32_t>(x * count), count - 1);
        };
        const SurfaceFrame frame = surface_frame(
            texel_normal(size_, texel(at.x, size_[axis_u]), texel(at.y, size_[axis_v])));
        double s = real(0, 1), t = real(0, 1);
        if (kind == 1) { // borders and centres of texels
            s = std::round(s * size_[axis_s] * 2) / (size_[axis_s] * 2) + tiny();
            t = std::round(t * size_[axis_t] * 2) / (size_[axis_t] * 2) + tiny();
        } else if (kind == 2) { // grazing
            (real(0, 1) < 0.5 ? s : t) = real(0, 1) < 0.5 ? tiny() : 1 + tiny();
        } else if (kind == 3) { // at +-ey or near it
            t = (real(0, 1) < 0.5 ? 0 : 1) + (real(0, 1) < 0.2 ? 0 : tiny());
        } else if (kind == 4) { // into the surface
            s = real(1, 2);
        }
        return outgoing_direction(frame, s, t);
    }

    Extent4 size_;
    std::mt19937_64 random_{7};
};

// How well a probe is conditioned in single precision.
struct Condition {
    // The smallest length of d in the plane of ez and ex, over the surface texels that are sampled.
    double planar = 1;
    // True if, at one of them, d points into the surface and its x is 0 up to rounding. Then s is 0
    // or 1 arbitrarily.
    bool jumps = false;
};

inline Condition condition_of(const Extent4& size, const Probe& p) {
    Condition c;
    const glm::dvec3 d = glm::normalize(glm::dvec3(p.d));
    for (const WeightedTexel& w : sample_footprint(size, p.n, p.d)) {
        const SurfaceFrame frame = surface_frame(texel_normal(size, w.u, w.v));
        const double x = glm::dot(frame.ex, d), z = glm::dot(frame.ez, d);
        c.planar = std::min(c.planar, std::hypot(x, z));
        c.jumps = c.jumps || (z < 1e-6 && std::abs(x) < 1e-6);
    }
    return c;
}

} // namespace tessera::test
