#include "corpus/surface/patch.h"

#include "corpus/surface/round_patches.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

// `u` and `v` point from the middle of the rectangle to its borders; u x v points outwards.
Patch rectangle(const glm::dvec3& middle, const glm::dvec3& u, const glm::dvec3& v) {
    Patch patch;
    const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
    patch.part = {.round = false, .normal = normal, .height = glm::dot(middle, normal)};
    patch.sides = {2.0 * glm::length(u), 2.0 * glm::length(v)};
    add_grid(patch, 1, 1, [&](const glm::dvec2& place) {
        return PartPoint{middle + (2.0 * place.x - 1.0) * u + (2.0 * place.y - 1.0) * v, normal};
    });
    return patch;
}

std::vector<Patch> box_patches(const glm::dvec3& half) {
    std::vector<Patch> patches;
    for (glm::length_t axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            glm::dvec3 n{0.0}, u{0.0}, v{0.0};
            n[axis] = sign * half[axis];
            u[(axis + 1) % 3] = sign * half[(axis + 1) % 3];
            v[(axis + 2) % 3] = half[(axis + 2) % 3];
            patches.push_back(rectangle(n, u, v));
        }
    return patches;
}

std::vector<Patch> patches_of(const Object& object, double tolerance) {
    const glm::dvec3& half = object.half;
    switch (object.shape) {
    case Shape::sphere:
        return sphere_patches(half.x, tolerance);
    case Shape::cylinder:
        return cylinder_patches(half.x, half.y, tolerance);
    case Shape::box:
        return box_patches(half);
    case Shape::plane:
        return {
            rectangle({0.0, 0.0, 0.0}, {0.0, 0.0, half.z}, {front_of(object) * half.x, 0.0, 0.0})};
    }
    return {};
}

} // namespace

PartPoint settle(const Object& object, const Part& part, const glm::dvec3& local) {
    if (!part.round)
        return {local + part.normal * (part.height - glm::dot(local, part.normal)), part.normal};
    const bool tube = object.shape == Shape::cylinder;
    const glm::dvec3 axis{0.0, tube ? local.y : 0.0, 0.0};
    const glm::dvec3 normal = glm::normalize(local - axis);
    return {axis + normal * object.half.x, normal};
}

Status add_patches(const Object& object, std::size_t number, double tolerance,
                   std::vector<Patch>& patches) {
    if (!std::isfinite(object.bound))
        return {ErrorCode::unsupported, "an infinite plane has no mesh"};
    for (Patch& patch : patches_of(object, tolerance)) {
        for (PatchVertex& vertex : patch.vertices) {
            // Multiplies by the transpose, back to the world.
            vertex.position = object.centre + vertex.position * object.to_local;
            vertex.normal = vertex.normal * object.to_local;
            patch.centre += vertex.position / static_cast<double>(patch.vertices.size());
            patch.normal += vertex.normal;
        }
        const double length = glm::length(patch.normal); // almost 0 for a tube
        patch.normal = length > 0.1 * static_cast<double>(patch.vertices.size())
                           ? patch.normal / length
                           : glm::dvec3{0.0};
        patch.object = number;
        patches.push_back(std::move(patch));
    }
    return {};
}

} // namespace tessera::corpus
