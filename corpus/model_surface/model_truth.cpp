#include "corpus/model_surface/model_truth.h"

namespace tessera::corpus {

std::optional<glm::dvec3> ModelTruth::see(const glm::dvec3& origin, const glm::dvec3& direction,
                                          std::uint64_t ray) const {
    const glm::dvec3 way = glm::normalize(direction);
    const auto hit = tracer_.model().first_hit(origin, way);
    if (!hit)
        return std::nullopt;
    const LitPoint point = Tracer::facing(tracer_.model().point(*hit), -way);
    glm::dvec3 sum(0.0);
    for (unsigned i = 0; i < samples_; ++i) {
        PathRandom random(mix_bits(ray + 1), i);
        sum += tracer_.leaving(point, -way, random);
    }
    return display_.value(sum / static_cast<double>(samples_));
}

Result<std::shared_ptr<const ModelTruth>>
make_model_truth(Model model, ModelLight light, const Display& display, unsigned samples) {
    if (samples == 0)
        return Status(ErrorCode::bad_argument, "a truth needs samples");
    TESSERA_TRY_ASSIGN(Model both, with_both_sides(std::move(model)));
    TESSERA_TRY_ASSIGN(auto rays, RayModel::make(std::move(both)));
    return std::make_shared<const ModelTruth>(Tracer(std::move(rays), std::move(light)), display,
                                              samples);
}

} // namespace tessera::corpus
