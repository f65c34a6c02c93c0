#include "corpus/layers/layer_texture.h"

#include "corpus/model/model.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

constexpr double least_scale = 1e-3;

std::byte to_unorm8(double x) {
    return static_cast<std::byte>(static_cast<unsigned>(255.0 * std::clamp(x, 0.0, 1.0) + 0.5));
}

} // namespace

LayerTexture make_layer(LayerRole role, const Extent4& size, std::uint8_t channels) {
    LayerTexture layer;
    layer.role = role;
    layer.desc = {size, SampleType::unorm8, channels};
    layer.texels.assign(layer.desc.box_bytes(Box4::whole(size)), std::byte{0});
    layer.mask_desc = {size, SampleType::unorm8, 1};
    layer.mask.assign(texel_count(size), std::byte{0});
    return layer;
}

void store_values(LayerTexture& layer, std::size_t texel, std::initializer_list<double> values) {
    std::byte* at = layer.texels.data() + texel * layer.desc.channels;
    for (const double value : values)
        *at++ = to_unorm8(value);
    layer.mask[texel] = std::byte{1};
}

namespace {

// The light that at most this share of the lit texels exceeds.
double exceeded_by(double share, const LightTexels& light) {
    std::vector<float> lit;
    for (const glm::vec3& x : light)
        if (const float most = std::max({x.x, x.y, x.z}); most > 0.0f)
            lit.push_back(most);
    if (lit.empty())
        return 0.0;
    const auto from_top = static_cast<std::ptrdiff_t>(share * static_cast<double>(lit.size()));
    std::ranges::nth_element(lit, lit.begin() + from_top, std::greater<>());
    return static_cast<double>(lit[static_cast<std::size_t>(from_top)]);
}

template <class Stored>
void store_as(LayerTexture& layer, const LightTexels& light, double most, double clipped,
              const Stored& stored) {
    layer.scale = std::clamp(exceeded_by(clipped, light), least_scale, most);
    layer.transfer = Transfer::srgb;
    for (std::size_t i = 0; i < light.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c)
            layer.texels[3 * i + static_cast<std::size_t>(c)] =
                to_unorm8(stored(static_cast<double>(light[i][c]) / layer.scale));
}

} // namespace

void store_light(LayerTexture& layer, const LightTexels& light, double most, double clipped) {
    store_as(layer, light, most, clipped, linear_to_srgb);
}

void store_wide_light(LayerTexture& layer, const LightTexels& light, double most) {
    store_as(layer, light, most, 0.0, [](double x) { return linear_to_srgb(std::sqrt(x)); });
}

void store_differences(LayerTexture& layer, const LightTexels& values) {
    layer.scale = least_scale;
    for (const glm::vec3& x : values)
        for (glm::length_t c = 0; c < 3; ++c)
            layer.scale = std::max(layer.scale, std::abs(static_cast<double>(x[c])));
    layer.transfer = Transfer::linear;
    for (std::size_t i = 0; i < values.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            const double share = static_cast<double>(values[i][c]) / layer.scale;
            layer.texels[3 * i + static_cast<std::size_t>(c)] =
                static_cast<std::byte>(static_cast<unsigned>(128.5 + 127.0 * share));
        }
}

} // namespace tessera::corpus
