#include "corpus/layers/place_light.h"

#include "corpus/layers/path_halves.h"

#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

// Added to the seed, so that each kind of light has its own random paths.
constexpr std::uint64_t emitter_paths = 0x656D6974, lamp_paths = 0x6C616D70,
                        shadow_paths = 0x73686164;
// Harmonics of degree 2 are inexact. They change the light of the smooth normal at most so much.
constexpr double most_change = 4.0;
constexpr unsigned toward_emitters = 2; // rays for each path

// The factors by which the lobe multiplies the harmonics of degree 0, 1 and 2 (the paper's A).
const std::array<double, 3> lobe_factors{diffuse_lobe(1.0) * std::numbers::pi,
                                         diffuse_lobe(1.0) * std::numbers::pi * 2.0 / 3.0,
                                         diffuse_lobe(1.0) * std::numbers::pi / 4.0};

glm::dvec3 convolved(const std::array<glm::vec3, 9>& radiance, const glm::dvec3& normal) {
    const std::array<double, 9> basis = harmonics_at(normal);
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < basis.size(); ++i)
        sum += glm::dvec3(radiance[i]) * (basis[i] * lobe_factors[i == 0 ? 0 : i < 4 ? 1 : 2]);
    return sum;
}

// Visibility has 8 bits, and a step of it is at least a ray.
unsigned rays_per_light(const PlaceLightOptions& options, std::size_t lights) {
    constexpr unsigned least = 8, most = 255;
    const std::size_t share = options.shadow_samples / std::max(lights, std::size_t{1});
    return static_cast<unsigned>(std::clamp<std::size_t>(share, least, most));
}

double mean_of(const glm::dvec3& x) {
    return (x.x + x.y + x.z) / 3.0;
}

// Directional lamps are among the distant lights.
bool is_near(const ModelLamp& lamp) {
    return lamp.kind != ModelLamp::Kind::directional;
}

double shown_mean(const glm::dvec3& x) {
    return (linear_to_srgb(x.x) + linear_to_srgb(x.y) + linear_to_srgb(x.z)) / 3.0;
}

// The direct light of emitting triangles at the places that point_at(random) returns. Rounds of
// rays, each as many as all before, until two halves differ by no more than the noise allowed.
// `other`: diffuse light of other kinds that is known.
template <class PointAt>
ArrivingLight<glm::dvec3> from_emitters(const Tracer& tracer, const PlaceLightOptions& options,
                                        const LitPoint& centre, const glm::dvec3& normal,
                                        const glm::dvec3& other, std::uint32_t u, std::uint32_t v,
                                        const PointAt& point_at) {
    const double allowed = std::pow(10.0, -options.noise / 20.0);
    const glm::dvec3 colour = without_coats(centre.lobes).diffuse * options.exposure;
    const unsigned least = std::max(options.emitter_samples, 2u) / 2 * 2;
    ArrivingLight<glm::dvec3> sum;
    std::array<glm::dvec3, 2> halves{glm::dvec3(0.0), glm::dvec3(0.0)};
    unsigned rays = 0;
    for (unsigned round = 0, more = least;; ++round, more = rays) {
        const std::uint64_t sequence = mix_bits(mix_bits(options.seed + emitter_paths) + round);
        const TexelPaths randoms(sequence, more, u, v);
        const auto incoming = [&](PathRandom& random) {
            return tracer.incoming_of_emitters(point_at(random), toward_emitters, random);
        };
        const auto added = add_halves(randoms, more, normal, incoming, sum);
        for (std::size_t half = 0; half < 2; ++half)
            halves[half] += added[half];
        rays += more;
        const double error = shown_mean(colour * (other + halves[0] * (2.0 / rays))) -
                             shown_mean(colour * (other + halves[1] * (2.0 / rays)));
        if (std::abs(error) / 2.0 <= allowed || 2 * rays > least * options.most_times)
            break;
    }
    ArrivingLight<glm::dvec3> mean;
    mean.add(sum, 1.0 / rays);
    return mean;
}

} // namespace

Result<PlaceLight> PlaceLight::make(const ModelPlaces& places, const Tracer& tracer,
                                    const DistantLights& lights, const PlaceLightOptions& options,
                                    const BakeRun& run) {
    PlaceLight made;
    const std::size_t count = places.texels();
    made.size_ = places.texel_places().size();
    made.lights_ = lights.count();
    made.visibility_.assign(count * lights.count(), 0);
    made.charts_.assign(count, 0);
    made.light_.resize(count);
    made.smooth_.resize(count);
    TESSERA_TRY_ASSIGN(made.open_, OpenPlaces::make(places, run));
    std::vector<glm::vec3> direct(count, glm::vec3(0.0f));
    TESSERA_TRY(for_rows("baking light", made.size_[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < made.size_[0]; ++u)
            if (made.matters(u, v)) {
                made.bake(places, tracer, lights, options, u, v);
                direct[made.index(u, v)] = made.light_[made.index(u, v)].diffuse;
            }
    }));
    const GatherOptions gather{.paths = options.diffuse_samples,
                               .most_paths = options.diffuse_samples * options.most_times,
                               .noise = options.noise,
                               .exposure = options.exposure,
                               .toward_emitters = toward_emitters,
                               .seed = options.seed};
    TESSERA_TRY_ASSIGN(const GatheredLight of_model,
                       gather_light(places, made.open_, tracer, made.charts_, direct, gather, run));
    made.noise_ = -10.0 * std::log10(std::max(of_model.noise, 1e-10));
    TESSERA_TRY(for_rows("adding light", made.size_[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < made.size_[0]; ++u)
            if (made.matters(u, v)) {
                const std::size_t at = made.index(u, v);
                made.light_[at].add(of_model.light[at]);
                const glm::vec3 middle(places.place(u, v, {0.0, 0.0}).frame.ez);
                made.smooth_[at] = convolved(made.light_[at].radiance, glm::dvec3(middle));
            }
    }));
    return made;
}

