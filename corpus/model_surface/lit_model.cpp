#include "corpus/model_surface/lit_model.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace tessera::corpus {
namespace {

// Added to the seed, so that each kind of light has its own random paths.
constexpr std::uint64_t diffuse_paths = 0x64696666, shared_paths = 0x73686172;
constexpr unsigned hidden_rays = 24;

// The nearest place within the triangle.
glm::dvec2 inside(const glm::dvec2& barycentric) {
    glm::dvec3 w{1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
    w = glm::max(w, 0.0);
    const double sum = w.x + w.y + w.z;
    return {w.y / sum, w.z / sum};
}

// How far a place is outside the triangle; at most 0 within it.
double outside(const glm::dvec2& b) {
    return -std::min({b.x, b.y, 1.0 - b.x - b.y});
}

// The direction towards the observer. A direction into the surface becomes its mirror image above.
glm::dvec3 view_from(const SurfaceFrame& frame, AngularMap map, double s, double t) {
    const glm::dvec3 view = octahedral_direction(map, frame, s, t);
    return view - 2.0 * std::min(glm::dot(view, frame.ez), 0.0) * frame.ez;
}

} // namespace

LitModel::LitModel(ModelAtlas atlas, std::shared_ptr<const RayModel> model, ModelLight light,
                   const LitModelOptions& options, TexelPlaces places)
    : mesh_(std::move(atlas.mesh)), tangents_(mesh_tangents(mesh_)), places_(std::move(places)),
      tracer_(std::move(model), std::move(light)), options_(options) {
    const std::size_t count = std::size_t{places_.size()[0]} * places_.size()[1];
    diffuse_.assign(count, glm::vec3(0.0f));
    hidden_.assign(count, 0);
}

Result<std::shared_ptr<const LitModel>> LitModel::make(ModelAtlas atlas, ModelLight light,
                                                       const LitModelOptions& options) {
    if (options.samples == 0 || options.diffuse_samples == 0 || options.samples > 65536 ||
        options.shared_samples > 65536 || options.diffuse_samples > 65536)
        return Status(ErrorCode::bad_argument, "samples must be 1..65536");
    TESSERA_TRY_ASSIGN(TexelPlaces places, TexelPlaces::make(atlas.mesh, atlas.charts, atlas.size));
    TESSERA_TRY_ASSIGN(auto model, RayModel::make(std::move(atlas.model)));
    const std::shared_ptr<LitModel> made(new LitModel(
        std::move(atlas), std::move(model), std::move(light), options, std::move(places)));
    const unsigned threads = std::max(1u, options.threads);
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i)
        others.emplace_back([&, i] { made->bake_rows(i, threads); });
    made->bake_rows(0, threads);
    others.clear();
    return std::shared_ptr<const LitModel>(made);
}

void LitModel::bake_rows(std::uint32_t begin, std::uint32_t step) {
    for (std::uint32_t v = begin; v < places_.size()[1]; v += step)
        for (std::uint32_t u = 0; u < places_.size()[0]; ++u)
            if (places_.matters(u, v)) {
                hidden_[index(u, v)] = is_hidden(u, v);
                if (matters(u, v))
                    diffuse_[index(u, v)] = glm::vec3(diffuse(u, v, options_.seed));
            }
}

// The place on the nearest triangle around the texel, because triangles may be as small as texels.
LitModel::Place LitModel::place(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const {
    TrianglePlace best = places_.place(u, v, offset);
    const std::size_t chart = places_.chart_of(best.triangle);
    double least = outside(best.barycentric);
    for (int y = -1; y <= 1 && least > 0.0; ++y)
        for (int x = -1; x <= 1; ++x) {
            const std::int64_t nu = std::int64_t{u} + x, nv = std::int64_t{v} + y;
            if (nu < 0 || nv < 0 || nu >= places_.size()[0] || nv >= places_.size()[1])
                continue;
            const auto cu = static_cast<std::uint32_t>(nu), cv = static_cast<std::uint32_t>(nv);
            if (!places_.matters(cu, cv))
                continue;
            const TrianglePlace other = places_.place(cu, cv, offset - glm::dvec2(x, y));
            if (places_.chart_of(other.triangle) == chart && outside(other.barycentric) < least) {
                least = outside(other.barycentric);
                best = other;
            }
        }
    best.barycentric = inside(best.barycentric);
    return {tracer_.model().point({best.triangle, best.barycentric}),
            surface_point(mesh_, tangents_, best.triangle, best.barycentric).frame};
}

SurfaceFrame LitModel::frame(std::uint32_t u, std::uint32_t v) const {
    return place(u, v, {0.0, 0.0}).frame;
}

glm::dvec3 LitModel::diffuse(std::uint32_t u, std::uint32_t v, std::uint64_t seed) const {
    glm::dvec3 sum(0.0);
    const std::uint64_t paths = mix_bits(seed + diffuse_paths);
    for (unsigned i = 0; i < options_.diffuse_samples; ++i) {
        PathRandom random(paths, i);
        sum += tracer_.diffuse(place(u, v, random.next2() - 0.5).point, random);
    }
    return sum / static_cast<double>(options_.diffuse_samples);
}

struct LitModel::Arriving {
    struct At {
        Place place;
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
        const Place at = place(u, v, random.next2() - 0.5);
        found->all.push_back({at, tracer_.incoming(at.point, random)});
    }
    return found;
}

glm::dvec3 LitModel::light_with(std::uint32_t u, std::uint32_t v, AngularMap map, double s,
                                double t, const glm::dvec3& diffuse, const Arriving& arriving,
                                std::uint64_t seed) const {
    glm::dvec3 emitted(0.0), specular(0.0);
    double bent = 0.0;
    const std::uint64_t paths = mix_bits(seed);
    const double own = options_.samples, shared = static_cast<double>(arriving.all.size());
    for (unsigned i = 0; i < options_.samples; ++i) {
        PathRandom random(paths, i);
        const Place at = place(u, v, random.next2() - 0.5);
        const glm::dvec3 view = view_from(at.frame, map, s, t);
        emitted += at.point.emission;
        specular += tracer_.specular_own(at.point, view, shared, own, random);
        bent += bend(glm::dot(Tracer::facing(at.point, view).normal, view));
    }
    for (const Arriving::At& at : arriving.all) {
        const glm::dvec3 view = view_from(at.place.frame, map, s, t);
        specular += tracer_.specular_of(at.incoming, at.place.point, view, shared, own);
    }
    return specular + (emitted + diffuse * bent) / own;
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

// Whether all rays from the middles of the texel and of its diagonal neighbours meet backs first.
bool LitModel::is_hidden(std::uint32_t u, std::uint32_t v) const {
    for (const glm::dvec2 offset : {glm::dvec2(0, 0), glm::dvec2(-1, -1), glm::dvec2(1, -1),
                                    glm::dvec2(-1, 1), glm::dvec2(1, 1)}) {
        const LitPoint p = place(u, v, offset).point;
        for (unsigned i = 0; i < hidden_rays; ++i) {
            PathRandom random(0, i);
            const glm::dvec3 d = sample_cosine(p.face, random.next2());
            if (!tracer_.model().meets_back(p.position + 1e-3 * p.face, d))
                return false;
        }
    }
    return true;
}

} // namespace tessera::corpus
