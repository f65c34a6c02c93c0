// Polygons whose corners have indices of their own into positions, texture coordinates and normals,
// as .obj and .ply files have them.
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

// Adds the triangles of every mesh as one part. Corners whose uv or normal is absent or out of range get
// (0, 0) and the mean normal, weighted by area, of those polygons of the mesh at the same position that
// lean at most 45 degrees to their own. Polygons of one or two corners are points and lines and add
// nothing. Errors: unsupported (no polygon at all; polygons too complex to triangulate); those of
// ModelBuilder::add().
Status add_polygons(const PolygonModel& model, ModelBuilder& builder);

// A colour as displays show it, sRGB in 0..1, as linear light.
glm::dvec3 linear_colour(const glm::dvec3& displayed);

// A material of these files, which know no metal. `exponent` is that of a Phong highlight; 0 stands for
// none, and for roughness 0.5.
ModelMaterial plain_material(const glm::dvec3& displayed, double exponent = 0.0);

} // namespace tessera::corpus
