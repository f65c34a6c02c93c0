#include "corpus/layers/layer_density.h"

#include "corpus/model_surface/chart_detail.h"

namespace tessera::corpus {

LayerDensity layer_density(const Model& model, std::optional<double> texels) {
    constexpr LayerDensity usual{.texels = 1'000'000, .light_texel = 2},
        fine{.texels = 4'000'000, .light_texel = 4};
    double pictured = 0;
    for (const ModelTriangle& triangle : model.triangles)
        pictured += material_texels(model, triangle);
    LayerDensity density =
        pictured >= fine.texels && texels.value_or(fine.texels) >= fine.texels ? fine : usual;
    density.texels = texels.value_or(density.texels);
    return density;
}

} // namespace tessera::corpus
