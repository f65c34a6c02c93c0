// The textures that regression and ablation measure. They are held in memory.
#pragma once

#include "corpus/bake.h"

#include <fstream>
#include <string>
#include <vector>

namespace tessera {

struct Texture {
    std::string name;
    TextureDesc desc;
    std::vector<std::byte> texels;
};

// Loads composed_128x64x32x32.rgb, the texture of the comparisons with other codecs.
inline Result<Texture> load_peers(const char* path) {
    TextureDesc desc{{128, 64, 32, 32}, SampleType::unorm8, 3};
    std::vector<std::byte> texels(desc.box_bytes(Box4::whole(desc.size)));
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(texels.data()),
                   static_cast<std::streamsize>(texels.size())))
        return Status(ErrorCode::io, std::string(path) + ": cannot read 25165824 bytes");
    return Texture{"peers_composed_128x64x32x32", desc, std::move(texels)};
}

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
