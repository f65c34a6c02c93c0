#include "format/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

double sign_of(double x) {
    return x < 0 ? -1.0 : 1.0; // FORMAT.md 5.2: the sign of zero is +1
}

glm::dvec2 in_square(double s, double t) {
    return {std::clamp(s, 0.0, 1.0), std::clamp(t, 0.0, 1.0)};
}

// Replaces a direction into the surface by the nearest one along it, and one without length by the
// normal.
glm::dvec3 away_from(const glm::dvec3& normal, const glm::dvec3& d) {
    const glm::dvec3 out = d - std::min(0.0, glm::dot(normal, d)) * normal;
    const double length = glm::length(out);
    return length > 1e-12 ? out / length : normal;
}

glm::dvec2 hemisphere_place(const SurfaceFrame& frame, const glm::dvec3& d) {
    const double x = glm::dot(frame.ex, d), y = glm::dot(frame.ey, d);
    const double z = std::max(0.0, glm::dot(frame.ez, d)); // rounding may make it negative
    const double sum = std::abs(x) + std::abs(y) + z;
    return in_square(((x + y) / sum + 1) / 2, ((x - y) / sum + 1) / 2);
}

glm::dvec3 hemisphere_direction(const SurfaceFrame& frame, double s, double t) {
    const double x = s + t - 1, y = s - t;
    const double z = std::max(0.0, 1 - std::abs(x) - std::abs(y));
    return glm::normalize(frame.ex * x + frame.ey * y + frame.ez * z);
}

glm::dvec3 mirrored(const glm::dvec3& normal, const glm::dvec3& d) {
    return 2 * glm::dot(normal, d) * normal - d;
}

glm::dvec2 sphere_square(const glm::dvec3& r) {
    const double sum = std::abs(r.x) + std::abs(r.y) + std::abs(r.z);
    glm::dvec2 p(r.x / sum, r.z / sum);
    if (r.y < 0)
        p = {(1 - std::abs(p.y)) * sign_of(p.x), (1 - std::abs(p.x)) * sign_of(p.y)};
    return in_square((p.x + 1) / 2, (p.y + 1) / 2);
}

glm::dvec3 square_sphere(double s, double t) {
    glm::dvec2 p(2 * s - 1, 2 * t - 1);
    const double y = 1 - std::abs(p.x) - std::abs(p.y);
    if (y < 0)
        p = {(1 - std::abs(p.y)) * sign_of(p.x), (1 - std::abs(p.x)) * sign_of(p.y)};
    return glm::normalize(glm::dvec3(p.x, y, p.y));
}

} // namespace

glm::dvec2 octahedral_place(AngularMap map, const SurfaceFrame& frame, const glm::dvec3& d) {
    const glm::dvec3 out = away_from(frame.ez, d);
    return map == AngularMap::octahedral_mirrored ? sphere_square(mirrored(frame.ez, out))
                                                  : hemisphere_place(frame, out);
}

glm::dvec3 octahedral_direction(AngularMap map, const SurfaceFrame& frame, double s, double t) {
    return map == AngularMap::octahedral_mirrored ? mirrored(frame.ez, square_sphere(s, t))
                                                  : hemisphere_direction(frame, s, t);
}

} // namespace tessera
