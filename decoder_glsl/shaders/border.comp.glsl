// Pass 6, for batches with pictures that are predicted from the border of blocks, one group of 64
// invocations per tile: adds the predictions to the values that pass 5 kept (FORMAT.md 4.6), and
// writes the texels of pictures that are tiles. It follows the first wave of passes 4 and 5, because
// later waves copy base pictures.
//
// The blocks of a step need only blocks of earlier steps, and blocks that are not predicted. A group
// goes through all steps of its tile, so a barrier between two steps suffices. The invocations share
// the blocks of a step: all 64 work on a single block, and 16 on each of four or more.
//
// Where each of two planes has a split tree of its own, the blocks of plane 0 have their values where
// those of a base picture would be. When all steps are done, the group joins the planes and writes
// the texels.
#define TSR_COHERENT_WORK
#include "target.glsl"

// All of it comes from buffers that no pass writes, so that every invocation of a group goes through
// the same steps, as WGSL demands where there are barriers.
struct TsrBorder {
    uint record; // word of the first block's record
    uint steps;
    uint ends;   // word of the first step's end
    uint blocks; // of all steps
    bool joins;  // the tile has a border list, and so may have planes to join
};

TsrBorder tsr_border(uint tile) {
    TsrBorder border;
    border.record = 0u;
    border.steps = 0u;
    border.ends = 0u;
    border.blocks = 0u;
    border.joins = false;
    if (tile >= tsr_header(tsr_b_tiles))
        return border;
    uint list = tsr_tile(tile, tsr_tile_borders);
    if (list == tsr_none || tsr_tile(tile, tsr_tile_values) == tsr_none)
        return border;
    uint at = tsr_header(tsr_b_borders_at) + list;
    border.steps = min(tsr_batch_word(at), uint(tsr_max_blocks));
    border.ends = at + 1u;
    border.record = border.ends + border.steps;
    border.joins = true;
    if (border.steps > 0u)
        border.blocks = min(tsr_batch_word(border.record - 1u), uint(tsr_max_blocks));
    return border;
}

// A block and the picture that contains it.
struct TsrPictureBlock {
    TsrFormat format;
    TsrTarget dest;
    bool of_base;
    bool has_all_planes;
    int mode;
    ivec2 origin;
    ivec2 sides;
    int above; // texels of the border that exist
    int left;
    uint first; // word of the picture's first value
    int width;  // of the picture
    ivec2 last; // u and v of its last texel
};

TsrPictureBlock tsr_picture_block(uint tile, uint record) {
    TsrPictureBlock b;
    uint word = tsr_batch_word(record + uint(tsr_border_block));
    uint block = word & 0xFFFu;
    uint texels = tsr_batch_word(record + uint(tsr_border_texels));
    uint at = tsr_block_at(tile, block);
    b.format = tsr_format();
    b.dest = tsr_target(tile);
    uint copy = tsr_copy(tile, block);
    b.of_base = (copy & tsr_copy_of_base) != 0u;
    b.has_all_planes = (copy & tsr_copy_one_plane) == 0u;
    b.mode = int(word >> 12) & 63;
    ivec4 origin = tsr_origin_of(tsr_work_word(at + uint(tsr_k_place)));
    b.origin = ivec2(origin.x, origin.y);
    ivec4 sides = clamp(tsr_sides_of(tsr_work_word(at + uint(tsr_k_shape))), 1, tsr_max_block_side);
    b.sides = ivec2(sides.x, sides.y);
    b.above = int(texels & 255u);
    b.left = int((texels >> 8) & 255u);
    b.first = b.of_base ? tsr_base_value_at(b.dest, 0, 0) : tsr_value_at(b.dest, 0, 0, 0, 0);
    ivec2 all = b.of_base ? b.dest.base_sides : ivec2(b.dest.sides.x, b.dest.sides.y);
    b.width = all.x;
    b.last = all - 1;
    return b;
}

ivec4 tsr_picture_value(TsrPictureBlock b, int u, int v) {
    int x = clamp(u, 0, max(b.last.x, 0));
    int y = clamp(v, 0, max(b.last.y, 0));
    return tsr_value_in(b.format, b.dest, b.first + uint(y * b.width + x));
}

