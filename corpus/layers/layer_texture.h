// The texture of one layer, in memory.
#pragma once

#include "format/layers.h"
#include "format/metadata.h"
#include "format/texture.h"

#include <vector>

namespace tessera::corpus {

struct LayerTexture {
    LayerRole role = LayerRole::diffuse;
    TextureDesc desc;
    std::vector<std::byte> texels;
    TextureDesc mask_desc;       // of the mask: the sides of the texture, or S = T = 1
    std::vector<std::byte> mask; // 0 where any value will do
    double scale = 1.0;          // the light of a sample of 1
    Transfer transfer = Transfer::unspecified;
    Extent4 tile{64, 64, 1, 1};
    double quality_change = 0; // against the usual quality of its role
};

// All texels are 0 and masked. The mask has the size of the texture.
LayerTexture make_layer(LayerRole role, const Extent4& size, std::uint8_t channels);

// Stores a value per channel, 0..1, in a texel, and unmasks it.
void store_values(LayerTexture& layer, std::size_t texel, std::initializer_list<double> values);

// Light before its scale is known: linear, of each texel.
using LightTexels = std::vector<glm::vec3>;

// Stores light as sRGB. The scale is the light that the share `clipped` of all lit texels exceeds,
// but at most `most`.
void store_light(LayerTexture& layer, const LightTexels& light, double most, double clipped = 0.0);
// The same for light that spans a wide range: as sRGB of the root.
void store_wide_light(LayerTexture& layer, const LightTexels& light, double most);

// Stores values around 0, with the largest of them as the scale.
void store_differences(LayerTexture& layer, const LightTexels& values);

} // namespace tessera::corpus
