// Pass 4, 64 invocations per tile: divides the blocks into items, each the work of one group of the
// next pass. A damaged tile becomes one block without coefficients, which is drawn as background.
//
// Passes 4 and 5 run once per wave, which is a depth of copies. Wave 0 has the blocks that copy
// nothing. Every block copies from blocks of earlier waves.
#include "buffers.glsl"
#include "patch.glsl"

// `room`: number of items that this invocation may still add. Sound tiles never reach it.
void tsr_cut_block(uint tile, uint block, uint shape, uint rest, TSR_INOUT(uint) room) {
    TsrPatch patch_of = tsr_patch(shape, rest);
    uint positions = uint(patch_of.sides.x * patch_of.sides.y);
    uint size = uint(patch_of.positions);
    uint items = min((positions + size - 1u) / size, room);
    room -= items;
    if (uint(tsr_w_items) >= uint(tsr_work.length()))
        return;
    uint first = TSR_ATOMIC_ADD(uint(tsr_w_items), items);
    for (uint i = 0u; i < items; ++i) {
        TSR_LOOP;
        uint at = tsr_item_at(first + i);
        uint begin = i * size;
        tsr_set_work(at, (tile << 12) | block);
        tsr_set_work(at + 1u, begin | (min(size, positions - begin) << 16));
    }
}

void tsr_cut_tile(uint tile, uint lane) {
    if (tile >= tsr_header(tsr_b_tiles))
        return;
    uint state = tsr_state_at(tile);
    uint wave = tsr_work_word(uint(tsr_w_wave));
    bool predicted = tsr_tile(tile, tsr_tile_copies) != tsr_none;
    uint room = uint(tsr_max_items);
    if (tsr_is_damaged(tile)) {
        if (lane == 0u && wave == 0u) {
            uint at = tsr_block_at(tile, 0u);
            uint shape = tsr_tile(tile, tsr_tile_shape);
            tsr_set_work(at + uint(tsr_k_place), 0u);
            tsr_set_work(at + uint(tsr_k_shape), shape);
            tsr_set_work(at + uint(tsr_k_counts), 0u);
            tsr_set_work(at + uint(tsr_k_rest), 0u);
            tsr_cut_block(tile, 0u, shape, 0u, room);
        }
        return;
    }
    if (wave > 0u && !predicted)
        return;
    uint blocks = min(tsr_work_word(state + uint(tsr_st_blocks)), uint(tsr_max_blocks));
    for (uint block = lane; block < blocks; block += uint(TSR_TEXEL_GROUP)) {
        TSR_LOOP;
        if (predicted && ((tsr_copy(tile, block) >> 8) & 15u) != wave)
            continue;
        uint at = tsr_block_at(tile, block);
        tsr_cut_block(tile, block, tsr_work_word(at + uint(tsr_k_shape)),
                      tsr_work_word(at + uint(tsr_k_rest)), room);
    }
}

#ifndef __cplusplus
layout(local_size_x = TSR_TEXEL_GROUP) in;
void main() {
    tsr_cut_tile(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
#endif
