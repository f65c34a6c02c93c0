// Fits the layers of a mesh to photographs: each pixel is a weighted sum of texels, so that the
// texels which explain all photographs best are the solution of a least-squares problem.
//
// What an observer sees is the sum of three fields: the colour of each place, the change by the
// mirrored direction that all places share, and the change of groups of places. Directions that no
// photograph shows at a place come from its neighbours and from what all places share.
#pragma once

#include "corpus/fit/photo_solver.h"
#include "corpus/layers/model_layers.h"

namespace tessera::corpus {

struct PhotoFitOptions : PhotoSolveOptions {
    double density = 0;                   // texels per world unit; 0: as fine as the nearest pixels
    double most_texels = 1'000'000;       // of colour
    std::uint32_t cell = 8;               // texels along a side of a group of places
    std::uint32_t directions = 16;        // along s and t, of groups
    std::uint32_t shared_directions = 64; // of all places
    bool masks_unseen = false;            // any value will do for texels that no photograph shows
    unsigned position_bits = 12, normal_bits = 8;
};

struct PhotoFit : PhotoFindings {
    ModelLayers layers;
};

// `model` is in the frame of the cameras. The result depends only on the arguments, not on the number
// of threads. Errors: those of make_model_atlas() and solve_photographs();
// bad_argument (an option out of its range; no photograph).
Result<PhotoFit> fit_photographs(const Model& model, std::span<const PosedPhotograph> photographs,
                                 const PhotoFitOptions& options);

} // namespace tessera::corpus
