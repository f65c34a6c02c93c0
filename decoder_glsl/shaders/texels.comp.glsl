// Pass 5, one group of 64 invocations per item: the inverse transform at some positions of a block,
// and its texels (FORMAT.md part 4).
//
// Stage 1: one invocation per position walks all coefficients, along u and v. Stage 2 sums along s.
// Stage 3 sums along t for all planes of a texel, adds what the block copies, and writes the texel.
// All invocations read the same coefficients at the same time. The shared arrays have positions
// innermost.
//
// Batches with predicted tiles and files with a filter need TSR_PREDICTED_TILES. Without it the
// shader takes fewer registers. Pass 6 completes blocks that are predicted from their border. In
// files with a filter, pass 7 writes the texels of sound tiles.
#include "patch.glsl"
#include "target.glsl"
#include "walk.glsl"

#ifndef __cplusplus
shared int tsr_patch_memory[tsr_patch_words];
#endif

struct TsrItem {
    bool real;
    uint tile;
    uint block;
    uint first; // position: u + v * (side along u)
    int positions;
    TsrPatch patch_of;
    uint axes;         // see tsr_k_rest
    ivec4 origin;      // of the block in the tile
    uint copies;       // its copy record, see tsr_copy_words
    uint coefficients; // the first one
    uint colour_count;
    uint alpha_count;
    int later;        // word of the shared memory where the values after pass s begin
    int plane_before; // words from one plane to the next, before pass s and after it
    int plane_after;
    TsrFormat format;
    TsrTarget dest;
};

TsrItem tsr_item(uint number) {
    TsrItem item;
    item.real = number < tsr_work_word(uint(tsr_w_ready));
    uint at = tsr_item_at(number);
    uint owner = item.real ? tsr_work_word(at) : 0u;
    uint range = item.real ? tsr_work_word(at + 1u) : 0u;
    item.tile = owner >> 12;
    item.block = owner & 0xFFFu;
    uint block = tsr_block_at(item.tile, item.block);
    uint counts = tsr_work_word(block + uint(tsr_k_counts));
    uint rest = tsr_work_word(block + uint(tsr_k_rest));
    item.patch_of = tsr_patch(tsr_work_word(block + uint(tsr_k_shape)), rest);
    item.axes = rest & tsr_axes_mask;
    item.first = range & 0xFFFFu;
    item.positions = min(int(range >> 16), item.patch_of.positions);
    item.origin = tsr_origin_of(tsr_work_word(block + uint(tsr_k_place)));
    item.copies = tsr_copy(item.tile, item.block);
    uint segment = tsr_tile(item.tile, tsr_tile_segment) + (rest >> 24);
    item.coefficients =
        tsr_segment(segment, tsr_seg_raw) + tsr_work_word(block + uint(tsr_k_first));
    item.colour_count = min(counts & 0xFFFFu, 3u * uint(tsr_max_coded));
    item.alpha_count = min(counts >> 16, uint(tsr_max_coded));
    item.plane_before = item.patch_of.support_t * item.patch_of.support_s * item.positions;
    item.plane_after = item.patch_of.support_t * item.patch_of.sides.z * item.positions;
    item.later = item.patch_of.planes * item.plane_before;
    item.format = tsr_format();
    item.dest = tsr_target(item.tile);
    return item;
}

// Word of plane 0's value before pass s, [kt][ks][position], and after it, [kt][s][position]. The
// other planes follow at the distances plane_before and plane_after.
int tsr_before_s(TsrItem item, int kt, int ks, int position) {
    return (kt * item.patch_of.support_s + ks) * item.positions + position;
}
int tsr_after_s(TsrItem item, int kt, int s, int position) {
    return item.later + (kt * item.patch_of.sides.z + s) * item.positions + position;
}
int tsr_get(int at) {
    return uint(at) < uint(tsr_patch_words) ? tsr_patch_memory[at] : 0;
}
void tsr_put(int at, int value) {
    if (uint(at) < uint(tsr_patch_words))
        tsr_patch_memory[at] = value;
}
ivec3 tsr_get_planes(TsrItem item, int at, int distance) {
    int planes = item.patch_of.planes;
    return ivec3(tsr_get(at), planes > 1 ? tsr_get(at + distance) : 0,
                 planes > 2 ? tsr_get(at + 2 * distance) : 0);
}
void tsr_put_planes(TsrItem item, int at, int distance, ivec3 value) {
    int planes = item.patch_of.planes;
    tsr_put(at, value.x);
    if (planes > 1)
        tsr_put(at + distance, value.y);
    if (planes > 2)
        tsr_put(at + 2 * distance, value.z);
}

