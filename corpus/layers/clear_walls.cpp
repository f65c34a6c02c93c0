#include "corpus/layers/clear_walls.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

constexpr double clear_roughness = 0.05; // as in trace/transmission.cpp

bool is_clear_wall(const ModelMaterial& m) {
    return m.coats && m.coats->through > 0.0 && !m.coats->is_volume &&
           m.coats->through_texture.image < 0 && m.base_texture.image < 0 && !m.blends &&
           m.cutoff == 0.0 && !m.has_glossiness && m.metal == 0.0 && m.roughness <= clear_roughness;
}

} // namespace

void make_clear_walls_blend(Model& model) {
    for (ModelMaterial& m : model.materials) {
        if (!is_clear_wall(m))
            continue;
        const glm::dvec3 colour(m.base);
        const double tint = glm::dot(colour, {0.2126, 0.7152, 0.0722});
        const glm::dvec3 mirrored = m.reflectance * m.specular * m.specular_colour;
        const double facing = std::min(std::max({mirrored.x, mirrored.y, mirrored.z}), 1.0);
        const double opacity =
            std::max(1.0 - m.coats->through * tint * (1.0 - facing), 1.0 / 255.0);
        // Layers multiply the wall's own light by its opacity.
        m.base = {glm::min(colour * (1.0 - m.coats->through) / opacity, 1.0), opacity};
        m.reflectance = std::min(facing / opacity, 1.0);
        m.specular = 1.0;
        m.specular_colour = glm::dvec3(1.0);
        m.coats->through = 0.0;
        m.blends = true;
    }
}

} // namespace tessera::corpus
