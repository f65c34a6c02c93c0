// A built-in scene on its own surfaces: what the encoder needs of it.
#pragma once

#include "corpus/surface/surface_detail.h"
#include "format/metadata.h"
#include "format/texture.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct SurfaceBake {
    std::string scene;
    corpus::SurfaceWish detail;
    std::optional<AngularMap> map; // by trial where it is not given
    unsigned samples = 0;          // per texel
};

struct BakedSurface {
    std::unique_ptr<TexelSource> texels, mask;
    std::vector<std::byte> mesh; // section prxy
    AngularMap map{};
    std::string background; // "r,g,b", where an observer sees none of it
    corpus::SurfaceDetail detail;
    std::size_t triangles = 0, charts = 0;
};

// Errors: bad_argument (no such scene, a density that is not above 0), unsupported (a surface that is too large).
Result<BakedSurface> bake_surface(const SurfaceBake& bake);

// "auto" (nothing), "hemisphere", "mirrored" or the map's own name. Errors: bad_argument.
Result<std::optional<AngularMap>> parse_octahedral_map(const std::string& text);

} // namespace tessera
