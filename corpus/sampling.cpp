#include "corpus/sampling.h"

#include <cmath>
#include <numbers>

namespace tessera::corpus {
namespace {

using std::numbers::pi;

double span_of(int axis) {
    return axis == axis_u ? 2.0 * pi : pi;
}

// An additive recurrence with the powers of 1/g, where g^5 = g + 1 is the golden ratio of four
// dimensions. The first n points are evenly spread for every n.
std::vector<Jitter> spread_points(unsigned count) {
    constexpr double g = 1.1673039782614187;
    std::vector<Jitter> points(count);
    for (unsigned i = 0; i < count; ++i) {
        double step = 1.0;
        for (std::uint8_t& coordinate : points[i]) {
            step /= g;
            const double x = 0.5 + step * i;
            coordinate = static_cast<std::uint8_t>((x - std::floor(x)) * 256.0);
        }
    }
    return points;
}

} // namespace

Sampler::Sampler(const Extent4& size, unsigned samples, std::uint64_t seed)
    : size_(size), seed_(mix_bits(seed)), points_(spread_points(samples)) {
    for (int axis = 0; axis < 4; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        half_width_[a] = span_of(axis) / size_[a] / 2.0;
        for (std::size_t i = 0; i < 256 && samples > 1; ++i) {
            const double angle = ((static_cast<double>(i) + 0.5) / 128.0 - 1.0) * half_width_[a];
            offset_[a][i] = {std::sin(angle), std::cos(angle)};
        }
    }
}

SinCos Sampler::centre(int axis, std::uint32_t index) const {
    const double angle =
        span_of(axis) * ((index + 0.5) / size_[static_cast<std::size_t>(axis)] - 0.5);
    return {std::sin(angle), std::cos(angle)};
}

Jitter Sampler::rotation(std::uint64_t key) const {
    const std::uint64_t bits = mix_bits(key ^ seed_);
    return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 16),
            static_cast<std::uint8_t>(bits >> 32), static_cast<std::uint8_t>(bits >> 48)};
}

Angles Sampler::angles(const Angles& centre, unsigned sample, const Jitter& rotation) const {
    const Jitter& point = points_[sample];
    Angles result;
    for (std::size_t a = 0; a < 4; ++a)
        result[a] = sum_of(centre[a], offset_[a][(point[a] + rotation[a]) & 255u]);
    return result;
}

glm::dvec3 place_normal(const SinCos& longitude, const SinCos& latitude) {
    return {longitude.sin * latitude.cos, latitude.sin, longitude.cos * latitude.cos};
}

Ray window_ray(const SphereWindow& window, const Angles& angles) {
    const auto& [longitude, latitude, alpha, beta] = angles;
    const glm::dvec3 ez = place_normal(longitude, latitude);
    const glm::dvec3 ex{longitude.cos, 0.0, -longitude.sin};
    const glm::dvec3 ey{-longitude.sin * latitude.sin, latitude.cos, -longitude.cos * latitude.sin};
    const glm::dvec3 d = ex * (alpha.sin * beta.cos) + ey * beta.sin + ez * (alpha.cos * beta.cos);
    return {window.centre + ez * (window.inside ? -window.radius : window.radius), -d};
}

} // namespace tessera::corpus
