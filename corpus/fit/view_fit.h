// Fits a texture of four dimensions to photographs, without a mesh: on a sphere around an object, or
// as planar views through a window.
#pragma once

#include "corpus/fit/photo_solver.h"
#include "corpus/fit/view_surfaces.h"
#include "format/texture.h"

namespace tessera::corpus {

struct ViewFitOptions : PhotoSolveOptions {
    double most_texels = 4e6; // of the whole texture
    // Along s and t of a sphere; of the cameras along the longer side of their plane. 0: as many as
    // there are photographs for.
    std::uint32_t directions = 0;
    // Of a sphere: the radius of a sphere inside it which is near the object's surface. 0: chosen by
    // keeping every fifth photograph out of coarse fits.
    double focus = 0;
};

// A texture of unorm8 RGB, as displayed.
struct ViewFit : PhotoFindings {
    TextureDesc desc;
    std::vector<std::byte> texels;
    TextureDesc mask_desc;       // one channel of the texture's size
    std::vector<std::byte> mask; // 1 where a photograph shows the texel, otherwise 0
    double focus = 0;            // of a sphere
};

// Takes about 200 bytes per texel. Errors: those of solve_photographs(); bad_argument (options out of
// their ranges).
Result<ViewFit> fit_sphere(const PhotoSphere& sphere, std::span<const PosedPhotograph> photographs,
                           const ViewFitOptions& options);
Result<ViewFit> fit_window(const SizedWindow& window, std::span<const PosedPhotograph> photographs,
                           const ViewFitOptions& options);

// The distance of the window with which coarse fits predict photographs best that they have not
// seen. Errors: those of window_of() and solve_photographs().
Result<double> choose_focus(std::span<const PosedPhotograph> photographs,
                            const ViewFitOptions& options);

} // namespace tessera::corpus
