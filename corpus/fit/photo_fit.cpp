#include "corpus/fit/photo_fit.h"

#include "corpus/fit/fit_atlas.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr double most_direction_texels = 8e6; // of the field of groups

enum FieldPart : std::size_t { colour, shared, local };

class MeshFields final : public FittedFields {
public:
    MeshFields(const ModelAtlas& atlas, const PhotoFitOptions& options) {
        fields.push_back(make_field(atlas, options.cell, 1));
        fields.push_back(make_shared_field(options.shared_directions));
        fields.push_back(make_field(atlas, 1, options.directions));
    }

    // Errors of a fit are not noise: those of neighbouring pixels and of many photographs are alike.
    // So costs of neighbours grow with the number of pixels that see a texel. The factors are those
    // with which photographs that were kept out fit best, of a metal (smoothness 0.25) and of boxes
    // (4).
    void set_costs(const PhotoSamples& samples, double smoothness) override {
        const auto seen = [&](FieldPart part) { return seen_weight(fields[part], samples); };
        fields[colour].smooth_places = 0.1 * seen(colour);
        fields[colour].shrink = 1e-5 * seen(colour);
        fields[shared].smooth_directions = 0.1 * smoothness * smoothness * seen(shared);
        fields[shared].shrink = 1e-5 * seen(shared);
        fields[local].smooth_directions = 0.5 * smoothness * seen(local);
        fields[local].smooth_places = 2.0 * std::pow(smoothness, 1.5) * seen(local);
        fields[local].shrink = 0.1 * seen(local);
    }
};

// Values of 0..1 as a layer of colour, those around 0 as one of differences.
// `seen` are the texels that are not masked, of those of visible places; empty: all.
LayerTexture layer_of(const TextureField& field, const SurfaceMesh& mesh,
                      const std::vector<bool>& seen, LayerRole role, std::uint32_t tile_places,
                      double quality_change) {
    const std::uint32_t n = field.directions[0];
    LayerTexture layer = make_layer(role, {field.width, field.height, n, n}, 3);
    const bool is_colour = role == LayerRole::diffuse;
    layer.transfer = is_colour ? Transfer::srgb : Transfer::unspecified;
    double most = 1e-3;
    if (!is_colour)
        for (const float x : field.values)
            most = std::max(most, std::abs(static_cast<double>(x)));
    layer.scale = is_colour ? 1.0 : std::min(most, 1.0);
    const std::vector<bool> visible =
        field.places() == 1 ? std::vector<bool>(1, true) : visible_places(mesh, field);
    const std::size_t per_place = field.texels_per_place();
    const auto value = [&](std::size_t i) {
        const auto x = static_cast<double>(field.values[i]);
        return is_colour ? x : (128.0 + 127.0 * std::clamp(x / layer.scale, -1.0, 1.0)) / 255.0;
    };
    for (std::size_t place = 0; place < field.places(); ++place)
        if (visible[place])
            for (std::size_t k = 0; k < per_place; ++k) {
                // The field's order is that of textures: v, u, t, s.
                const std::size_t texel = place * per_place + k;
                store_values(layer, texel,
                             {value(3 * texel), value(3 * texel + 1), value(3 * texel + 2)});
                if (!seen.empty() && !seen[texel])
                    layer.mask[texel] = std::byte{0};
            }
    layer.quality_change = quality_change;
    layer.tile = {std::min(tile_places, field.width), std::min(tile_places, field.height),
                  std::min(n, 32u), std::min(n, 32u)};
    return layer;
}

Status check(const PhotoFitOptions& o, std::size_t photographs) {
    if (photographs == 0)
        return {ErrorCode::bad_argument, "there are no photographs"};
    if (o.cell < 1 || o.cell > 64 || o.directions < 1 || o.directions > 128 ||
        o.shared_directions < 1 || o.shared_directions > 256)
        return {ErrorCode::bad_argument,
                "cells have 1 to 64 texels, groups 1 to 128 directions, all places 1 to 256"};
    if (!(o.most_texels >= 1.0 && o.most_texels <= 1e8) || !(o.density >= 0.0))
        return {ErrorCode::bad_argument, "texels are 1 to 10^8, the density is at least 0"};
    return {};
}

Result<ModelAtlas> make_fit_atlas(const Model& model, std::span<const PosedPhotograph> photographs,
                                  const PhotoFitOptions& options) {
    double density = options.density;
    if (density == 0.0) {
        TESSERA_TRY_ASSIGN(density, density_of_pixels(model, photographs));
    }
    const double area = surface_area(model);
    density = std::min(density, std::sqrt(options.most_texels / area));
    const double places = most_direction_texels / (options.directions * options.directions);
    ModelAtlasOptions layout;
    layout.density = std::min(density / options.cell, std::sqrt(places / area));
    layout.tile = {4, 4};
    layout.position_bits = options.position_bits;
    layout.normal_bits = options.normal_bits;
    return make_model_atlas(model, layout);
}

} // namespace

Result<PhotoFit> fit_photographs(const Model& model, std::span<const PosedPhotograph> photographs,
                                 const PhotoFitOptions& options) {
    TESSERA_TRY(check(options, photographs.size()));
    PhotoFit out;
    TESSERA_TRY_ASSIGN(const ModelAtlas atlas, make_fit_atlas(model, photographs, options));
    TESSERA_TRY_ASSIGN(const SeenMesh mesh, SeenMesh::make(atlas.mesh));
    MeshFields fitted(atlas, options);
    TESSERA_TRY_ASSIGN(static_cast<PhotoFindings&>(out),
                       solve_photographs(mesh, fitted, photographs, options));

    out.layers.mesh = atlas.stream;
    out.layers.decoded_mesh = atlas.mesh;
    out.layers.charts = atlas.charts.size();
    out.layers.density = atlas.density * options.cell;
    const auto add = [&](FieldPart part, LayerRole role, std::uint32_t tile_places,
                         double quality_change) {
        const std::vector<bool> all;
        out.layers.layers.push_back(layer_of(fitted.fields[part], atlas.mesh,
                                             options.masks_unseen ? fitted.seen[part] : all, role,
                                             tile_places, quality_change));
    };
    // Errors of the smooth colours of a fit are seen less than those of a model's textures, and all
    // places see those of the shared differences, which take few bytes.
    add(colour, LayerRole::diffuse, 64, -10.0);
    add(shared, LayerRole::shared_difference, 1, 20.0);
    add(local, LayerRole::difference, 16, 0.0);
    return out;
}

} // namespace tessera::corpus
