// The light that reaches the places of a model: for diffuse light as a function of the normal, and
// as shares of distant lights that are not blocked.
#pragma once

#include "corpus/layers/distant_lights.h"
#include "corpus/layers/rows.h"
#include "corpus/model_surface/model_places.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

struct PlaceLightOptions {
    // Paths per place for the light of the model; three times as many if it has emitting triangles.
    unsigned diffuse_samples = 64;
    unsigned shadow_samples = 256; // rays per place, shared by all lights
    std::uint64_t seed = 1;
};

// Immutable and thread-safe. Memory: 149 bytes per texel of the atlas, and a byte per texel and
// light.
class PlaceLight {
public:
    // Errors: those of for_rows().
    static Result<PlaceLight> make(const ModelPlaces& places, const Tracer& tracer,
                                   const DistantLights& lights, const PlaceLightOptions& options,
                                   const BakeRun& run);

    // Whether the texel shows a place that an observer can see.
    bool matters(std::uint32_t u, std::uint32_t v) const { return matters_[index(u, v)] != 0; }
    // The diffuse light per unit of diffuse colour at a place of the atlas in texels, interpolated
    // between texels of its chart that matter, for a surface with this normal. Nothing if none of
    // them matters.
    std::optional<glm::dvec3> diffuse(const glm::dvec2& texel, std::size_t chart,
                                      const glm::dvec3& normal) const;
    // 0..255: the share of the light that reaches the place.
    std::uint8_t visibility(std::uint32_t u, std::uint32_t v, std::size_t light) const {
        return visibility_[index(u, v) * lights_ + light];
    }

private:
    // Radiance in real spherical harmonics up to degree 2.
    using Harmonics = std::array<glm::vec3, 9>;

    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }
    void bake(const ModelPlaces& places, const Tracer& tracer, const DistantLights& lights,
              const PlaceLightOptions& options, std::uint32_t u, std::uint32_t v);

    Texels2 size_{0, 0};
    std::size_t lights_ = 0;
    std::vector<std::uint8_t> matters_, visibility_;
    std::vector<std::uint32_t> charts_;
    std::vector<glm::vec3> diffuse_; // without bumps
    std::vector<Harmonics> harmonics_;
    std::vector<glm::dvec3> smooth_; // the light of the harmonics without bumps
};

} // namespace tessera::corpus
