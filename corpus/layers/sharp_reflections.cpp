#include "corpus/layers/sharp_reflections.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace tessera::corpus {
namespace {

constexpr double most_roughness = 0.2, most_metal_roughness = 0.305; // roughness has 8 bits
constexpr double metal = 0.3;                                        // reflects at least so much
constexpr double least_share = 0.1, least_metal_share = 0.5;

// The mean of a channel of the texture; 1 without one.
double mean_of(const Model& model, const TextureUse& use, std::size_t channel) {
    if (use.image < 0)
        return 1.0;
    const Image& image = model.images[static_cast<std::size_t>(use.image)];
    double sum = 0;
    for (const auto& texel : image.texels)
        sum += texel[channel] / 255.0;
    return image.texels.empty() ? 1.0 : sum / static_cast<double>(image.texels.size());
}

struct Mirror {
    double reflectance = 0, roughness = 1;
};

Mirror mirror_of(const Model& model, const ModelMaterial& m) {
    if (m.is_unlit)
        return {};
    const TextureUse& texture = m.metal_roughness_texture;
    if (m.has_glossiness) {
        const glm::dvec3& colour = m.specular_colour;
        return {std::max({colour.x, colour.y, colour.z}),
                1.0 - (1.0 - m.roughness) * mean_of(model, texture, 3)};
    }
    const double metal = m.metal * mean_of(model, texture, 2);
    return {metal * std::max({m.base.x, m.base.y, m.base.z}) + (1.0 - metal) * m.reflectance,
            m.roughness * mean_of(model, texture, 1)};
}

bool has_lamps(const Model& model) {
    return std::ranges::any_of(model.triangles, [&](const ModelTriangle& triangle) {
        return is_lamp(model.materials[triangle.material]);
    });
}

} // namespace

ModelMirrors::ModelMirrors(const Model& model) : has_lamps_(has_lamps(model)) {
    std::vector<Mirror> mirrors;
    for (const ModelMaterial& material : model.materials)
        mirrors.push_back(mirror_of(model, material));
    double all = 0, sharp = 0, sharp_metal = 0, smooth_metal = 0;
    for (const ModelTriangle& triangle : model.triangles) {
        const Mirror& mirror = mirrors[triangle.material];
        const double reflects = glm::length(area_vector(model, triangle)) * mirror.reflectance;
        all += reflects;
        const bool is_sharp = mirror.roughness <= most_roughness;
        const bool is_metal = mirror.reflectance > metal;
        if (is_sharp)
            sharp += reflects;
        if (is_sharp && is_metal)
            sharp_metal += reflects;
        if (is_metal && mirror.roughness <= most_metal_roughness)
            smooth_metal += reflects;
    }
    if (!(all > 0.0))
        return;
    sharp_share_ = sharp / all;
    sharp_metal_share_ = sharp_metal / all;
    smooth_metal_share_ = smooth_metal / all;
}

bool ModelMirrors::is_sharp() const {
    return sharp_share_ > least_share;
}

// Images of the model itself change from place to place, so that many places with coarse steps show
// them better than few with fine ones. On smooth metal, each further path adds edges that all have
// to be coded. Rough metal has noise instead. What other materials mirror is dim, and takes fewer
// directions and places.
ReflectionLayout ModelMirrors::layout(double texels) const {
    constexpr double most_sharp_places = 40'000, most_metal_places = 10'000, // of the whole atlas
        most_dim_places = 2'500;
    ReflectionLayout layout{
        .texel = 2, .directions = 24, .quality_change = -14.0, .many_places = true};
    double most_places = most_sharp_places;
    if (sharp_metal_share_ > least_share) {
        layout.fewer_paths = 16;
    } else if (smooth_metal_share_ > least_metal_share) {
        layout.fewer_paths = 8;
        most_places = most_metal_places;
    } else if (is_sharp()) {
        layout = {.texel = 2, .directions = 16, .fewer_paths = 8, .quality_change = -6.0};
        most_places = most_dim_places;
    } else {
        return has_lamps_ ? ReflectionLayout{.directions = 16, .fewer_paths = 2}
                          : ReflectionLayout();
    }
    while (texels > most_places * layout.texel * layout.texel)
        layout.texel *= 2;
    return layout;
}

double normal_quality_change(double share) {
    constexpr double all = 12.0, per_doubling = 4.0;
    return share > 0.0 ? std::max(all + per_doubling * std::log2(share), 0.0) : 0.0;
}

double visibility_quality_change(std::uint32_t places) {
    constexpr double per_doubling = -4.0, least = -8.0;
    return std::max(per_doubling * std::log2(static_cast<double>(places)), least);
}

} // namespace tessera::corpus