// Compilers copy functions to where they are called, so only two places read the border: the loops of
// tsr_border_mean() and tsr_weighted_border(). Other functions compute which texels they read.
ivec4 tsr_border_value(TsrPictureBlock b, ivec2 place) {
    if (b.above <= 0 && b.left <= 0)
        return ivec4(0);
    return tsr_picture_value(b, place.x, place.y);
}

// The texels T and L of the format. Where one side of the border does not exist, the other takes
// its place.
ivec2 tsr_above(TsrPictureBlock b, int i) {
    if (b.above > 0)
        return b.origin + ivec2(min(i, b.above - 1), -1);
    return b.origin + ivec2(-1, 0);
}
ivec2 tsr_left(TsrPictureBlock b, int i) {
    if (b.left > 0)
        return b.origin + ivec2(-1, min(i, b.left - 1));
    return tsr_above(b, 0);
}

// Texel i of a line of the border, -1 for the corner: the line above, or the one to the left.
ivec2 tsr_border_texel(TsrPictureBlock b, bool above, int i) {
    if (i < 0 && b.above > 0 && b.left > 0)
        return b.origin - 1;
    if (i >= 0 && above)
        return tsr_above(b, i);
    return tsr_left(b, max(i, 0));
}

ivec4 tsr_border_mean(TsrPictureBlock b) {
    int count_above = b.above > 0 ? b.sides.x : 0;
    int count_left = b.left > 0 ? b.sides.y : 0;
    int count = count_above + count_left;
    if (count == 0)
        return ivec4(0);
    ivec4 sum = ivec4(0);
    // Eight per round, so that the blocks of a tile stay far below the bound on rounds.
    for (int begin = 0; begin < count; begin += 8) {
        TSR_LOOP;
        for (int i = begin; i < min(begin + 8, count); ++i) {
            bool above = i < count_above;
            sum += tsr_border_value(b, tsr_border_texel(b, above, above ? i : i - count_above));
        }
    }
    // Values are above -2^19. Unsigned division rounds down.
    int more = 1 << 19;
    return ivec4(uvec4(sum + count * more) / uint(count)) - more;
}

// A texel of the border and its weight in a prediction.
struct TsrBorderTap {
    ivec2 place;
    int weight;
};

// Tap k of four, whose weights are 128 together.
TsrBorderTap tsr_planar_tap(TsrPictureBlock b, int x, int y, int k) {
    bool at_end = (k & 1) != 0; // of a line; otherwise beside the texel
    int across = 64 * (x + 1) / b.sides.x;
    int down = 64 * (y + 1) / b.sides.y;
    if (k < 2)
        return TsrBorderTap(tsr_border_texel(b, at_end, at_end ? b.sides.x : y),
                            at_end ? across : 64 - across);
    return TsrBorderTap(tsr_border_texel(b, !at_end, at_end ? b.sides.y : x),
                        at_end ? down : 64 - down);
}

// Tap k of two, whose weights are 32 together.
TsrBorderTap tsr_directional_tap(TsrPictureBlock b, int direction, int x, int y, int k) {
    uint word = tsr_table(tsr_t_direction + direction);
    int slope = int(word << 16) >> 16;
    int inverse = int(word >> 16);
    bool above = direction >= tsr_directions / 2; // continues the line above
    int along = above ? x : y;
    int away = above ? y : x;
    int moved = (away + 1) * slope;
    int part = moved & 31;
    int n = b.sides.x + b.sides.y;
    int i = along + 1 + (moved >> 5) + k;
    bool other = i < 0;
    int texel = other ? min((-i * inverse + 128) >> 8, n) - 1 : min(i, n) - 1;
    return TsrBorderTap(tsr_border_texel(b, other != above, texel), k == 0 ? 32 - part : part);
}

// The prediction of a block with a mode above 1.
ivec4 tsr_weighted_border(TsrPictureBlock b, int x, int y) {
    bool planar = b.mode == 2;
    ivec4 sum = ivec4(planar ? 64 : 16);
    for (int k = 0; k < (planar ? 4 : 2); ++k) {
        TsrBorderTap tap = TsrBorderTap(ivec2(0), 0);
        if (planar)
            tap = tsr_planar_tap(b, x, y, k);
        else
            tap = tsr_directional_tap(b, min(b.mode - 3, tsr_directions - 1), x, y, k);
        sum += tap.weight * tsr_border_value(b, tap.place);
    }
    return sum >> (planar ? 7 : 5);
}

