// The surface of a scene's objects, cut into patches that map to rectangles of the atlas.
#pragma once

#include "corpus/scene.h"
#include "format/status.h"

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace tessera::corpus {

// A part of an object's surface: the round part of a sphere or cylinder, or a flat part.
struct Part {
    bool round = false;
    glm::dvec3 normal{0.0}; // of a flat part, in the object's frame
    double height = 0.0;    // of a flat part above the object's centre, along the normal
};

// A point on a part of an object, in the object's frame.
struct PartPoint {
    glm::dvec3 position;
    glm::dvec3 normal;
};

// The nearest point of the part, which continues beyond its border: a cap is an infinite plane, a
// side an infinite tube. So triangles near the surface and gutters show the right part.
PartPoint settle(const Object& object, const Part& part, const glm::dvec3& local);

struct PatchVertex {
    glm::dvec3 position, normal; // world
    glm::dvec2 place;            // 0..1 in the patch's rectangle
};

struct Patch {
    std::size_t object = 0; // of the scene
    Part part;
    glm::dvec2 sides{0.0};               // of the rectangle, in world units
    glm::dvec3 centre{0.0}, normal{0.0}; // means of the vertices; the normal of a tube is 0
    double density = 1.0;                // of texels, relative to other patches
    std::vector<PatchVertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles; // counter-clockwise, seen from outside
};

// Adds the patches of the whole object; of planes only the front. The polygons of round parts
// straddle the true surface within `tolerance` world units. Error: unsupported (an infinite plane).
Status add_patches(const Object& object, std::size_t number, double tolerance,
                   std::vector<Patch>& patches);

} // namespace tessera::corpus
