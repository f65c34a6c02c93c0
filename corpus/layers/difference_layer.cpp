#include "corpus/layers/difference_layer.h"

#include "corpus/layers/material_layers.h"
#include "corpus/layers/place_cells.h"
#include "corpus/layers/texel_paths.h"
#include "corpus/model/model.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr std::uint64_t difference_paths = 0x64696666;
// Glass mirrors the same light in the layers, so that few paths do for it.
constexpr unsigned one_mirrored_of = 4;
constexpr double least_difference = 0.01; // root of the mean square that is worth a layer

// What a display would show if it had some more light than white, up to the value `most`. Noisy
// light, and samples between white and darker ones, would be too dark if each were cut at white.
double shown_with_headroom(double light, double most) {
    constexpr double slope = 1.055 / 2.4; // of sRGB at white
    return light <= 1.0 ? linear_to_srgb(light) : std::min(1.0 + slope * (light - 1.0), most);
}

// Groups of coated places.
struct CoatedCells {
    std::uint32_t step = 1; // places along a side
    Texels2 size{0, 0};
    std::size_t coated = 0;
};

CoatedCells cells_of(const std::vector<bool>& coated, const Texels2& all, std::uint32_t step) {
    CoatedCells cells{step, cells_of_places(all, step)};
    std::vector<bool> any(std::size_t{cells.size[0]} * cells.size[1], false);
    for (std::uint32_t v = 0; v < all[1]; ++v)
        for (std::uint32_t u = 0; u < all[0]; ++u)
            if (coated[std::size_t{v} * all[0] + u])
                any[std::size_t{v / step} * cells.size[0] + u / step] = true;
    cells.coated = static_cast<std::size_t>(std::ranges::count(any, true));
    return cells;
}

// How differences are found. Light that passes is noisy: with the same paths everywhere, all places
// and directions would have the same error. Coats reflect less noisy light, and with the same paths
// differences take 8 % fewer bytes.
struct DifferencePaths {
    std::uint64_t seed = 1;
    bool separate = false; // other paths in each direction, and in each cell
    double most = 1.0;     // value of a display
};

// A place of a cell and what does not depend on the view there.
struct CellPlace {
    ModelSurfacePlace at;
    LitPoint bare; // as layers have it
    bool mirrors_as_bare = false;
    glm::dvec3 diffuse{0.0}; // its diffuse light, and what all layers have without highlights
    glm::dvec3 constant{0.0};
};

class CellOfPlaces {
public:
    CellOfPlaces(const ModelPlaces& places, const PlaceLight& light, const Tracer& tracer,
                 const NearestLobes& nearest, const std::vector<Texels2>& texels, unsigned samples,
                 const DifferencePaths& paths, double exposure)
        : tracer_(tracer), paths_(paths), exposure_(exposure) {
        for (unsigned i = 0; i < samples; ++i) {
            PathRandom random(paths.seed, i);
            const Texels2& texel = chosen_place(texels, random.next());
            CellPlace place;
            const glm::dvec2 offset = light.open().offset(texel[0], texel[1], random.next2());
            place.at = places.place(texel[0], texel[1], offset);
            LitPoint& point = place.at.point;
            point.normal = place.at.frame.ez;
            point.opacity = 1.0;
            const Lobes lobes = nearest(point.lobes);
            place.bare = point;
            place.bare.lobes = {.facing = lobes.facing, .alpha = lobes.alpha};
            place.mirrors_as_bare = !reflects_by_coats(point.lobes) && point.lobes.grazing == 1.0;
            const auto arriving = light.diffuse(glm::dvec2(texel[0] + 0.5, texel[1] + 0.5) + offset,
                                                place.at.chart, point.normal);
            if (!arriving)
                continue;
            place.diffuse = point.lobes.diffuse * *arriving;
            place.constant = lobes.diffuse * *arriving + mean_transmitted(tracer, point, exposure);
            places_.push_back(place);
        }
    }

    // The difference of display values in the mirrored directions of texel (x, y) of side * side.
    glm::vec3 difference(std::uint32_t x, std::uint32_t y, std::uint32_t side) const {
        const TexelPaths paths(mix_bits(paths_.seed), static_cast<unsigned>(places_.size()),
                               paths_.separate ? x : 0, paths_.separate ? y : 0);
        const double s = (x + 0.5) / side, t = (y + 0.5) / side;
        glm::dvec3 all(0.0), layers(0.0), both(0.0);
        unsigned alike = 0, mirrored = 0;
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const CellPlace& place = places_[i];
            const glm::dvec3 view = mirrored_view(place.at.frame, s, t);
            const LitPoint point = Tracer::facing(place.at.point, view);
            PathRandom random = paths[static_cast<unsigned>(i)], same = random;
            all += place.diffuse * below_coats(point, view) + place.at.point.emission;
            layers += place.constant + place.at.point.emission;
            if (!place.mirrors_as_bare) {
                all += tracer_.specular(point, view, random);
                layers += tracer_.specular(place.bare, view, same);
                continue;
            }
            all += tracer_.transmitted(point, view, random);
            if (alike++ % one_mirrored_of == 0) {
                both += tracer_.specular(place.bare, view, same);
                ++mirrored;
            }
        }
        if (mirrored > 0)
            both *= static_cast<double>(alike) / mirrored;
        all += both;
        layers += both;
        const double factor =
            exposure_ / std::max<double>(1.0, static_cast<double>(places_.size()));
        glm::vec3 change;
        for (glm::length_t c = 0; c < 3; ++c)
            change[c] = static_cast<float>(shown_with_headroom(all[c] * factor, paths_.most) -
                                           linear_to_srgb(layers[c] * factor));
        return change;
    }

