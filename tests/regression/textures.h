// The textures that regression and ablation measure. They are held in memory.
#pragma once

#include "corpus/bake.h"

#include <string>
#include <vector>

namespace tessera {

struct Texture {
    std::string name;
    TextureDesc desc;
    std::vector<std::byte> texels;
};

// Bakes a scene into memory, so that it is baked only once for all rows.
inline Result<Texture> bake(const std::string& scene, const Extent4& size) {
    auto baked = corpus::make_baked_source(scene, size, 16, 1);
    if (!baked)
        return baked.status();
    const TextureDesc desc = (*baked)->desc();
    const Box4 box = Box4::whole(size);
    std::vector<std::byte> texels(desc.box_bytes(box));
    TESSERA_TRY((*baked)->read(box, texels));
    return Texture{scene + "_" + to_string(size), desc, std::move(texels)};
}

} // namespace tessera
