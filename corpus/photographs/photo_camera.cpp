#include "corpus/photographs/photo_camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace tessera::corpus {
namespace {

constexpr int most_newton_steps = 30;
constexpr double newton_precision = 1e-15; // of tangents
constexpr double least_slope = 1e-9;       // of the distortion, where it is not a fold

} // namespace

glm::dvec2 LensDistortion::distort(const glm::dvec2& p) const {
    const double r2 = glm::dot(p, p), xy = p.x * p.y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)));
    return {p.x * radial + 2 * p1 * xy + p2 * (r2 + 2 * p.x * p.x),
            p.y * radial + 2 * p2 * xy + p1 * (r2 + 2 * p.y * p.y)};
}

glm::dmat2 LensDistortion::slopes(const glm::dvec2& p) const {
    const double r2 = glm::dot(p, p);
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)));
    const double growth = 2 * (k1 + r2 * (2 * k2 + r2 * (3 * k3 + r2 * 4 * k4))); // by r2, doubled
    const double across = p.x * p.y * growth + 2 * p1 * p.x + 2 * p2 * p.y;
    return {{radial + p.x * p.x * growth + 2 * p1 * p.y + 6 * p2 * p.x, across},
            {across, radial + p.y * p.y * growth + 2 * p2 * p.x + 6 * p1 * p.y}};
}

glm::dvec2 LensDistortion::undistort(const glm::dvec2& distorted) const {
    if (is_none())
        return distorted;
    glm::dvec2 p = distorted;
    for (int i = 0; i < most_newton_steps; ++i) {
        const glm::dvec2 gap = distorted - distort(p);
        const glm::dmat2 slope = slopes(p);
        const double size = glm::determinant(slope);
        if (!(size > least_slope) || !(glm::dot(gap, gap) > newton_precision * newton_precision))
            break;
        p += glm::inverse(slope) * gap;
    }
    return p;
}

bool LensDistortion::is_inside(const glm::dvec2& point) const {
    if (is_none())
        return true;
    // Newton's method starts at the distorted point and finds the root nearest to the axis.
    const glm::dvec2 gap = undistort(distort(point)) - point;
    return glm::dot(gap, gap) <= 1e-16 * (1 + glm::dot(point, point));
}

glm::dvec3 PhotoCamera::direction(double x, double y) const {
    const glm::dvec2 p = distortion.undistort({(x - cx) / fx, (y - cy) / fy});
    return glm::normalize(axes * glm::dvec3(p, 1.0));
}

std::optional<glm::dvec2> PhotoCamera::project(const glm::dvec3& place) const {
    const glm::dvec3 seen = (place - eye) * axes; // by the transposed matrix
    if (!(seen.z > 0))
        return std::nullopt;
    const glm::dvec2 p = glm::dvec2(seen) / seen.z;
    if (!(glm::dot(p, p) < 1e12) || !distortion.is_inside(p))
        return std::nullopt;
    const glm::dvec2 distorted = distortion.distort(p);
    return glm::dvec2(cx + fx * distorted.x, cy + fy * distorted.y);
}

std::array<glm::dvec3, 2> PhotoCamera::turns(const glm::dvec3& towards) const {
    glm::dmat2 back(1.0);
    if (!distortion.is_none()) {
        const glm::dvec3 seen = towards * axes;
        const glm::dmat2 slope = distortion.slopes(glm::dvec2(seen) / seen.z);
        if (glm::determinant(slope) > least_slope)
            back = glm::inverse(slope);
    }
    return {axes * glm::dvec3(back[0] / fx, 0.0), axes * glm::dvec3(back[1] / fy, 0.0)};
}

PhotoCamera PhotoCamera::resized(std::uint32_t to_width, std::uint32_t to_height) const {
    const double x = static_cast<double>(to_width) / width;
    const double y = static_cast<double>(to_height) / height;
    PhotoCamera other = *this;
    other.width = to_width;
    other.height = to_height;
    other.fx *= x;
    other.cx *= x;
    other.fy *= y;
    other.cy *= y;
    return other;
}

} // namespace tessera::corpus
