#include "corpus/layers/sharp_reflections.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

namespace tessera::corpus {
namespace {

constexpr double most_roughness = 0.2;
constexpr double least_share = 0.1;
constexpr double most_places = 10'000; // of the whole atlas

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

bool reflects_sharply(const Model& model) {
    std::vector<Mirror> mirrors;
    for (const ModelMaterial& material : model.materials)
        mirrors.push_back(mirror_of(model, material));
    double all = 0, sharp = 0;
    for (const ModelTriangle& triangle : model.triangles) {
        const Mirror& mirror = mirrors[triangle.material];
        const double reflects = glm::length(area_vector(model, triangle)) * mirror.reflectance;
        all += reflects;
        if (mirror.roughness <= most_roughness)
            sharp += reflects;
    }
    return sharp > least_share * all;
}

ReflectionLayout reflection_layout(const Model& model, bool sharp, double texels) {
    if (!sharp)
        return has_lamps(model) ? ReflectionLayout{.directions = 16, .fewer_paths = 2}
                                : ReflectionLayout();
    ReflectionLayout layout{.texel = 2, .directions = 24, .fewer_paths = 4};
    while (texels > most_places * layout.texel * layout.texel)
        layout.texel *= 2;
    return layout;
}

} // namespace tessera::corpus
