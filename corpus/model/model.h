// A triangle model with its materials.
#pragma once

#include "corpus/picture_file.h"
#include "format/status.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tessera::corpus {

// The linear light of an sRGB value in 0..1.
inline double srgb_to_linear(double x) {
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

// The inverse. Light beyond 0..1 is clamped.
inline double linear_to_srgb(double light) {
    const double x = std::clamp(light, 0.0, 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

enum class Wrap : std::uint8_t { repeat, clamp, mirror };

struct TextureUse {
    int image = -1;  // index into Model::images; -1: none
    unsigned uv = 0; // index into ModelVertex::uv
    // The place in the image is turn * uv + offset.
    glm::dmat2 turn{1.0};
    glm::dvec2 offset{0.0};
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

// How a place that is no metal mirrors light at normal incidence, without KHR_materials_ior.
inline constexpr double usual_reflectance = 0.04;

// What extensions of glTF add to a material. Textures multiply the numbers beside them.
struct ModelCoats {
    // KHR_materials_clearcoat: a second mirror above all.
    double clear = 0.0, clear_roughness = 0.0, clear_normal_scale = 1.0;
    TextureUse clear_texture, clear_roughness_texture, clear_normal_texture; // red, green
    // KHR_materials_sheen
    glm::dvec3 sheen{0.0};
    double sheen_roughness = 0.0;
    TextureUse sheen_texture, sheen_roughness_texture; // colour, alpha
    // KHR_materials_anisotropy: highlights are longer along the direction, which is an angle from
    // the tangent in radians, counter-clockwise.
    double anisotropy = 0.0, rotation = 0.0;
    TextureUse anisotropy_texture; // red and green: the direction; blue
    // KHR_materials_iridescence: a thin film, its thickness in nanometres.
    double film = 0.0, film_ior = 1.3, film_least = 100.0, film_most = 400.0;
    TextureUse film_texture, film_thickness_texture; // red, green
    // KHR_materials_transmission and _volume: the share of light that is not mirrored and passes
    // instead of being scattered. A volume bends it and absorbs it on its way.
    double through = 0.0;
    TextureUse through_texture; // red
    bool is_volume = false;
    glm::dvec3 attenuation{1.0};       // what is left of light after `attenuation_distance`
    double attenuation_distance = 0.0; // 0: no light is absorbed
};

// The metallic-roughness material of glTF, without occlusion: the tracer computes that.
struct ModelMaterial {
    glm::dvec4 base{1.0}; // linear
    double metal = 1.0, roughness = 1.0;
    // How dielectrics mirror: KHR_materials_ior, and the weight and colour of
    // KHR_materials_specular.
    double reflectance = usual_reflectance, specular = 1.0, ior = 1.5;
    glm::dvec3 specular_colour{1.0};
    // KHR_materials_pbrSpecularGlossiness: `base` is the diffuse colour, specular_colour the
    // reflectance of all, and metal_roughness_texture has factors of the reflectance and, in alpha,
    // of 1 - roughness. `metal` is not used.
    bool has_glossiness = false;
    // KHR_materials_unlit: the base colour times unlit_light is emitted, and nothing is reflected.
    bool is_unlit = false;
    double unlit_light = 1.0;
    glm::dvec3 emission{0.0};
    double normal_scale = 1.0;
    double cutoff = 0.0; // light passes where alpha is below it; 0: opaque
    bool blends = false; // the share 1 - alpha of light passes
    bool double_sided = false;
    TextureUse base_texture, metal_roughness_texture, normal_texture, emission_texture;
    TextureUse specular_texture, specular_colour_texture; // alpha, colour
    std::optional<ModelCoats> coats;
};

// Whether surfaces of the material light others. Unlit ones emit, too, but are only seen.
inline bool is_lamp(const ModelMaterial& m) {
    return !m.is_unlit && m.emission != glm::dvec3(0.0);
}

struct ModelVertex {
    glm::vec3 position{0.0f}, normal{0.0f};
    glm::vec4 tangent{0.0f};       // w is the sign of the bitangent, 0 without a tangent
    std::array<glm::vec2, 2> uv{}; // v grows downwards
    glm::vec4 colour{1.0f};        // linear; a factor of the base colour
};

struct ModelTriangle {
    std::array<std::uint32_t, 3> vertices; // counter-clockwise, seen from outside
    std::uint32_t material = 0;
    bool is_back = false; // of a triangle of a double-sided material, from with_both_sides()
};

// A light without size (KHR_lights_punctual).
struct ModelLamp {
    enum class Kind : std::uint8_t { directional, point, spot } kind = Kind::point;
    glm::dvec3 position{0.0};             // not of directional lamps
    glm::dvec3 direction{0.0, 0.0, -1.0}; // in which it shines; not of points
    glm::dvec3 strength{1.0};             // irradiance of directional lamps, else intensity
    double range = 0.0;                   // beyond which it is dark; 0: none
    double inner_cosine = 1.0, outer_cosine = 0.0; // of a spot: full light, and none
};

// A perspective camera of the file.
struct ModelCamera {
    std::string name;
    glm::dvec3 eye{0.0}, forward{0.0, 0.0, -1.0}, up{0.0, 1.0, 0.0}; // unit vectors
    double fov = 45.0;                                               // vertical, degrees
};

constexpr double paper_radius = 3.5; // of the sphere around the paper's scene

// Where load_model() has moved the model: the baker works at one size. Directions stay.
struct ModelFrame {
    glm::dvec3 middle{0.0}; // of the model, in the units of its file
    double scale = 1.0;     // above 0
    glm::dvec3 from_file(const glm::dvec3& place) const { return (place - middle) * scale; }
    glm::dvec3 to_file(const glm::dvec3& place) const { return place / scale + middle; }
};

struct Model {
    std::vector<ModelVertex> vertices;
    std::vector<ModelTriangle> triangles;
    std::vector<ModelMaterial> materials; // at least one
    std::vector<Image> images;            // without texels where no material uses it
    std::vector<ModelLamp> lamps;
    std::vector<ModelCamera> cameras; // with different names
    std::vector<std::string> notes;   // what is missing or ignored, for people
    ModelFrame frame;
};

// Moves the vertices back to where the file has them. Lamps stay.
inline void restore_placement(Model& model) {
    for (ModelVertex& vertex : model.vertices)
        vertex.position = glm::vec3(model.frame.to_file(glm::dvec3(vertex.position)));
    model.frame = {};
}

// The normal of a triangle. Its length is twice the area.
inline glm::dvec3 area_vector(const Model& model, const ModelTriangle& triangle) {
    const auto& [a, b, c] = triangle.vertices;
    const glm::dvec3 p(model.vertices[a].position);
    return glm::cross(glm::dvec3(model.vertices[b].position) - p,
                      glm::dvec3(model.vertices[c].position) - p);
}

// Reads a model. The suffix states its kind: .gltf and .glb (glTF 2.0), .obj, .ply or .stl. The
// model is moved and scaled to fill the paper's sphere, radius 3.5 around the origin. Extensions of
// glTF that are read: KHR_draco_mesh_compression, EXT_meshopt_compression, KHR_mesh_quantization,
// KHR_texture_transform, KHR_lights_punctual, EXT_mesh_gpu_instancing, EXT_texture_webp, and
// KHR_materials_anisotropy, _clearcoat, _emissive_strength, _ior, _iridescence,
// _pbrSpecularGlossiness, _sheen, _specular, _transmission, _unlit and _volume. Model::notes names
// what is ignored: other extensions, animation, pictures that cannot be read, NaN. Skins and morph
// targets have the pose in which the file rests.
//
// Errors name the file and the element: bad_argument (another suffix); io; invalid_file;
// unsupported (a required extension, a point cloud, sizes beyond the limits);
// runtime (out of memory).
Result<Model> load_model(const std::string& path);

// Whether the path has one of these suffixes.
bool is_model_path(const std::string& path);

} // namespace tessera::corpus