// Stores a column of planes 0 to 2, or of plane 3 alone, for pass s. `key`: its frequency.
void tsr_put_column(TsrItem item, int first_plane, int position, uint key, ivec3 column) {
    int ks = min(int((key >> 10) & 31u), item.patch_of.support_s - 1);
    int kt = min(int(key >> 15), item.patch_of.support_t - 1);
    bool passes = item.patch_of.sides.z > 1 || item.patch_of.sides.w > 1;
    ivec3 value = passes ? tsr_clamped(column) : column;
    int at = tsr_before_s(item, kt, ks, position);
    if (first_plane != 0) {
        tsr_put(at + 3 * item.plane_before, value.x);
        return;
    }
    tsr_put_planes(item, at, item.plane_before, value);
}

void tsr_step(TsrItem item, TSR_INOUT(TsrWalk) w, int first_plane, int position, uint at,
              uint end) {
    if (at >= end)
        return;
    uvec4 coefficient = tsr_coefficient_at(at);
    if ((coefficient.x >> 10) != (w.key >> 10)) {
        uint key = w.key;
        tsr_put_column(item, first_plane, position, key, tsr_end_column(w));
        w.key = coefficient.x;
    }
    tsr_walk_on(w, coefficient);
}

void tsr_walk_run(TsrItem item, int first_plane, int position, uint begin, uint count) {
    if (count == 0u)
        return;
    int place = int(item.first) + position;
    int nu = max(item.patch_of.sides.x, 1);
    TsrWalk w = tsr_start_walk(item.patch_of.sides, item.axes, ivec2(place % nu, place / nu));
    w.key = tsr_coefficient_at(begin).x;
    // Four per round, so that the longest runs stay far below the bound on rounds.
    for (uint i = 0u; i < count; i += 4u) {
        TSR_LOOP;
        uint at = begin + i;
        tsr_step(item, w, first_plane, position, at, begin + count);
        tsr_step(item, w, first_plane, position, at + 1u, begin + count);
        tsr_step(item, w, first_plane, position, at + 2u, begin + count);
        tsr_step(item, w, first_plane, position, at + 3u, begin + count);
    }
    uint key = w.key;
    tsr_put_column(item, first_plane, position, key, tsr_end_column(w));
}

// Stage 0. Columns without coefficients stay 0.
void tsr_clear_patch(TsrItem item, int lane) {
    if (!item.real)
        return;
    for (int i = lane; i < item.later; i += TSR_TEXEL_GROUP) {
        TSR_LOOP;
        tsr_put(i, 0);
    }
}

// Stage 1.
void tsr_sum_u_v(TsrItem item, int lane) {
    if (!item.real || lane >= item.positions)
        return;
    tsr_walk_run(item, 0, lane, item.coefficients, item.colour_count);
    tsr_walk_run(item, 3, lane, item.coefficients + item.colour_count, item.alpha_count);
}

// An invocation's part of the stages after the walk: at one position, every `step`-th row from
// `first` on. A row is one (s, kt) in stage 2 and one s in stage 3.
struct TsrShare {
    int position;
    int first;
    int step;
};

TsrShare tsr_share(TsrItem item, int lane) {
    TsrShare share;
    int positions = clamp(item.positions, 1, TSR_TEXEL_GROUP);
    share.step = TSR_TEXEL_GROUP / positions;
    share.first = lane / positions;
    share.position = lane - share.first * positions;
    if (!item.real || item.positions < 1)
        share.first = 65536;
    if (share.first >= share.step)
        share.first = 65536; // beyond every row
    return share;
}

// Planes 0 to 2, and plane 3 in alpha.x.
struct TsrValues {
    ivec3 colour;
    ivec3 alpha;
};

