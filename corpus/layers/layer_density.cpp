#include "corpus/layers/layer_density.h"

#include "corpus/model_surface/chart_detail.h"

#include <algorithm>

namespace tessera::corpus {

LayerDensity layer_density(const Model& model, std::optional<double> texels) {
    constexpr double per_pictured = 3, least = 1e6, most = 2e6;
    constexpr LayerDensity fine{.texels = 4e6, .light_texel = 4};
    double pictured = 0;
    for (const ModelTriangle& triangle : model.triangles)
        pictured += material_texels(model, triangle);
    LayerDensity density{.texels = std::clamp(per_pictured * pictured, least, most)};
    if (pictured >= fine.texels && texels.value_or(fine.texels) >= fine.texels)
        density = fine;
    density.texels = texels.value_or(density.texels);
    return density;
}

} // namespace tessera::corpus
