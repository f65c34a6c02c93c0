#include "corpus/layers/light_layers.h"

#include "corpus/layers/place_cells.h"
#include "corpus/layers/shown_visibility.h"
#include "corpus/trace/path_random.h"
#include "corpus/trace/reflection.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t reflection_paths = 0x72666C63;
constexpr double most_reflection = 64.0; // times white
// The brightest texels are noise of rare paths. If they set the scale, all others lose precision.
constexpr double noisy_share = 1e-3;

// The light of which a surface that reflects so much at normal incidence shows three times white. A
// display cannot show more, but interpolation would spread brighter texels over dark neighbours. The
// margin is for the noise of few paths, whose mean must not become too dark. Channels that hardly
// reflect do not set the scale of all.
glm::dvec3 shown_light(const glm::dvec3& reflectance) {
    constexpr double most_shown = 3.0, least_share = 0.25, least_reflectance = 0.02;
    const double most = std::max({reflectance.x, reflectance.y, reflectance.z, least_reflectance});
    return most_shown / glm::max(reflectance, least_share * most);
}

// The mean light from the mirrored direction (s, t) at the texels, weighted by their specular lobe:
// what they mirror, divided by what they would mirror of white light. At most what a display can show
// of it where they reflect least.
glm::dvec3 reflection_at(const std::vector<Texels2>& texels, const ModelPlaces& places,
                         const OpenPlaces& open, const Tracer& tracer, const NearestLobes& nearest,
                         const ReflectionOptions& options, double s, double t) {
    glm::dvec3 sum(0.0), weights(0.0), least(1.0);
    for (unsigned i = 0; i < options.samples; ++i) {
        PathRandom random(mix_bits(options.seed + reflection_paths), i);
        const Texels2& texel = chosen_place(texels, random.next());
        ModelSurfacePlace at = open.smooth_place(places, texel[0], texel[1], random.next2());
        const glm::dvec3 view = mirrored_view(at.frame, s, t);
        const Lobes lobes = nearest(at.point.lobes);
        least = glm::min(least, lobes.facing);
        at.point.lobes = {.facing = lobes.facing, .alpha = lobes.alpha, .grazing = lobes.grazing};
        at.point.opacity = 1.0;
        const SpecularLobe lobe{at.point, view};
        if (const Thrown white = lobe(lobe.sample(random)); white.density > 0.0)
            weights += white.share / white.density;
        sum += options.distant ? tracer.specular(at.point, view, random)
                               : tracer.specular_of_model(at.point, view, random);
    }
    return glm::min(sum * options.exposure / glm::max(weights, 1e-6), shown_light(least));
}

// Dim reflections need less precision: an error of a sample is multiplied by the scale.
double quality_for_scale(double scale) {
    constexpr double usual_scale = 8.0, per_doubling = 3.5;
    return std::clamp(per_doubling * std::log2(scale / usual_scale), -36.0, 6.0);
}

// Quality for a visibility of which a display shows so much; see shown_error_of_visibility().
double quality_for_shown_error(double shown) {
    constexpr double usual = 0.25, per_doubling = 16.0; // the first: FlightHelmet
    return std::clamp(per_doubling * std::log2(std::max(shown, 1e-6) / usual), -30.0, 0.0);
}

} // namespace

Result<LayerTexture> bake_visibility_layer(const ModelPlaces& places, const PlaceLight& light,
                                           std::span<const DistantLight> lights, double exposure,
                                           const BakeRun& run) {
    constexpr double deep_below = -0.3; // no bump turns there
    const Texels2 size = places.texel_places().size();
    std::uint32_t side = 1;
    while (side * side < lights.size())
        ++side;
    const Extent4 whole{size[0], size[1], side, side};
    LayerTexture texture = make_layer(LayerRole::visibility, whole, 1);
    texture.tile = {16, 16, side, side};
    const std::vector<double> peaks = visibility_peaks(lights);
    TESSERA_TRY(for_rows("baking visibility", size[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            if (!light.matters(u, v))
                continue;
            const ModelSurfacePlace place = places.place(u, v, {0.0, 0.0});
            const glm::dvec3 normal = place.frame.ez;
            // Layers mirror at grazing views even where the specular colour is black.
            const bool mirrors = place.point.lobes.grazing > 0.0;
            const std::size_t first = (std::size_t{v} * size[0] + u) * side * side;
            for (std::size_t j = 0; j < lights.size(); ++j) {
                const double seen = mirrors ? light.visibility(u, v, j) / 255.0 : 0.0;
                store_values(texture, first + j, {peaks[j] * seen});
                if (glm::dot(normal, glm::dvec3(lights[j].direction)) < deep_below)
                    texture.mask[first + j] = std::byte{0};
            }
        }
    }));
    texture.quality_change =
        quality_for_shown_error(shown_error_of_visibility(places, light, lights, exposure));
    return texture;
}

Result<LayerTexture> bake_reflection_layer(const ModelPlaces& places, const PlaceLight& light,
                                           const Tracer& tracer, const NearestLobes& nearest,
                                           const ReflectionOptions& options, const BakeRun& run) {
    const std::uint32_t step = std::max(options.cell, 1u);
    const Texels2 all = places.texel_places().size();
    const Texels2 size = cells_of_places(all, step);
    const auto [columns, rows] = options.directions;
    LayerTexture texture = make_cell_layer(LayerRole::reflection, size, options.directions);
    LightTexels arriving(texel_count(texture.desc.size), glm::vec3(0.0f));
    TESSERA_TRY(for_rows("baking reflections", size[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            const std::vector<Texels2> texels =
                places_of_cell(u, v, step, all, [&](std::uint32_t x, std::uint32_t y) {
                    return light.matters(x, y);
                });
            if (texels.empty())
                continue;
            const std::size_t cell = std::size_t{v} * size[0] + u;
            texture.mask[cell] = std::byte{1};
            for (std::uint32_t t = 0; t < rows; ++t)
                for (std::uint32_t s = 0; s < columns; ++s)
                    arriving[(cell * rows + t) * columns + s] =
                        glm::vec3(reflection_at(texels, places, light.open(), tracer, nearest,
                                                options, (s + 0.5) / columns, (t + 0.5) / rows));
        }
    }));
    store_light(texture, arriving, most_reflection, noisy_share);
    texture.quality_change = quality_for_scale(texture.scale);
    return texture;
}

} // namespace tessera::corpus
