// The light of a model at the places of its own surface, path traced and filtered.
#pragma once

#include "corpus/layers/arriving_light.h"
#include "corpus/layers/open_places.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

struct GatherOptions {
    unsigned paths = 32;       // per place, at first
    unsigned most_paths = 512; // per place
    double noise = 45.0;       // PSNR in dB, which more paths attain
    double exposure = 1.0;
    unsigned toward_emitters = 1; // see Tracer::incoming_of_model()
    std::uint64_t seed = 1;
};

// Per texel of an atlas; without what Tracer::incoming_of_emitters() finds.
struct GatheredLight {
    std::vector<ArrivingLight<glm::vec3>> light;
    // The estimated squared error of what a display shows: the mean over all places. Places that are
    // seen from few directions count less.
    double noise = 0;
};

// `charts` and `direct`, the diffuse light that arrives otherwise, are per texel. Blocks of texels
// that are too noisy get more paths; then LightFilter filters all. Memory while it runs: 344 bytes
// per texel. Errors: those of for_rows().
Result<GatheredLight> gather_light(const ModelPlaces& places, const OpenPlaces& open,
                                   const Tracer& tracer, std::span<const std::uint32_t> charts,
                                   std::span<const glm::vec3> direct, const GatherOptions& options,
                                   const BakeRun& run);

} // namespace tessera::corpus
