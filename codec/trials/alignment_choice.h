// How far views are moved in the grid of tiles, so that most of what they show stands still there.
#pragma once

#include "codec/pass/encode_pass.h"
#include "format/levels.h"
#include "format/tile/base_picture.h"

namespace tessera {

struct ViewMotion {
    ViewAlignment alignment;
    // What views show moves along v from one s to the next, and along u from one t to the next.
    bool looks_transposed = false;
    BasePictures parallax; // as EncodePlan has it
};

// By neighbouring views in some patches of the texture. No alignment for surfaces, with layers, at quick efforts,
// for pictures of more than half of slab_bytes, which would have to be held, and where views move about as much
// without it. Errors: those of the source.
Result<ViewMotion> motion_between_views(const EncodePlan& plan);

// Whether parts of the texture code better so, at a quick effort. `source` has the plan's texels in any order.
Result<bool> alignment_pays(const EncodePlan& plan, TexelSource& source, ViewAlignment alignment);

} // namespace tessera
