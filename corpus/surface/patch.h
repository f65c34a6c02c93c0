// The surface of a scene's objects, cut into patches that each lie flat in a rectangle of the atlas.
#pragma once

#include "corpus/scene.h"
#include "format/status.h"

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace tessera::corpus {

// Which part of an object's surface: the round one of a sphere or cylinder, or a flat one.
struct Part {
    bool round = false;
    glm::dvec3 normal{0.0}; // of a flat part, in the object's frame
    double height = 0.0;    // of a flat part above the object's centre, along its normal
};

// A point on a part of an object, in the object's frame.
struct PartPoint {
    glm::dvec3 position;
    glm::dvec3 normal;
};

// The nearest point of the part, which goes on beyond its border: a cap is a whole plane, a side a
// whole tube. So triangles that only approach the surface, and gutters, show what belongs there.
PartPoint settle(const Object& object, const Part& part, const glm::dvec3& local);

struct PatchVertex {
    glm::dvec3 position, normal; // world
    glm::dvec2 place;            // 0..1 in the patch's rectangle
};

struct Patch {
    std::size_t object = 0; // of the scene
    Part part;
    glm::dvec2 sides{0.0};               // of the rectangle, world units
    glm::dvec3 centre{0.0}, normal{0.0}; // roughly where it is and which way it looks; 0: all round
    double density = 1.0;                // of texels, relative to other patches
    std::vector<PatchVertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles; // counter-clockwise from outside
};

// The object's whole surface. Round parts are polygons that straddle the true surface and stay within
// `tolerance` (world units) of it; planes have their front only. Errors: unsupported, an endless plane.
Status add_patches(const Object& object, std::size_t number, double tolerance,
                   std::vector<Patch>& patches);

} // namespace tessera::corpus
