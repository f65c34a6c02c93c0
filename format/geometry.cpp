#include "format/sampler.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera {
namespace {

constexpr double pi = std::numbers::pi;
constexpr glm::dvec3 up{0.0, 1.0, 0.0};

double clamped_asin(double x) {
    return std::asin(std::clamp(x, -1.0, 1.0));
}

} // namespace

SurfaceFrame surface_frame(const glm::dvec3& normal) {
    const glm::dvec3 horizontal = glm::cross(up, normal);
    const double length = glm::length(horizontal);
    // Below this the direction of `horizontal` is rounding noise.
    const glm::dvec3 ex = length > 1e-12 ? horizontal / length : glm::dvec3{1.0, 0.0, 0.0};
    return {ex, glm::cross(normal, ex), normal};
}

glm::dvec3 sphere_normal(double u, double v) {
    const double longitude = u * 2.0 * pi - pi;
    const double latitude = v * pi - pi / 2.0;
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
            std::cos(longitude) * std::cos(latitude)};
}

SurfaceFrame sphere_frame(Proxy proxy, double u, double v) {
    const glm::dvec3 outwards = sphere_normal(u, v);
    return surface_frame(proxy == Proxy::sphere_inside ? -outwards : outwards);
}

glm::dvec2 sphere_place(const glm::dvec3& from_centre) {
    const double longitude = from_centre.x == 0.0 && from_centre.z == 0.0
                                 ? 0.0
                                 : std::atan2(from_centre.x, from_centre.z);
    const double u = (longitude + pi) / (2.0 * pi);
    const double v = (clamped_asin(from_centre.y / glm::length(from_centre)) + pi / 2.0) / pi;
    return {u >= 1.0 ? 0.0 : u, v};
}

glm::dvec2 direction_angles(const SurfaceFrame& frame, const glm::dvec3& d) {
    const double x = glm::dot(frame.ex, d);
    const double z = glm::dot(frame.ez, d);
    const double planar = std::hypot(x, z);
    double s = 0.5;
    if (planar > 1e-12)
        s = z < 0.0 ? (x < 0.0 ? 0.0 : 1.0) : (clamped_asin(x / planar) + pi / 2.0) / pi;
    return {s, (clamped_asin(glm::dot(frame.ey, d)) + pi / 2.0) / pi};
}

} // namespace tessera
