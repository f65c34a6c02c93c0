// What an observer sees of a model, path traced: the judge of its texture.
#pragma once

#include "corpus/model_surface/display.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

// Of the model as the file has it, not of the mesh that stands for it. Thread-safe.
class ModelTruth {
public:
    ModelTruth(Tracer tracer, const Display& display, unsigned samples)
        : tracer_(std::move(tracer)), display_(display), samples_(samples) {}

    // The display's value along the ray; nothing where it misses. `ray` is any number, other for each
    // ray: it names the paths.
    std::optional<glm::dvec3> see(const glm::dvec3& origin, const glm::dvec3& direction,
                                  std::uint64_t ray) const;

private:
    Tracer tracer_;
    Display display_;
    unsigned samples_;
};

// `samples` paths a ray. Errors: those of RayModel.
Result<std::shared_ptr<const ModelTruth>>
make_model_truth(Model model, ModelLight light, const Display& display, unsigned samples);

} // namespace tessera::corpus
