// Pass 7, for files with a filter only, one invocation per texel: filters the values that passes 5
// and 6 kept (FORMAT.md 4.7) and writes the texels. Pass 5 has written damaged tiles, which keep no
// values.
#include "target.glsl"

// A ring of the filter, plane by plane: its strength in 1/256, and how fast it falls with the
// difference.
struct TsrRing {
    ivec4 strength;
    uvec4 slope;
};
TsrRing tsr_ring(int ring) {
    int at = tsr_t_filter + ring;
    uvec4 words = uvec4(tsr_table(at), tsr_table(at + 3), tsr_table(at + 6), tsr_table(at + 9));
    TsrRing r;
    r.strength = ivec4(words << 8u) >> 24;
    r.slope = words & 0xFFFFu;
    return r;
}

// A difference times its weight, for a positive strength.
ivec4 tsr_pull(ivec4 difference, uvec4 most, TsrRing ring) {
    uvec4 known = min(uvec4(abs(difference)), most);
    return difference * max(abs(ring.strength) - ivec4((known * ring.slope) >> 12u), 0);
}

// The change of x, in 1/256, by the four values of a ring, whose words are `at`.
ivec4 tsr_ring_pull(TsrFormat format, TsrTarget dest, ivec4 x, uvec4 at, int which) {
    TsrRing ring = tsr_ring(which);
    uvec4 most = uvec4(tsr_half_values(format) ? 65535u : 4095u);
    ivec4 sum = tsr_pull(tsr_value_in(format, dest, at.x) - x, most, ring) +
                tsr_pull(tsr_value_in(format, dest, at.y) - x, most, ring) +
                tsr_pull(tsr_value_in(format, dest, at.z) - x, most, ring) +
                tsr_pull(tsr_value_in(format, dest, at.w) - x, most, ring);
    return sum * sign(ring.strength);
}

// Words of the four diagonal neighbours of (u, v), or of the edge, in the view that begins at
// `view`.
uvec4 tsr_diagonals(TsrTarget dest, uint view, int u, int v, int distance) {
    int nu = dest.sides.x;
    int left = max(u - distance, 0);
    int right = min(u + distance, nu - 1);
    int above = max(v - distance, 0) * nu;
    int below = min(v + distance, dest.sides.y - 1) * nu;
    return uvec4(view) +
           uvec4(uint(left + above), uint(right + above), uint(left + below), uint(right + below));
}

ivec4 tsr_filtered(TsrFormat format, TsrTarget dest, int u, int v, int s, int t) {
    uint here = tsr_value_at(dest, u, v, s, t);
    uint view = tsr_value_at(dest, 0, 0, s, t);
    uint one = uint(dest.sides.x * dest.sides.y); // words from one view to the next along s
    uint row = one * uint(dest.sides.z);            // and along t
    uvec4 views = uvec4(here) + uvec4(s > 0 ? 0u - one : 0u, s + 1 < dest.sides.z ? one : 0u,
                                      t > 0 ? 0u - row : 0u, t + 1 < dest.sides.w ? row : 0u);
    ivec4 x = tsr_value_in(format, dest, here);
    ivec4 sum = tsr_ring_pull(format, dest, x, tsr_diagonals(dest, view, u, v, 1), 0) +
                tsr_ring_pull(format, dest, x, tsr_diagonals(dest, view, u, v, 2), 1) +
                tsr_ring_pull(format, dest, x, views, 2);
    return x + ((sum + 128) >> 8);
}

void tsr_filter_texel(uint tile, uint texel) {
    if (tile >= tsr_header(tsr_b_tiles))
        return;
    TsrTarget dest = tsr_target(tile);
    ivec4 n = max(dest.sides, 1);
    if (dest.values == tsr_none || texel >= uint(n.x * n.y) * uint(n.z * n.w))
        return;
    int left = int(texel);
    int u = left % n.x;
    left /= n.x;
    int v = left % n.y;
    left /= n.y;
    int s = left % n.z;
    int t = left / n.z;
    TsrFormat format = tsr_format();
    ivec4 codes = tsr_codes(format, tsr_filtered(format, dest, u, v, s, t));
    tsr_write_texel(ivec3(tsr_place(dest, u, v) + uvec3(uint(s), uint(t), 0u)),
                    tsr_samples(format, tsr_corrected(format, dest, codes, u, v, s, t)));
}

#ifndef __cplusplus
layout(local_size_x = TSR_TEXEL_GROUP) in;
void main() {
    tsr_filter_texel(gl_WorkGroupID.y, gl_GlobalInvocationID.x);
}
#endif