// `mean`: of the border, for mode 1.
void tsr_predict_texel(TsrPictureBlock b, ivec4 mean, int x, int y) {
    ivec4 predicted = mean;
    if (b.mode > 1)
        predicted = tsr_weighted_border(b, x, y);
    int u = min(b.origin.x + x, b.last.x);
    int v = min(b.origin.y + y, b.last.y);
    uint at = b.first + uint(v * b.width + u);
    int limit = tsr_value_limit(b.format);
    ivec4 value = clamp(tsr_value_in(b.format, b.dest, at) + predicted, -limit, limit - 1);
    tsr_keep_value(b.format, b.dest, value, at);
    if (b.of_base || !b.has_all_planes || b.format.filtered)
        return;
    ivec4 codes = tsr_corrected(b.format, b.dest, tsr_codes(b.format, value), u, v, 0, 0);
    tsr_write_texel(ivec3(tsr_place(b.dest, u, v)), tsr_samples(b.format, codes));
}

void tsr_predict_block(uint tile, uint record, int lane, int lanes) {
    TsrPictureBlock b = tsr_picture_block(tile, record);
    ivec4 mean = ivec4(0);
    if (b.mode == 1)
        mean = tsr_border_mean(b);
    int texels = b.sides.x * b.sides.y;
    for (int i = lane; i < texels; i += lanes) {
        TSR_LOOP;
        int y = i / b.sides.x;
        tsr_predict_texel(b, mean, i - y * b.sides.x, y);
    }
}

// Number of blocks up to the end of a step; at least `begin`, those of earlier steps.
uint tsr_step_end(TsrBorder border, uint number, uint begin) {
    return clamp(tsr_batch_word(border.ends + number), begin, max(border.blocks, begin));
}

void tsr_predict_step(uint tile, TsrBorder border, uint begin, uint end, int lane) {
    if (tsr_is_damaged(tile))
        return;
    uint blocks = end - begin;
    int lanes = blocks > 2u ? TSR_TEXEL_GROUP / 4 : TSR_TEXEL_GROUP / int(max(blocks, 1u));
    uint share = uint(lane / lanes);
    for (uint i = begin + share; i < end; i += uint(TSR_TEXEL_GROUP / lanes)) {
        TSR_LOOP;
        tsr_predict_block(tile, border.record + i * uint(tsr_border_words),
                          lane - int(share) * lanes, lanes);
    }
}

// Joins the planes of a tile in which each has a split tree of its own.
void tsr_join_planes(uint tile, int lane) {
    if (tsr_is_damaged(tile) || (tsr_copy(tile, 0u) & tsr_copy_one_plane) == 0u)
        return;
    TsrFormat format = tsr_format();
    TsrTarget dest = tsr_target(tile);
    int width = max(dest.sides.x, 1);
    int texels = width * dest.sides.y;
    for (int i = lane; i < texels; i += TSR_TEXEL_GROUP) {
        TSR_LOOP;
        int v = i / width;
        int u = i - v * width;
        uint at = tsr_value_at(dest, u, v, 0, 0);
        ivec4 value = tsr_value_in(format, dest, at);
        value.x = tsr_value_in(format, dest, tsr_base_value_at(dest, u, v)).x;
        tsr_keep_value(format, dest, value, at);
        if (!format.filtered)
            tsr_write_texel(ivec3(tsr_place(dest, u, v)),
                            tsr_samples(format, tsr_codes(format, value)));
    }
}

#ifndef __cplusplus
void tsr_end_step() {
#ifdef TSR_TRANSLATED
    controlBarrier(gl_ScopeWorkgroup, gl_ScopeDevice, gl_StorageSemanticsBuffer,
                   gl_SemanticsAcquireRelease);
#else
    memoryBarrierBuffer();
    barrier();
#endif
}

layout(local_size_x = TSR_TEXEL_GROUP) in;
void main() {
    TsrBorder border = tsr_border(gl_WorkGroupID.x);
    uint begin = 0u;
    for (uint i = 0u; i < border.steps; ++i) {
        uint end = tsr_step_end(border, i, begin);
        tsr_predict_step(gl_WorkGroupID.x, border, begin, end, int(gl_LocalInvocationIndex));
        begin = end;
        tsr_end_step();
    }
    if (border.joins)
        tsr_join_planes(gl_WorkGroupID.x, int(gl_LocalInvocationIndex));
}
#endif
