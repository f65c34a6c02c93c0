#include "corpus/layers/layer_trial.h"

#include <cmath>
#include <numeric>

namespace tessera::corpus {
namespace {

constexpr std::uint32_t trial_places = 1024, trial_paths = 16;
constexpr std::uint64_t trial_seed = 0x6C617965;
constexpr double best_trial = 100; // dB
// Reflections of surfaces as rough as this are as smooth as the layer of reflections.
constexpr double rough_enough = 0.5;

// Sums of the triangles' areas, up to and including each of them.
std::vector<double> summed_areas(const Model& model) {
    std::vector<double> areas;
    for (const ModelTriangle& triangle : model.triangles)
        areas.push_back(glm::length(area_vector(model, triangle)));
    std::partial_sum(areas.begin(), areas.end(), areas.begin());
    return areas;
}

ModelPlace place_at(const std::vector<double>& areas, const glm::dvec2& random, double along) {
    const auto found = std::upper_bound(areas.begin(), areas.end(), along * areas.back());
    const auto triangle =
        std::min(static_cast<std::size_t>(found - areas.begin()), areas.size() - 1);
    const double root = std::sqrt(random.x);
    return {static_cast<std::uint32_t>(triangle), {root * (1.0 - random.y), root * random.y}};
}

// What the model mirrors of itself, as far as it is sharp.
glm::dvec3 sharp_reflection(const Tracer& tracer, const LitPoint& point, const glm::dvec3& view,
                            PathRandom& random) {
    const double alpha = point.lobes.alpha;
    const double sharp = std::max(0.0, 1.0 - std::sqrt(alpha) / rough_enough);
    const glm::dvec3 l = sample_ggx(alpha, point.normal, view, random.next2());
    const double nl = glm::dot(point.normal, l), nv = glm::dot(point.normal, view);
    if (sharp <= 0.0 || nl <= 0.0 || glm::dot(point.face, l) <= 0.0)
        return glm::dvec3(0.0);
    const double rest = 2.0 * nl * (nv + smith_root(alpha, nv)) * smith_visibility(alpha, nl, nv);
    return sharp * rest * fresnel(point.lobes, glm::dot(view, glm::normalize(l + view))) *
           tracer.from_model(point, l, random);
}

glm::dvec3 lamp_highlights(const Tracer& tracer, const LitPoint& point, const glm::dvec3& view) {
    glm::dvec3 sum(0.0);
    for (const ModelLamp& lamp : tracer.light().lamps) {
        if (lamp.kind == ModelLamp::Kind::directional)
            continue;
        const LampLight light = lamp_light(lamp, point.position);
        const double nl = glm::dot(point.normal, light.direction);
        if (nl <= 0.0 || tracer.is_shadowed(point, light.direction, light.distance))
            continue;
        const glm::dvec3 h = glm::normalize(light.direction + view);
        const double alpha = point.lobes.alpha, nv = glm::dot(point.normal, view);
        sum += fresnel(point.lobes, glm::dot(view, h)) * light.irradiance *
               (ggx(alpha, std::min(glm::dot(point.normal, h), 1.0)) *
                smith_visibility(alpha, nl, nv) * nl);
    }
    return sum;
}

} // namespace

Result<LayerTrial> try_layers(Model model, const ModelLight& light, const Display& display) {
    TESSERA_TRY_ASSIGN(auto rays, RayModel::make(std::move(model)));
    const RayModel& seen = *rays;
    const Tracer tracer(std::move(rays), light);
    const std::vector<double> areas = summed_areas(seen.model());
    LayerTrial trial;
    double error = 0, count = 0;
    for (std::uint32_t i = 0; i < trial_places; ++i) {
        PathRandom random(trial_seed, i);
        const double along = random.next();
        const ModelPlace place = place_at(areas, random.next2(), along);
        LitPoint point = seen.point(place);
        const glm::dvec3 view = sample_cosine(point.face, random.next2());
        if (seen.is_cut_out(place) || tracer.is_shadowed(point, view))
            continue; // no observer outside the model sees it
        point = Tracer::facing(point, view);
        glm::dvec3 all(0.0), lost = lamp_highlights(tracer, point, view);
        for (std::uint32_t k = 0; k < trial_paths; ++k) {
            PathRandom path(mix_bits(trial_seed + i), k);
            all += tracer.leaving(point, view, path) / double{trial_paths};
            lost += sharp_reflection(tracer, point, view, path) / double{trial_paths};
        }
        lost *= point.opacity;
        trial.paths += 2 * trial_paths;
        const glm::dvec3 difference =
            display.value(all) - display.value(glm::max(all - lost, glm::dvec3(0.0)));
        error += glm::dot(difference, difference) / 3.0;
        ++count;
    }
    if (error > 0.0)
        trial.decibels = std::min(best_trial, -10.0 * std::log10(error / count));
    return trial;
}

} // namespace tessera::corpus
