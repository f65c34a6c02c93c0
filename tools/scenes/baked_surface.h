// Bakes a built-in scene onto its own surfaces, as input for the encoder.
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

// "r,g,b", the colour of rays that miss all surfaces.
std::string background_fact(const corpus::Scene& scene);

struct SurfaceBake {
    std::string scene;
    corpus::SurfaceWish detail;
    std::optional<AngularMap> map; // absent: chosen by a trial
    unsigned samples = 0;          // rays per texel
};

struct BakedSurface {
    std::unique_ptr<TexelSource> texels, mask;
    std::vector<std::byte> mesh; // section prxy
    AngularMap map{};
    std::string background; // background_fact()
    corpus::SurfaceDetail detail;
    std::size_t triangles = 0, charts = 0;
};

// Errors: bad_argument (no such scene, a density not above 0), unsupported (a surface that is too
// large).
Result<BakedSurface> bake_surface(const SurfaceBake& bake);

// Parses "octahedral-hemisphere" or "octahedral-mirrored"; "auto" gives nothing. Errors:
// bad_argument.
Result<std::optional<AngularMap>> parse_octahedral_map(const std::string& text);

} // namespace tessera
