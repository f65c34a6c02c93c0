#include "corpus/scene.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

// Moves the borders of pattern cells off the faces of boxes and off the origin. Otherwise rounding
// would decide on which side of a border a whole face lies.
constexpr glm::dvec3 pattern_origin{0.137, 0.291, 0.433};

Object place(Shape shape, const glm::dvec3& centre, const glm::dvec3& half, double bound,
             const Material& material) {
    return {.shape = shape, .centre = centre, .half = half, .bound = bound, .material = material};
}

// Rodrigues' formula.
glm::dmat3 rotation(const glm::dvec3& axis, double degrees) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const glm::dmat3 cross{0.0, axis.z, -axis.y, -axis.z, 0.0, axis.x, axis.y, -axis.x, 0.0};
    return glm::dmat3{1.0} * c + cross * s + glm::outerProduct(axis, axis) * (1.0 - c);
}

} // namespace

Object sphere(const glm::dvec3& centre, double radius, const Material& material) {
    return place(Shape::sphere, centre, glm::dvec3{radius}, radius, material);
}

Object cylinder(const glm::dvec3& centre, double radius, double height, const Material& material) {
    const double half_height = height / 2.0;
    return place(Shape::cylinder, centre, {radius, half_height, radius},
                 std::hypot(radius, half_height), material);
}

Object box(const glm::dvec3& centre, const glm::dvec3& sides, const Material& material) {
    return place(Shape::box, centre, sides / 2.0, glm::length(sides) / 2.0, material);
}

Object plane(const glm::dvec3& centre, double width, double depth, const Material& material) {
    return place(Shape::plane, centre, {width / 2.0, 0.0, depth / 2.0},
                 std::hypot(width, depth) / 2.0, material);
}

Object turned(Object object, const glm::dvec3& axis, double degrees) {
    object.to_local = object.to_local * glm::transpose(rotation(axis, degrees));
    object.rotated = true;
    return object;
}

double front_of(const Object& plane) {
    return (plane.to_local * plane.centre).y > 0.0 ? -1.0 : 1.0;
}

glm::dvec3 surface_colour(const Material& m, const glm::dvec3& local) {
    glm::dvec3 colour = m.colour;
    const glm::dvec3 q = local * m.cells + pattern_origin;
    if (m.pattern != Pattern::flat)
        colour += (m.colour2 - m.colour) * pattern_weight(m.pattern, q);
    if (m.grain > 0.0)
        colour *= 1.0 - m.grain * value_noise(q * 2.3);
    return colour;
}

} // namespace tessera::corpus
