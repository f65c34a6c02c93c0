// Layers: several textures on one surface that together give the light that leaves it (FORMAT.md
// 5.6).
#pragma once

#include "format/byte_source.h"
#include "format/metadata.h"
#include "format/sampler.h"
#include "format/status.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// What a layer holds. The numbers are those of FORMAT.md 1.7.
enum class LayerRole : std::uint8_t {
    diffuse = 0,            // the light that leaves the surface diffusely
    emission = 1,           // the light that it emits
    specular = 2,           // reflectance at normal incidence
    roughness = 3,          // 0 is a mirror
    normal = 4,             // x and y of the bumped normal in the frame of the mesh
    visibility = 5,         // the share of each light that reaches the surface
    reflection = 6,         // the light that arrives from mirrored directions
    coverage = 7,           // where it is below least_coverage, there is no surface
    environment = 8,        // distant light from mirrored directions, in lobes of roughness along u
    difference = 9,         // what display values change by, by the mirrored direction
    shared_difference = 10, // the same of all places, with more directions
    opacity = 11,           // how much it hides of what lies behind
};
template <>
inline constexpr std::array<const char*, 12> value_names<LayerRole>{
    "diffuse",     "emission",   "specular",          "roughness",
    "normal",      "visibility", "reflection",        "coverage",
    "environment", "difference", "shared_difference", "opacity"};

inline constexpr double least_coverage = 0.5;
// From this opacity on, a surface hides what lies behind it.
inline constexpr double full_opacity = 254.0 / 255.0;

// Distant light from a patch of directions.
struct DistantLight {
    glm::vec3 direction{0.0f, 1.0f, 0.0f}; // unit vector towards the middle of the patch
    // Root mean square of the angle between the middle and the patch's directions, along one axis,
    // in radians.
    float spread = 0;
    glm::vec3 irradiance{0.0f}; // on a surface that faces the light
};

// A layer besides the first one, and where its bytes are in the file.
struct LayerInfo {
    LayerRole role = LayerRole::diffuse;
    float scale = 1; // the light, or other value, of a sample of 1
    // The layer is a file of its own, cut where its DATA begins.
    std::uint64_t beginning_offset = 0, beginning_bytes = 0;
    std::uint64_t data_offset = 0, data_bytes = 0;
};

// The layers of a file (FORMAT.md 1.7). The first layer is the file's own texture and has the role
// `diffuse`.
struct Layers {
    std::vector<LayerInfo> further;                // empty: the file has one texture
    float scale = 1;                               // of the first layer
    std::uint64_t data_offset = 0, data_bytes = 0; // of the first layer
    std::vector<DistantLight> lights;

    bool any() const { return !further.empty(); }
    // The further layer with this role; nullptr: none.
    const LayerInfo* find(LayerRole role) const;
};

// The bytes of a layer as a file of its own, which Decoder::open() opens. `file` is the source that
// the layers were read from, and must outlive the result. Thread-safe if `file` is.
std::unique_ptr<ByteSource> layer_bytes(ByteSource& file, const LayerInfo& layer);
// The same for all further layers. If the source wants prefetching, what opening them needs is read
// together now. Errors: io, runtime (interrupted).
Result<std::vector<std::unique_ptr<ByteSource>>> bytes_of_layers(ByteSource& file,
                                                                 const Layers& layers);

// A file of one texture that becomes a layer.
struct LayerFile {
    LayerRole role = LayerRole::specular;
    float scale = 1;
    std::span<const std::byte> bytes;
};

// Joins complete files of one texture each to one file with layers. `first` is the diffuse layer
// with the mesh and the metadata. The others have neither. They are stored in their order. Errors:
// bad_argument, which says what does not fit.
Result<std::vector<std::byte>> join_layers(std::span<const std::byte> first, float scale,
                                           std::span<const LayerFile> further,
                                           std::span<const DistantLight> lights);

// Whether samples of a layer are signed: differences.
inline bool is_signed(LayerRole role) {
    return role == LayerRole::difference || role == LayerRole::shared_difference;
}

// The value of a sample of a signed layer, without its scale: -1 to 1. 128 of 255 is 0.
inline double signed_value(double sample) {
    return std::clamp((255.0 * sample - 128.0) / 127.0, -1.0, 1.0);
}

// Whether the texture of a layer has the channels and the sides along s and t that its role needs.
// Errors: invalid_file, without the file's name.
Status check_layer(LayerRole role, const TextureDesc& desc, const Description& description,
                   std::size_t lights);

// What an observer sees, in linear light clamped to 0..1: `light` leaves a surface of this opacity,
// which is below full_opacity, and `behind` would be seen without the surface.
glm::dvec3 blended(const glm::dvec3& light, double opacity, const glm::dvec3& behind);

// The bumped normal, of unit length, whose x and y in the frame are `xy`. If that is longer than 1,
// it is shortened to 1.
glm::dvec3 bumped_normal(const SurfaceFrame& frame, const glm::dvec2& xy);
// The normal bent towards the observer, in direction `view`, where it would face away.
glm::dvec3 facing_normal(const glm::dvec3& normal, const glm::dvec3& view);

// The sample of the layer `visibility` for each light if nothing blocks it, in 0..1. It grows with the
// light's irradiance, so that errors of dim lights cost few bits.
std::vector<double> visibility_peaks(std::span<const DistantLight> lights);

// The specular light of several lights at a place, per channel.
struct LightSum {
    glm::dvec3 points{0.0};    // of lights without spread
    glm::dvec3 patches{0.0};   // of the other lights
    glm::dvec3 unblocked{0.0}; // of those, if nothing blocked them

    // Adds `specular`, the light of a light that is not blocked, of which the share `seen` arrives.
    void add(const DistantLight& light, const glm::dvec3& specular, double seen);
    // The share of the environment that is not blocked.
    glm::dvec3 share_seen() const;
    // All light, where `environment` is that of the layer, times the reflectance for it.
    glm::dvec3 with_environment(const glm::dvec3& environment, double roughness) const;
};

// How a place reflects light towards an observer. All vectors have unit length and point away from
// the surface.
struct Reflectance {
    glm::dvec3 normal{0.0, 0.0, 1.0}, view{0.0, 0.0, 1.0};
    glm::dvec3 specular{0.0}; // at normal incidence
    double roughness = 1;     // 0..1

    // The specular light of a light source that is not blocked.
    glm::dvec3 of(const DistantLight& light) const;
    // The factor of the light in the layer `reflection`.
    glm::dvec3 of_reflection() const;
};

// The texel along u of a layer of the environment, of so many lobes, that the place mirrors.
double environment_lobe(const Reflectance& reflectance, std::uint32_t lobes);

} // namespace tessera
