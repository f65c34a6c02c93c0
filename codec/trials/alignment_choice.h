// Chooses how far views are moved in the grid of tiles, so that most of what they show stands
// still.
#pragma once

#include "codec/pass/encode_plan.h"

namespace tessera {

struct ViewMotion {
    ViewAlignment alignment = {};
    // What the views show moves along v from one s to the next, and along u from one t to the next.
    bool looks_transposed = false;
    BasePictures parallax = {}; // as EncodePlan::parallax
};

// Measures motion between neighbouring views in some patches of the texture. There is no alignment
// for surfaces, with layers, at quick efforts, for pictures larger than half of slab_bytes (they
// would have to be held), and where views move nearly as much with it. Errors: those of the source.
Result<ViewMotion> motion_between_views(const EncodePlan& plan);

// Whether the texture, or parts of it, costs less with the alignment, at a quick effort. `source`
// has the plan's texels in any order.
Result<bool> alignment_pays(const EncodePlan& plan, TexelSource& source, const ViewMotion& motion);

} // namespace tessera