private:
    const Tracer& tracer_;
    DifferencePaths paths_;
    double exposure_;
    std::vector<CellPlace> places_;
};

// An error of a sample changes display values by the scale, and steps between charts are seen.
double quality_for_difference(double scale) {
    constexpr double usual_scale = 0.6, usual = 6.0, per_doubling = 8.0;
    return std::clamp(usual + per_doubling * std::log2(scale / usual_scale), -12.0, 8.0);
}

} // namespace

Result<std::optional<LayerTexture>>
bake_difference_layer(const ModelPlaces& places, const PlaceLight& light, const Tracer& tracer,
                      const NearestLobes& nearest, const DifferenceOptions& options,
                      const BakeRun& run) {
    // Most models have none, and their places need no look.
    if (std::ranges::none_of(places.model()->model().materials,
                             [](const ModelMaterial& m) { return m.coats.has_value(); }))
        return std::optional<LayerTexture>();
    const Texels2 all = places.texel_places().size();
    std::vector<bool> coated(places.texels(), false);
    bool passes = false;
    for (std::uint32_t v = 0; v < all[1]; ++v)
        for (std::uint32_t u = 0; u < all[0]; ++u) {
            if (!light.matters(u, v))
                continue;
            const Lobes lobes = places.place(u, v, {0.0, 0.0}).point.lobes;
            if (!differs_by_coats(lobes))
                continue;
            coated[std::size_t{v} * all[0] + u] = true;
            passes = passes || lobes.coats.through != glm::dvec3(0.0);
        }
    // Which way light passes curved surfaces changes from place to place, twice as fast as their
    // normal for the same mirrored direction.
    const std::uint32_t side = passes ? 12 : 16;
    const std::size_t most_cells = passes ? 2048 : 1024;
    CoatedCells cells = cells_of(coated, all, passes ? 2 : 4);
    if (cells.coated == 0)
        return std::optional<LayerTexture>();
    while (cells.coated > most_cells)
        cells = cells_of(coated, all, 2 * cells.step);
    const auto samples = static_cast<unsigned>(std::clamp<double>(
        static_cast<double>(options.paths) / static_cast<double>(cells.coated * side * side), 8.0,
        64.0));
    LayerTexture texture = make_cell_layer(LayerRole::difference, cells.size, {side, side});
    LightTexels values(texel_count(texture.desc.size), glm::vec3(0.0f));
    std::vector<double> squares(cells.size[1], 0.0);
    TESSERA_TRY(for_rows("baking coats", cells.size[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < cells.size[0]; ++u) {
            const std::vector<Texels2> texels =
                places_of_cell(u, v, cells.step, all, [&](std::uint32_t x, std::uint32_t y) {
                    return coated[std::size_t{y} * all[0] + x];
                });
            if (texels.empty())
                continue;
            const std::size_t cell = std::size_t{v} * cells.size[0] + u;
            texture.mask[cell] = std::byte{1};
            DifferencePaths paths{.seed = mix_bits(options.seed + difference_paths)};
            if (passes)
                paths = {.seed = paths.seed + cell, .separate = true, .most = 1.3};
            const CellOfPlaces group(places, light, tracer, nearest, texels, samples, paths,
                                     options.exposure);
            for (std::uint32_t t = 0; t < side; ++t)
                for (std::uint32_t s = 0; s < side; ++s) {
                    glm::vec3& value = values[(cell * side + t) * side + s];
                    value = group.difference(s, t, side);
                    squares[v] += static_cast<double>(glm::dot(value, value)) / 3.0;
                }
        }
    }));
    double square = 0;
    for (const double x : squares)
        square += x;
    const auto count = static_cast<double>(cells.coated * side * side);
    if (std::sqrt(square / count) < least_difference)
        return std::optional<LayerTexture>();
    store_differences(texture, values);
    texture.quality_change = quality_for_difference(texture.scale);
    return std::optional<LayerTexture>(std::move(texture));
}

} // namespace tessera::corpus
