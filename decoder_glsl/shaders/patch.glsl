// How a block is cut for the inverse transform: so many of its (u, v) positions that their values
// after the passes u, v and s fit the shared memory of one group.
#ifndef TSR_PATCH
#define TSR_PATCH
#include "buffers.glsl"

const int tsr_patch_words = 8192; // of shared memory, 32 KiB

struct TsrPatch {
    ivec4 sides;   // of the block
    int planes;    // of the texture
    int support_s; // frequencies along s and t that occur
    int support_t;
    int positions; // at most 64
};

TsrPatch tsr_patch(uint shape, uint rest) {
    TsrPatch p;
    p.sides = tsr_sides_of(shape);
    p.planes = clamp(int(tsr_table(tsr_t_planes)), 1, 4);
    p.support_s = min(int((rest >> 8) & 31u) + 1, max(p.sides.z, 1));
    p.support_t = min(int((rest >> 16) & 31u) + 1, max(p.sides.w, 1));
    // Sides along s and t are at most 32, so one position always fits: 4 * 32 * (32 + 32) = 8192.
    int words = p.planes * p.support_t * (p.support_s + max(p.sides.z, 1));
    p.positions = clamp(tsr_patch_words / words, 1, 64);
    // 64 invocations share the positions of later stages evenly, or nearly so.
    if (p.positions > 32 && p.positions < 52)
        p.positions = 32;
    return p;
}

#endif
