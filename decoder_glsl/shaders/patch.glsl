// How a block is divided into items for the inverse transform.
#ifndef TSR_PATCH
#define TSR_PATCH
#include "buffers.glsl"

struct TsrPatch {
    ivec4 sides;   // of the block
    int planes;    // of the texture
    int support_s; // the lowest frequencies along s, and along t, that hold all coefficients
    int support_t;
    int positions; // (u, v) of an item, at most 64
};

// `rest`: tsr_k_rest of the block.
TsrPatch tsr_patch(uint shape, uint rest) {
    TsrPatch p;
    p.sides = tsr_sides_of(shape);
    p.planes = clamp(int(tsr_table(tsr_t_planes)), 1, 4);
    p.support_s = min(int((rest >> 8) & 31u) + 1, max(p.sides.z, 1));
    p.support_t = min(int((rest >> 16) & 31u) + 1, max(p.sides.w, 1));
    p.positions = tsr_item_positions(p.planes, p.support_s, p.support_t, max(p.sides.z, 1));
    return p;
}

#endif