// Light that needs no paths: of the environment, of lamps and of emitting triangles.
void PlaceLight::bake(const ModelPlaces& places, const Tracer& tracer, const DistantLights& lights,
                      const PlaceLightOptions& options, std::uint32_t u, std::uint32_t v) {
    const std::size_t at = index(u, v);
    const ModelSurfacePlace centre = places.place(u, v, {0.0, 0.0});
    charts_[at] = static_cast<std::uint32_t>(centre.chart);
    const glm::dvec3 middle = centre.frame.ez;
    ArrivingLight<glm::dvec3> sum;
    const auto point_at = [&](PathRandom& random) {
        return open_.smooth_place(places, u, v, random.next2()).point;
    };
    std::vector<double> seen(lights.count(), 0.0);
    const unsigned rays = rays_per_light(options, lights.count());
    // Rays that all texels shared would miss the same parts of a light everywhere.
    const TexelPaths shadows(mix_bits(options.seed + shadow_paths), rays, u, v);
    for (unsigned i = 0; i < rays; ++i) {
        PathRandom random = shadows[i];
        const LitPoint point = point_at(random);
        for (std::size_t j = 0; j < lights.count(); ++j) {
            const DistantLights::Sample sample = lights.sample(j, random.next2());
            const glm::dvec3 arrives = tracer.unblocked(point, sample.direction);
            seen[j] += mean_of(arrives);
            sum.add(sample.direction, arrives * sample.irradiance / static_cast<double>(rays),
                    middle);
        }
    }
    if (std::ranges::any_of(tracer.light().lamps, is_near)) {
        const TexelPaths randoms(mix_bits(options.seed + lamp_paths), options.emitter_samples, u,
                                 v);
        for (unsigned i = 0; i < options.emitter_samples; ++i) {
            PathRandom random = randoms[i];
            const LitPoint point = point_at(random);
            for (const ModelLamp& lamp : tracer.light().lamps)
                if (is_near(lamp)) {
                    const LampLight l = lamp_light(lamp, point.position);
                    sum.add(l.direction,
                            l.irradiance / static_cast<double>(options.emitter_samples) *
                                tracer.unblocked(point, l.direction, l.distance),
                            middle);
                }
        }
    }
    if (tracer.has_emitters())
        sum.add(from_emitters(tracer, options, centre.point, middle, sum.diffuse, u, v, point_at));
    light_[at] = ArrivingLight<glm::vec3>(sum);

    // With rounding down below, a light that is never blocked would not be quite visible.
    const unsigned step = 255 / rays, most = step * rays;
    for (std::size_t j = 0; j < lights.count(); ++j) {
        const auto steps = static_cast<unsigned>(std::lround(seen[j] * step));
        visibility_[at * lights_ + j] = static_cast<std::uint8_t>(steps == most ? 255 : steps);
    }
}

std::optional<glm::dvec3> PlaceLight::diffuse(const glm::dvec2& texel, std::size_t chart,
                                              const glm::dvec3& normal) const {
    const glm::dvec2 place = texel - 0.5;
    const glm::dvec2 low = glm::floor(place), share = place - low;
    glm::dvec3 sum(0.0);
    double weights = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double x = low.x + i, y = low.y + j;
            if (x < 0.0 || y < 0.0 || x >= size_[0] || y >= size_[1])
                continue;
            const auto u = static_cast<std::uint32_t>(x), v = static_cast<std::uint32_t>(y);
            const double weight =
                (i == 0 ? 1.0 - share.x : share.x) * (j == 0 ? 1.0 - share.y : share.y);
            const std::size_t at = index(u, v);
            if (!matters(u, v) || charts_[at] != chart || weight <= 0.0)
                continue;
            const glm::dvec3& smooth = smooth_[at];
            const glm::dvec3 bumped = convolved(light_[at].radiance, normal);
            glm::dvec3 change(1.0);
            for (glm::length_t c = 0; c < 3; ++c)
                change[c] =
                    smooth[c] > 1e-6 ? std::clamp(bumped[c] / smooth[c], 0.0, most_change) : 1.0;
            sum += weight * glm::dvec3(light_[at].diffuse) * change;
            weights += weight;
        }
    if (weights <= 0.0)
        return std::nullopt;
    return sum / weights;
}

} // namespace tessera::corpus
