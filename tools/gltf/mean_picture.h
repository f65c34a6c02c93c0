// The picture of a mesh's atlas that viewers show which do not know Tessera's textures.
#pragma once

#include "format/samples.h"
#include "format/surface_mesh.h"
#include "tools/view/view_renderer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

struct MeanPicture {
    std::uint32_t width = 0, height = 0; // pixels
    std::vector<std::byte> pixels;       // RGB, or with alpha RGBA, rows from small v to large v
    bool has_alpha = false; // somewhere a layer of coverage says that there is no surface

    std::uint8_t channels() const { return has_alpha ? 4 : 3; }
};

// Each pixel is the mean of the values that leave its place of the surface
// (ViewRenderer::mean_values()). Pixels where there is no surface continue the colours around them,
// so that filters and mips do not bring in others. `type` is that of the renderer's views. `size`:
// pixels along u and v. Does not depend on options.threads. Errors: those of mean_values(); runtime
// (interrupted).
Result<MeanPicture> draw_mean_picture(ViewRenderer& renderer, const SurfaceMesh& mesh,
                                      SampleType type, const std::array<std::uint32_t, 2>& size,
                                      const RenderOptions& options);

} // namespace tessera
