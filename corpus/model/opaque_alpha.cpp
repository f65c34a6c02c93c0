#include "corpus/model/opaque_alpha.h"

#include "format/layers.h"

#include <algorithm>

namespace tessera::corpus {
namespace {

// The least alpha of the vertices of each material's triangles.
std::vector<double> least_of_vertices(const Model& model) {
    std::vector<double> least(model.materials.size(), 1.0);
    for (const ModelTriangle& triangle : model.triangles)
        for (const std::uint32_t vertex : triangle.vertices)
            least[triangle.material] = std::min(
                least[triangle.material], static_cast<double>(model.vertices[vertex].colour.a));
    return least;
}

double least_of_image(const Model& model, const TextureUse& use) {
    if (use.image < 0)
        return 1.0;
    std::uint8_t least = 255;
    for (const auto& texel : model.images[static_cast<std::size_t>(use.image)].texels)
        least = std::min(least, texel[3]);
    return least / 255.0;
}

} // namespace

void ignore_opaque_alpha(Model& model) {
    const std::vector<double> of_vertices = least_of_vertices(model);
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
        ModelMaterial& m = model.materials[i];
        if (!m.blends && m.cutoff <= 0.0)
            continue;
        const double least = m.base.a * of_vertices[i] * least_of_image(model, m.base_texture);
        m.blends = m.blends && least < full_opacity;
        if (least >= m.cutoff)
            m.cutoff = 0.0;
    }
}

} // namespace tessera::corpus
