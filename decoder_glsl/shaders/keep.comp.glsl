// Copies the split trees and block records of a batch to where sampling finds them, the records'
// coefficients counted from the start of their buffer. A group a tile.
//
// A job is two words: the words of the tile's first node and first record in the directory.
#include "buffers.glsl"
layout(std430, binding = 6) writeonly buffer TesseraDirectory { uint tsr_directory[]; };
layout(std430, binding = 5) readonly buffer TesseraKeepJobs { uint tsr_jobs[]; };

void tsr_keep(uint at, uint value) {
    if (at < uint(tsr_directory.length()))
        tsr_directory[at] = value;
}

layout(local_size_x = 64) in;
void main() {
    uint tile = gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationIndex;
    if (tile >= tsr_header(tsr_b_tiles) || tile * 2u + 1u >= uint(tsr_jobs.length()))
        return;
    uint nodes = tsr_jobs[tile * 2u];
    uint records = tsr_jobs[tile * 2u + 1u];
    uint state = tsr_state_at(tile);
    // A damaged tile is one block of nothing.
    if (tsr_work_word(state + uint(tsr_st_damaged)) != 0u) {
        if (lane == 0u) {
            tsr_keep(nodes, 0x80000000u);
            tsr_keep(records, 0u);
            tsr_keep(records + 1u, 0u);
            tsr_keep(records + 2u, 0u);
            tsr_keep(records + 3u, 0u);
        }
        return;
    }
    uint node_count = min(tsr_work_word(state + uint(tsr_st_nodes)), uint(tsr_max_nodes));
    for (uint i = lane; i < node_count; i += 64u)
        tsr_keep(nodes + i, tsr_work_word(tsr_node_at(tile, i)));
    uint blocks = min(tsr_work_word(state + uint(tsr_st_blocks)), uint(tsr_max_blocks));
    for (uint i = lane; i < blocks; i += 64u) {
        uint block = tsr_block_at(tile, i);
        uint rest = tsr_work_word(block + uint(tsr_k_rest));
        uint segment = tsr_tile(tile, tsr_tile_segment) + (rest >> 24);
        uint record = records + i * uint(tsr_block_words);
        tsr_keep(record, tsr_work_word(block + uint(tsr_k_place)));
        tsr_keep(record + uint(tsr_k_first),
                 tsr_segment(segment, tsr_seg_sorted) + tsr_work_word(block + uint(tsr_k_first)));
        tsr_keep(record + uint(tsr_k_counts), tsr_work_word(block + uint(tsr_k_counts)));
        tsr_keep(record + uint(tsr_k_rest), rest);
    }
}
