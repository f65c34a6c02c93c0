#include "corpus/layers/place_light.h"

#include "corpus/trace/path_random.h"

#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

// Added to the seed, so that each kind of light has its own random paths.
constexpr std::uint64_t irradiance_paths = 0x69727261, shadow_paths = 0x73686164;
// Harmonics of degree 2 are inexact. They change the light of the smooth normal at most so much.
constexpr double most_change = 4.0;

// Real spherical harmonics (Ramamoorthi and Hanrahan, "An efficient representation for irradiance
// environment maps", 2001).
std::array<double, 9> harmonics_at(const glm::dvec3& d) {
    return {0.282095,
            0.488603 * d.y,
            0.488603 * d.z,
            0.488603 * d.x,
            1.092548 * d.x * d.y,
            1.092548 * d.y * d.z,
            0.315392 * (3.0 * d.z * d.z - 1.0),
            1.092548 * d.x * d.z,
            0.546274 * (d.x * d.x - d.y * d.y)};
}

// The diffuse lobe for a light at this cosine, per unit of diffuse colour.
double diffuse_lobe(double cosine) {
    return diffuse_colour({.diffuse = glm::dvec3(1.0)}).x * std::max(cosine, 0.0);
}

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

} // namespace

Result<PlaceLight> PlaceLight::make(const ModelPlaces& places, const Tracer& tracer,
                                    const DistantLights& lights, const PlaceLightOptions& options,
                                    const BakeRun& run) {
    PlaceLight made;
    const std::size_t count = places.texels();
    made.size_ = places.texel_places().size();
    made.lights_ = lights.count();
    made.matters_.assign(count, 0);
    made.visibility_.assign(count * lights.count(), 0);
    made.charts_.assign(count, 0);
    made.diffuse_.resize(count);
    made.harmonics_.resize(count);
    made.smooth_.resize(count);
    TESSERA_TRY(for_rows("baking light", made.size_[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < made.size_[0]; ++u)
            if (places.texel_places().matters(u, v) && !places.is_hidden(u, v)) {
                made.matters_[made.index(u, v)] = 1;
                made.bake(places, tracer, lights, options, u, v);
            }
    }));
    return made;
}

void PlaceLight::bake(const ModelPlaces& places, const Tracer& tracer, const DistantLights& lights,
                      const PlaceLightOptions& options, std::uint32_t u, std::uint32_t v) {
    const std::size_t at = index(u, v);
    const ModelSurfacePlace centre = places.place(u, v, {0.0, 0.0});
    charts_[at] = static_cast<std::uint32_t>(places.texel_places().chart_of(centre.on.triangle));
    const glm::dvec3 middle = centre.frame.ez;
    glm::dvec3 lit(0.0);
    std::array<glm::dvec3, 9> sums{};
    const auto add = [&](const glm::dvec3& direction, const glm::dvec3& light) {
        lit += light * diffuse_lobe(glm::dot(middle, direction));
        const std::array<double, 9> basis = harmonics_at(direction);
        for (std::size_t i = 0; i < basis.size(); ++i)
            sums[i] += light * basis[i];
    };
    const std::uint64_t paths = mix_bits(options.seed + irradiance_paths);
    // A share of them goes to emitting triangles.
    const unsigned path_count = options.diffuse_samples * (tracer.has_emitters() ? 3 : 1);
    const double share = 1.0 / path_count;
    for (unsigned i = 0; i < path_count; ++i) {
        PathRandom random(paths, i);
        ModelSurfacePlace place = places.place(u, v, random.next2() - 0.5);
        place.point.normal = place.frame.ez; // the same for all bumps
        const Tracer::Incoming incoming = tracer.incoming_of_model(place.point, random);
        if (incoming.density > 0.0)
            add(incoming.direction, incoming.light * (share / incoming.density));
        for (const ModelLamp& lamp : tracer.light().lamps) {
            if (lamp.kind == ModelLamp::Kind::directional)
                continue; // it is one of `lights`
            const LampLight l = lamp_light(lamp, place.point.position);
            add(l.direction,
                l.irradiance * share * tracer.unblocked(place.point, l.direction, l.distance));
        }
    }
    // The environment's own light needs rays only, so more of them are cheap.
    const std::uint64_t shadows = mix_bits(options.seed + shadow_paths);
    std::vector<double> seen(lights.count(), 0.0);
    const unsigned rays = rays_per_light(options, lights.count());
    for (unsigned i = 0; i < rays; ++i) {
        PathRandom random(shadows, i);
        const LitPoint point = places.place(u, v, random.next2() - 0.5).point;
        for (std::size_t j = 0; j < lights.count(); ++j) {
            const DistantLights::Sample sample = lights.sample(j, random.next2());
            const glm::dvec3 arrives = tracer.unblocked(point, sample.direction);
            seen[j] += mean_of(arrives);
            add(sample.direction, arrives * sample.irradiance / static_cast<double>(rays));
        }
    }
    diffuse_[at] = glm::vec3(lit);
    for (std::size_t i = 0; i < sums.size(); ++i)
        harmonics_[at][i] = glm::vec3(sums[i]);
    smooth_[at] = convolved(harmonics_[at], glm::dvec3(glm::vec3(middle)));

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
            const glm::dvec3 bumped = convolved(harmonics_[at], normal);
            glm::dvec3 change(1.0);
            for (glm::length_t c = 0; c < 3; ++c)
                change[c] =
                    smooth[c] > 1e-6 ? std::clamp(bumped[c] / smooth[c], 0.0, most_change) : 1.0;
            sum += weight * glm::dvec3(diffuse_[at]) * change;
            weights += weight;
        }
    if (weights <= 0.0)
        return std::nullopt;
    return sum / weights;
}

} // namespace tessera::corpus
