// The light that reaches the places of a model: for diffuse light as a function of the normal, and
// as shares of distant lights that are not blocked.
#pragma once

#include "corpus/layers/distant_lights.h"
#include "corpus/layers/gathered_light.h"
#include "corpus/model_surface/model_places.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

struct PlaceLightOptions {
    // Per place: paths for the light of the model, and rays to its emitting triangles, at first.
    unsigned diffuse_samples = 32;
    unsigned emitter_samples = 64;
    unsigned shadow_samples = 256; // rays per place, shared by all lights
    unsigned most_times = 16;      // so many samples as at first where it is noisy
    double noise = 45.0;           // dB, which more samples attain
    double exposure = 1.0;
    std::uint64_t seed = 1;
};

// Immutable and thread-safe. Memory: 150 bytes per texel of the atlas, and a byte per texel and
// light; while it is made, 370 more per texel.
class PlaceLight {
public:
    // Errors: those of for_rows().
    static Result<PlaceLight> make(const ModelPlaces& places, const Tracer& tracer,
                                   const DistantLights& lights, const PlaceLightOptions& options,
                                   const BakeRun& run);

    // Whether the texel shows a place that an observer can see.
    bool matters(std::uint32_t u, std::uint32_t v) const { return open_.matters(u, v); }
    // The texel's places that are baked.
    const OpenPlaces& open() const { return open_; }
    // What the noise of diffuse light does to a display, as estimated: PSNR in dB.
    double noise() const { return noise_; }
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
    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }
    void bake(const ModelPlaces& places, const Tracer& tracer, const DistantLights& lights,
              const PlaceLightOptions& options, std::uint32_t u, std::uint32_t v);

    Texels2 size_{0, 0};
    std::size_t lights_ = 0;
    double noise_ = 0;
    OpenPlaces open_;
    std::vector<std::uint8_t> visibility_;
    std::vector<std::uint32_t> charts_;
    std::vector<ArrivingLight<glm::vec3>> light_;
    std::vector<glm::dvec3> smooth_; // the light of the harmonics without bumps
};

} // namespace tessera::corpus
