#include "corpus/model_surface/lit_model.h"

#include "format/work.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

// Added to the seed, so that each kind of light has its own random paths.
constexpr std::uint64_t diffuse_paths = 0x64696666, shared_paths = 0x73686172;

// The direction towards the observer. A direction into the surface becomes its mirror image above.
glm::dvec3 view_from(const SurfaceFrame& frame, AngularMap map, double s, double t) {
    const glm::dvec3 view = octahedral_direction(map, frame, s, t);
    return view - 2.0 * std::min(glm::dot(view, frame.ez), 0.0) * frame.ez;
}

} // namespace

LitModel::LitModel(ModelPlaces places, ModelLight light, const LitModelOptions& options)
    : places_(std::move(places)), tracer_(places_.model(), std::move(light)), options_(options),
      diffuse_(places_.texels(), glm::vec3(0.0f)), hidden_(places_.texels(), 0) {}

Result<std::shared_ptr<const LitModel>> LitModel::make(ModelAtlas atlas, ModelLight light,
                                                       const LitModelOptions& options) {
    if (options.samples == 0 || options.diffuse_samples == 0 || options.samples > 65536 ||
        options.shared_samples > 65536 || options.diffuse_samples > 65536)
        return Status(ErrorCode::bad_argument, "samples must be 1..65536");
    TESSERA_TRY_ASSIGN(ModelPlaces places, ModelPlaces::make(std::move(atlas)));
    const std::shared_ptr<LitModel> made(
        new LitModel(std::move(places), std::move(light), options));
    const unsigned threads = std::max(1u, options.threads);
    JoinedThreads others;
    for (unsigned i = 1; i < threads; ++i)
        others.start([&, i] { made->bake_rows(i, threads); });
    made->bake_rows(0, threads);
    others.join();
    return std::shared_ptr<const LitModel>(made);
}

void LitModel::bake_rows(std::uint32_t begin, std::uint32_t step) {
    for (std::uint32_t v = begin; v < places().size()[1]; v += step)
        for (std::uint32_t u = 0; u < places().size()[0]; ++u)
            if (places().matters(u, v)) {
                hidden_[index(u, v)] = places_.is_hidden(u, v);
                if (matters(u, v))
                    diffuse_[index(u, v)] = glm::vec3(diffuse(u, v, options_.seed));
            }
}

glm::dvec3 LitModel::diffuse(std::uint32_t u, std::uint32_t v, std::uint64_t seed) const {
    glm::dvec3 sum(0.0);
    const std::uint64_t paths = mix_bits(seed + diffuse_paths);
    for (unsigned i = 0; i < options_.diffuse_samples; ++i) {
        PathRandom random(paths, i);
        sum += tracer_.diffuse(places_.place(u, v, random.next2() - 0.5).point, random);
    }
    return sum / static_cast<double>(options_.diffuse_samples);
}

struct LitModel::Arriving {
    struct At {
        ModelSurfacePlace place;
        Tracer::Incoming incoming;
    };
    std::vector<At> all;
};

std::shared_ptr<const LitModel::Arriving> LitModel::arriving_with(std::uint32_t u, std::uint32_t v,
                                                                  std::uint64_t seed) const {
    auto found = std::make_shared<Arriving>();
    const std::uint64_t paths = mix_bits(seed + shared_paths);
    for (unsigned i = 0; i < options_.shared_samples; ++i) {
        PathRandom random(paths, i);
        const ModelSurfacePlace at = places_.place(u, v, random.next2() - 0.5);
        found->all.push_back({at, tracer_.incoming(at.point, random)});
    }
    return found;
}

glm::dvec3 LitModel::light_with(std::uint32_t u, std::uint32_t v, AngularMap map, double s,
                                double t, const glm::dvec3& diffuse, const Arriving& arriving,
                                std::uint64_t seed) const {
    glm::dvec3 emitted(0.0), specular(0.0);
    double below = 0.0;
    const std::uint64_t paths = mix_bits(seed);
    const double own = options_.samples, shared = static_cast<double>(arriving.all.size());
    for (unsigned i = 0; i < options_.samples; ++i) {
        PathRandom random(paths, i);
        const ModelSurfacePlace at = places_.place(u, v, random.next2() - 0.5);
        const glm::dvec3 view = view_from(at.frame, map, s, t);
        emitted += at.point.opacity * at.point.emission;
        specular += tracer_.specular_own(at.point, view, shared, own, random);
        below += below_coats(Tracer::facing(at.point, view), view);
    }
    for (const Arriving::At& at : arriving.all) {
        const glm::dvec3 view = view_from(at.place.frame, map, s, t);
        specular += tracer_.specular_of(at.incoming, at.place.point, view, shared, own);
    }
    return specular + (emitted + diffuse * below) / own;
}

std::shared_ptr<const LitModel::Arriving> LitModel::arriving(std::uint32_t u,
                                                             std::uint32_t v) const {
    return arriving_with(u, v, options_.seed);
}

glm::dvec3 LitModel::light(std::uint32_t u, std::uint32_t v, AngularMap map, double s, double t,
                           const Arriving& arriving) const {
    return light_with(u, v, map, s, t, glm::dvec3(diffuse_[index(u, v)]), arriving, options_.seed);
}

glm::dvec3 LitModel::other_light(std::uint32_t u, std::uint32_t v, AngularMap map, double s,
                                 double t, std::uint64_t seed) const {
    return light_with(u, v, map, s, t, diffuse(u, v, seed), *arriving_with(u, v, seed), seed);
}

} // namespace tessera::corpus
