// A triangle model with its materials, as files have it.
#pragma once

#include "format/status.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

namespace tessera::corpus {

// Linear light of a value in 0..1 as displays show it.
inline double srgb_to_linear(double x) {
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

// RGBA, rows from the top.
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<std::uint8_t, 4>> texels;
};

enum class Wrap : std::uint8_t { repeat, clamp, mirror };

struct TextureUse {
    int image = -1;  // none
    unsigned uv = 0; // which of a vertex's coordinates
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

// glTF's metallic-roughness. Its occlusion is not used: the tracer finds what is occluded.
struct ModelMaterial {
    glm::dvec4 base{1.0}; // linear
    double metal = 1.0, roughness = 1.0;
    glm::dvec3 emission{0.0};
    double normal_scale = 1.0;
    double cutoff = 0.0; // alpha below it lets light pass; 0: all is opaque
    bool double_sided = false;
    TextureUse base_texture, metal_roughness_texture, normal_texture, emission_texture;
};

struct ModelVertex {
    glm::vec3 position{0.0f}, normal{0.0f};
    glm::vec4 tangent{0.0f}; // w: the sign of the bitangent; 0 where there is no tangent
    std::array<glm::vec2, 2> uv{};
    glm::vec4 colour{1.0f}; // linear, times the base colour
};

struct ModelTriangle {
    std::array<std::uint32_t, 3> vertices; // counter-clockwise seen from outside
    std::uint32_t material = 0;
};

struct Model {
    std::vector<ModelVertex> vertices;
    std::vector<ModelTriangle> triangles;
    std::vector<ModelMaterial> materials; // at least one
    std::vector<Image> images;
    std::vector<std::string> notes; // what the file names but lacks, and what stands in for it
};

// By its suffix: .gltf and .glb (glTF 2.0, also with KHR_draco_mesh_compression), .obj, .ply. Moved
// and scaled so that it fills the sphere of the paper, radius 3.5 about the origin. Not modelled:
// animation, skins, morph targets, blending (opaque here), extensions of materials but for
// KHR_materials_emissive_strength. Errors, all of which name the file and the element: io; invalid_file;
// unsupported (an extension that the file requires, sparse accessors, sizes beyond the limits).
Result<Model> load_model(const std::string& path);

bool is_model_path(const std::string& path);

} // namespace tessera::corpus
