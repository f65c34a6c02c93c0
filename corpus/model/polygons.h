// Polygons as in .obj, .ply and .stl files: a corner has separate indices of its position, its
// texture coordinates and its normal.
#pragma once

#include "corpus/model/model_builder.h"

#include <span>

namespace tessera::corpus {

constexpr std::uint32_t absent = UINT32_MAX;

struct PolygonCorner {
    std::uint32_t position = absent, uv = absent, normal = absent;
};

struct PolygonMesh {
    std::vector<std::uint32_t> sizes;   // corners of each polygon
    std::vector<PolygonCorner> corners; // of all polygons, one after another
    std::uint32_t material = 0;

    void add(std::span<const PolygonCorner> polygon);
};

struct PolygonModel {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> colours; // one per position, or none
    std::vector<glm::vec2> uv;      // v grows downwards
    std::vector<PolygonMesh> meshes;
};

// Triangulates the polygons and adds each mesh as one part. A uv that is absent or out of range is
// (0, 0). A normal that is absent or out of range is the mean, weighted by area, of the polygons of
// the mesh that meet at the position at an angle of at most 45 degrees to the corner's polygon.
// Polygons of one or two corners are ignored. Errors: unsupported (no polygon at all; polygons with
// too many corners); those of ModelBuilder::add().
Status add_polygons(const PolygonModel& model, ModelBuilder& builder);

// Linear light of an sRGB colour in 0..1.
glm::dvec3 linear_colour(const glm::dvec3& displayed);

// A non-metal of this sRGB colour. `exponent` is that of a Phong highlight; without one, which is
// 0, the roughness is 0.5.
ModelMaterial plain_material(const glm::dvec3& displayed, double exponent = 0.0);

} // namespace tessera::corpus
