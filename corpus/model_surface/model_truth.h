// Path-traced views of a model, which its texture is compared with.
#pragma once

#include "corpus/model_surface/display.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

// Traces the model of the file, not the mesh of its texture. Thread-safe.
class ModelTruth {
public:
    ModelTruth(Tracer tracer, const Display& display, unsigned samples)
        : tracer_(std::move(tracer)), display_(display), samples_(samples) {}

    // The display's value along the ray; nothing if the ray misses. `ray` selects the random paths
    // and should differ between rays.
    std::optional<glm::dvec3> see(const glm::dvec3& origin, const glm::dvec3& direction,
                                  std::uint64_t ray) const;

private:
    Tracer tracer_;
    Display display_;
    unsigned samples_;
};

// `samples` paths per ray. Errors: bad_argument (no samples); those of with_both_sides() and
// RayModel::make().
Result<std::shared_ptr<const ModelTruth>>
make_model_truth(Model model, ModelLight light, const Display& display, unsigned samples);

} // namespace tessera::corpus
