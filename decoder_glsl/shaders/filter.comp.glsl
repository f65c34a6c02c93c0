// Pass 6, only of files with a filter, one invocation a texel: filters the values that pass 5 kept
// (FORMAT.md 4.7) and writes the texels they give. A damaged tile has kept none and is written already.
#include "target.glsl"

// Neighbour i of ring 0 to 2: steps along u, v, s, t.
ivec4 tsr_filter_step(int ring, int i) {
    int first = (i & 1) * 2 - 1;
    int second = (i & 2) - 1;
    if (ring < 2)
        return ivec4(first, second, 0, 0) * (ring + 1);
    return i < 2 ? ivec4(0, 0, first, 0) : ivec4(0, 0, 0, first);
}

// The share of a difference of one plane; `ring`: slope | strength << 16.
int tsr_filter_share(TsrFormat format, int difference, uint ring) {
    int strength = int(ring << 8u) >> 24;
    uint known = min(uint(abs(difference)), format.half_floats ? 65535u : 4095u);
    int left = max(abs(strength) - int((known * (ring & 0xFFFFu)) >> 12u), 0);
    return strength < 0 ? -left : left;
}

ivec4 tsr_filtered(TsrFormat format, TsrTarget target, int u, int v, int s, int t) {
    ivec4 x = tsr_value(format, target, u, v, s, t);
    ivec4 sum = ivec4(128);
    for (int tap = 0; tap < tsr_filter_taps; ++tap) {
        TSR_LOOP;
        int ring = tap >> 2;
        ivec4 go = tsr_filter_step(ring, tap & 3);
        ivec4 d = tsr_value(format, target, u + go.x, v + go.y,
                            clamp(s + go.z, 0, target.sides.z - 1),
                            clamp(t + go.w, 0, target.sides.w - 1)) -
                  x;
        int at = tsr_t_filter + ring;
        sum += d * ivec4(tsr_filter_share(format, d.x, tsr_table(at)),
                         tsr_filter_share(format, d.y, tsr_table(at + 3)),
                         tsr_filter_share(format, d.z, tsr_table(at + 6)),
                         tsr_filter_share(format, d.w, tsr_table(at + 9)));
    }
    return x + (sum >> 8);
}

void tsr_filter_texel(uint tile, uint texel) {
    if (tile >= tsr_header(tsr_b_tiles))
        return;
    TsrTarget target = tsr_target(tile);
    ivec4 n = max(target.sides, 1);
    if (target.values == tsr_none || texel >= uint(n.x * n.y) * uint(n.z * n.w))
        return;
    int left = int(texel);
    int u = left % n.x;
    left /= n.x;
    int v = left % n.y;
    left /= n.y;
    int s = left % n.z;
    int t = left / n.z;
    TsrFormat format = tsr_format();
    ivec4 codes = tsr_codes(format, tsr_filtered(format, target, u, v, s, t));
    tsr_write_texel(ivec3(tsr_place(target, u, v) + uvec3(uint(s), uint(t), 0u)),
                    tsr_samples(format, tsr_corrected(format, target, codes, u, v, s, t)));
}

#ifndef __cplusplus
layout(local_size_x = 64) in;
void main() {
    tsr_filter_texel(gl_WorkGroupID.y, gl_GlobalInvocationID.x);
}
#endif