// A pass along an axis of n texels, for its texel x: sums the first `support` frequencies.
// Frequency 0 is at word `first`, the next one `step` words further on, and the next plane `plane`
// words further on.
TsrValues tsr_sum_along(TsrItem item, int n, int x, int support, int first, int step, int plane) {
    bool has_alpha = item.patch_of.planes > 3;
    TsrValues values;
    values.colour = tsr_get_planes(item, first, plane);
    values.alpha = ivec3(has_alpha ? tsr_get(first + 3 * plane) : 0, 0, 0);
    // The basis of frequency 0 is 1, so its sum alone is the value itself.
    if (support < 2)
        return values;
    int basis = tsr_basis_of(n) + x;
    TsrSum colour = tsr_no_sum();
    TsrSum alpha = tsr_no_sum();
    for (int k = 0; k < support; ++k) {
        TSR_LOOP;
        uint b = tsr_table(basis + k * n);
        int at = first + k * step;
        tsr_add_clamped(colour, b, tsr_get_planes(item, at, plane));
        if (has_alpha)
            tsr_add_clamped(alpha, b, ivec3(tsr_get(at + 3 * plane), 0, 0));
    }
    values.colour = tsr_rounded(colour);
    values.alpha = tsr_rounded(alpha);
    return values;
}

// Stage 2 for one position, s and kt.
void tsr_sum_s_at(TsrItem item, int kt, int s, int position) {
    TsrValues values =
        tsr_sum_along(item, item.patch_of.sides.z, s, item.patch_of.support_s,
                      tsr_before_s(item, kt, 0, position), item.positions, item.plane_before);
    if (item.patch_of.sides.w > 1) {
        values.colour = tsr_clamped(values.colour);
        values.alpha = tsr_clamped(values.alpha);
    }
    int to = tsr_after_s(item, kt, s, position);
    tsr_put_planes(item, to, item.plane_after, values.colour);
    if (item.patch_of.planes > 3)
        tsr_put(to + 3 * item.plane_after, values.alpha.x);
}

void tsr_sum_s(TsrItem item, int lane) {
    TsrShare share = tsr_share(item, lane);
    int ns = max(item.patch_of.sides.z, 1);
    int rows = ns * item.patch_of.support_t;
    for (int row = share.first; row < rows; row += share.step) {
        TSR_LOOP;
        int kt = row / ns;
        tsr_sum_s_at(item, kt, row - kt * ns, share.position);
    }
}

// The values `steps` displacements away from (u, v) in the view (s, t), times 4, or times 16 for
// smooth copies (C of FORMAT.md 4.6). `record`: a copy record. The first taps are the texels that the
// position lies on or between, the others are those beside them.
ivec4 tsr_moved(TsrItem item, uint record, int steps, int u, int v, int s, int t) {
    int x = 2 * u + steps * (int(record << 8u) >> 24);
    int y = 2 * v + steps * (int(record) >> 24);
    int f = x & 1;
    int g = y & 1;
    int halves = f + g;
    int between = 1 << halves;
    int taps = item.format.smooth_copies && halves < 2 ? 5 + halves : between;
    int weight = item.format.smooth_copies ? 8 - 2 * halves : 4 >> halves;
    ivec4 sum = ivec4(0);
    for (int k = 0; k < taps; ++k) {
        TSR_LOOP;
        int a = k & f;
        int b = k >> f;
        if (k >= between) {
            int m = k - between;
            int side = (m & 2) - 1;
            int along = (m & 1) * halves; // which of the two texels that the position lies between
            bool vertical = halves == 0 ? (m & 1) != 0 : f != 0;
            a = vertical ? along : side;
            b = vertical ? side : along;
        }
        sum += (k < between ? weight : 2 - halves) *
               tsr_value(item.format, item.dest, (x >> 1) + a, (y >> 1) + b, s, t);
    }
    return sum;
}

// The values that a texel of the tile copies from the base picture (FORMAT.md 4.6).
ivec4 tsr_from_base(TsrItem item, int u, int v, int s, int t) {
    int x = (s - (item.dest.sides.z - 1) / 2) * (int(item.copies << 8u) >> 24);
    int y = (t - (item.dest.sides.w - 1) / 2) * (int(item.copies) >> 24);
    int margin = int(tsr_table(tsr_t_base_margin));
    int i = u + margin + (x >> 3) - 2;
    int j = v + margin + (y >> 3) - 2;
    int along_u = tsr_t_base_filter + (x & 7) * tsr_base_taps;
    int along_v = tsr_t_base_filter + (y & 7) * tsr_base_taps;
    ivec4 sum = ivec4(512);
    for (int b = 0; b < tsr_base_taps; ++b) {
        TSR_LOOP;
        ivec4 row = ivec4(2);
        for (int a = 0; a < tsr_base_taps; ++a)
            row += int(tsr_table(along_u + a)) *
                   tsr_value_in(item.format, item.dest,
                                tsr_base_value_at(item.dest, i + a, j + b));
        sum += int(tsr_table(along_v + b)) * (row >> 2);
    }
    return sum >> 10;
}

// Adds what a texel of a predicted tile copies, clamps the sum, keeps it for other blocks, and
// returns it. border.comp adds predictions from the border later. It gets sums of up to twice the
// range of values, because a prediction itself lies within that range.
ivec4 tsr_predicted(TsrItem item, ivec4 values, int u, int v, int s, int t) {
    ivec4 copied = ivec4(0);
    bool of_base = (item.copies & tsr_copy_of_base) != 0u;
    if ((item.copies & 3u) == 3u) {
        copied = tsr_from_base(item, u, v, s, t);
    } else if ((item.copies & 3u) != 0u) {
        bool along_s = (item.copies & 3u) == 1u;
        int steps = along_s ? s - item.origin.z + 1 : t - item.origin.w + 1;
        int from_s = along_s ? max(item.origin.z - 1, 0) : s;
        int from_t = along_s ? t : max(item.origin.w - 1, 0);
        int shift = item.format.smooth_copies ? 4 : 2;
        ivec4 sum = tsr_moved(item, item.copies, steps, u, v, from_s, from_t);
        copied = (sum + (1 << (shift - 1))) >> shift;
    }
    int limit = tsr_value_limit(item.format);
    if ((item.copies & tsr_copy_of_border) != 0u)
        limit *= 2;
    ivec4 value = clamp(values + copied, -limit, limit - 1);
    tsr_keep_value(item.format, item.dest, value,
                   of_base ? tsr_base_value_at(item.dest, u, v)
                           : tsr_value_at(item.dest, u, v, s, t));
    return value;
}

// Stage 3 for one position, s and t: the values of all planes.
ivec4 tsr_sum_t_at(TsrItem item, int s, int t, int position) {
    TsrValues values =
        tsr_sum_along(item, item.patch_of.sides.w, t, item.patch_of.support_t,
                      tsr_after_s(item, 0, s, position), item.patch_of.sides.z * item.positions,
                      item.plane_after);
    return tsr_values(item.format, ivec4(values.colour.x, values.colour.y, values.colour.z,
                                         values.alpha.x));
}

void tsr_sum_t(TsrItem item, int lane) {
    TsrShare share = tsr_share(item, lane);
    int nu = max(item.patch_of.sides.x, 1);
    int place = int(item.first) + share.position;
    int row_v = place / nu;
    int u = item.origin.x + place - row_v * nu;
    int v = item.origin.y + row_v;
    uvec3 pixel = tsr_place(item.dest, u, v);
    for (int s = share.first; s < item.patch_of.sides.z; s += share.step) {
        ivec4 values = ivec4(0);
        ivec4 codes = ivec4(0);
        for (int t = 0; t < item.patch_of.sides.w; ++t) {
            TSR_LOOP;
            int in_s = item.origin.z + s;
            int in_t = item.origin.w + t;
            // Without frequencies along t, all texels of the row have the same values.
            bool changes = t == 0 || item.patch_of.support_t > 1;
            if (changes)
                values = tsr_sum_t_at(item, s, t, share.position);
#ifdef TSR_PREDICTED_TILES
            if (item.dest.values != tsr_none) {
                ivec4 value = tsr_predicted(item, values, u, v, in_s, in_t);
                if (item.format.filtered ||
                    (item.copies &
                     (tsr_copy_of_base | tsr_copy_of_border | tsr_copy_one_plane)) != 0u)
                    continue; // a later pass writes the texel, or it is not shown
                codes = tsr_codes(item.format, value);
            } else
#endif
            if (item.dest.stored != tsr_none)
                codes = tsr_stored(item.format, item.dest, u, v, in_s, in_t);
            else if (changes)
                codes = tsr_codes(item.format, values);
            ivec4 corrected = tsr_corrected(item.format, item.dest, codes, u, v, in_s, in_t);
            tsr_write_texel(ivec3(pixel + uvec3(uint(in_s), uint(in_t), 0u)),
                            tsr_samples(item.format, corrected));
        }
    }
}

#ifndef __cplusplus
layout(local_size_x = TSR_TEXEL_GROUP) in;
void main() {
    TsrItem item = tsr_item(gl_WorkGroupID.y * uint(tsr_row_groups) + gl_WorkGroupID.x);
    int lane = int(gl_LocalInvocationIndex);
    tsr_clear_patch(item, lane);
    barrier();
    tsr_sum_u_v(item, lane);
    barrier();
    tsr_sum_s(item, lane);
    barrier();
    tsr_sum_t(item, lane);
}
#endif
