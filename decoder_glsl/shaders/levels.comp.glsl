// Pass 2, one invocation a segment: the levels of its blocks (FORMAT.md 3.4).
//
// Every round of the one loop decodes either the head of a plane or one coefficient, which is how the
// format counts the work of a segment; so the rounds are bounded and threads of a group stay in step.
//
// Amplitudes are remembered by their codes, four bits a coefficient in scan order. A coefficient gathers
// its context from the places of its earlier neighbours, which the scan's table lists.
#include "rans.glsl"

// Threads of a group. Tiles are few and their streams long: small groups spread over more processors
// and wait less for each other's branches. Four of them take the 16 KiB of shared memory that every
// device has.
#ifndef TSR_LEVELS_GROUP
#define TSR_LEVELS_GROUP 4
#endif
const int tsr_levels_group = TSR_LEVELS_GROUP;
const int tsr_memory_words = 512; // four bits for each of 4,096 coefficients

#ifndef __cplusplus
// Of this plane, and of the sums over the earlier planes of the block.
shared uint tsr_own[tsr_levels_group * tsr_memory_words];
shared uint tsr_cross[tsr_levels_group * tsr_memory_words];
#endif

// Word-major, so that threads at the same place of their scans do not share a bank.
int tsr_memory(uint lane, uint word) {
    return int((word & 511u) * uint(tsr_levels_group) + lane);
}
// Codes 0, 1, 2, 3, 4, 5, ... 15 stand for the amplitudes 0, 1, 2, 3, 4, 6, ... 192.
uint tsr_amplitude_of(uint code) {
    return code < 2u ? code : (2u + (code & 1u)) << ((code >> 1) - 1u);
}
uint tsr_amplitude_code(uint amplitude) {
    if (amplitude < 2u)
        return amplitude;
    if (amplitude > 191u)
        return 15u;
    // Binary digits; not by a loop, whose rounds would count as the segment's work.
    uint digits = 2u + (amplitude > 3u ? 1u : 0u) + (amplitude > 7u ? 1u : 0u) +
                  (amplitude > 15u ? 1u : 0u) + (amplitude > 31u ? 1u : 0u) +
                  (amplitude > 63u ? 1u : 0u) + (amplitude > 127u ? 1u : 0u);
    return 2u * (digits - 1u) + ((amplitude >> (digits - 2u)) & 1u);
}
uint tsr_seen(uint lane, uint index) {
    return tsr_amplitude_of((tsr_own[tsr_memory(lane, index >> 3)] >> ((index & 7u) * 4u)) & 15u);
}
uint tsr_seen_two(uint lane, uint pair) {
    return tsr_seen(lane, pair & 0xFFFFu) + tsr_seen(lane, pair >> 16);
}

struct TsrSegmentWalk {
    TsrRans r;
    uint lane;
    uint tile;
    uint segment_of_tile;
    uint raw;   // its first raw level
    uint room;  // raw levels
    uint count; // raw levels so far
    // The block.
    uint block;
    uint shape;
    uint scan; // word of its scan table
    int coded; // length of its scan
    bool copies;
    int colour;
    uint first; // raw levels before it
    uint counts;
    uint largest_s;
    uint largest_t;
    // The plane.
    int plane;
    int size;
    int at; // coefficients decoded
    int state; // of the quantisers
    int first_token;
    uint own;   // the word being filled
    uint cross; // and that of the earlier planes
    uint cross_words;
    // Of the segment's blocks so far.
    int last_rotation;
    bool last_rotated;
    bool damaged;
};

void tsr_begin_block(TSR_INOUT(TsrSegmentWalk) w) {
    w.plane = 0;
    w.colour = 0;
    w.first = w.count;
    w.counts = 0u;
    w.largest_s = 0u;
    w.largest_t = 0u;
    w.cross_words = 0u;
    w.shape = tsr_work_word(tsr_block_at(w.tile, w.block) + uint(tsr_k_shape));
    w.scan = tsr_shape(w.shape, tsr_s_scan);
    w.coded = int(tsr_shape(w.shape, tsr_s_coded));
}

void tsr_end_block(TSR_INOUT(TsrSegmentWalk) w) {
    uint at = tsr_block_at(w.tile, w.block);
    tsr_set_work(at + uint(tsr_k_first), w.first);
    tsr_set_work(at + uint(tsr_k_counts), w.counts);
    tsr_set_work(at + uint(tsr_k_rest), uint(w.colour) | (w.largest_s << 8) | (w.largest_t << 16) |
                                            (w.segment_of_tile << 24));
    w.block += 1u;
}

void tsr_block_colour(TSR_INOUT(TsrSegmentWalk) w) {
    int kind = tsr_symbol3(w.r, uint(tsr_t_kind) + (w.last_rotated ? 1u : 0u));
    if (kind == 1)
        w.colour = w.last_rotation;
    if (kind == 2)
        w.colour = 1 + int(tsr_raw(w.r, 6));
    w.damaged = w.damaged || w.colour > 49;
    w.last_rotated = w.colour != 0;
    if (w.last_rotated)
        w.last_rotation = w.colour;
}

// The length of a plane, and behind plane 0's the colour of the block.
void tsr_plane_head(TSR_INOUT(TsrSegmentWalk) w) {
    uint table = uint(tsr_t_other_length + w.first_token * tsr_symbol_words);
    if (w.plane == 0) {
        w.copies = (tsr_copy(w.tile, w.block) & 3u) != 0u;
        table = uint(w.copies ? tsr_t_copying_length : tsr_t_first_length) +
                tsr_shape(w.shape, tsr_s_size_class) * uint(tsr_symbol_words);
    }
    int token = tsr_symbol(w.r, table);
    int bits = token <= 1 ? 0 : (token == 2 ? 1 : 2);
    int raw = int(tsr_raw(w.r, bits));
    int length = token == 0 ? 0 : 1 << (token - 1);
    length += raw << max(0, token - 1 - bits);
    w.size = min(length, w.coded);
    w.at = 0;
    w.state = 0;
    if (w.plane == 0) {
        w.first_token = token;
        if (w.size > 0 && tsr_table(tsr_t_rotates) != 0u)
            tsr_block_colour(w);
    }
}

void tsr_keep_level(TSR_INOUT(TsrSegmentWalk) w, uint frequency, uint magnitude, uint negative) {
    if (w.count < w.room) {
        uint at = tsr_header(tsr_b_raw_at) + (w.raw + w.count) * 2u;
        tsr_set_work(at, (frequency << 12) | w.block);
        tsr_set_work(at + 1u, magnitude | (negative << 20) | (uint(w.plane) << 30));
        w.count += 1u;
    } else
        w.damaged = true;
    w.counts += w.plane < 3 ? 1u : 0x10000u;
    w.largest_s = max(w.largest_s, (frequency >> 10) & 31u);
    w.largest_t = max(w.largest_t, frequency >> 15);
}

// Of the eight states, by the parity of the magnitude; four bits each.
int tsr_next_state(int state, uint magnitude) {
    uint next = (magnitude & 1u) == 0u ? 0x73426150u : 0x51604372u;
    return int((next >> uint(4 * state)) & 7u);
}

// Index of the magnitude's table (see magnitude_table in format/tile/code_tables.h).
int tsr_magnitude_table(TsrSegmentWalk w, int quantiser, int neighbours, int cross) {
    bool dc = w.at == 0;
    int first = ((w.copies ? 2 : 0) + quantiser) * 66;
    if (w.plane == 0)
        return first + (dc ? 16 : 0) + neighbours;
    return first + 25 + (dc ? 32 + neighbours : (neighbours >> 1) * 4 + max(cross - 2, 0));
}

void tsr_coefficient(TSR_INOUT(TsrSegmentWalk) w) {
    uint word = uint(w.at) >> 3;
    uint shift = (uint(w.at) & 7u) * 4u;
    if (shift == 0u) {
        w.own = 0u;
        w.cross = word < w.cross_words ? tsr_cross[tsr_memory(w.lane, word)] : 0u;
        tsr_own[tsr_memory(w.lane, word)] = 0u;
    }
    uint entry = w.scan + uint(w.at * tsr_scan_words);
    uint context = tsr_table(entry + 7u);
    uint cross = (w.cross >> shift) & 15u;
    int cross_class = min(int(cross + 1u) >> 1, 5);
    int neighbours = int(tsr_shape(w.shape, tsr_s_size_class));
    if (w.at > 0) {
        uint sum = 2u * (tsr_seen_two(w.lane, tsr_table(entry + 1u)) +
                         tsr_seen_two(w.lane, tsr_table(entry + 2u))) +
                   tsr_seen_two(w.lane, tsr_table(entry + 3u)) +
                   tsr_seen_two(w.lane, tsr_table(entry + 4u)) +
                   tsr_seen_two(w.lane, tsr_table(entry + 5u)) +
                   tsr_seen_two(w.lane, tsr_table(entry + 6u));
        neighbours = int(tsr_amplitude_code((sum * (context & 0xFFFFu)) >> 9));
    }
    bool dependent = tsr_table(tsr_t_dependent) != 0u;
    int quantiser = w.state & 1;
    int row = ((w.copies ? 2 : 0) + quantiser) * 7 + (w.plane == 0 ? 0 : 1 + cross_class);
    int zero = tsr_t_zero + (row * 6 + int(context >> 16)) * 16 + neighbours;
    uint magnitude = 0u;
    if (tsr_bit(w.r, tsr_table(zero))) {
        int table = tsr_magnitude_table(w, quantiser, neighbours, cross_class);
        int token = tsr_symbol(w.r, uint(tsr_t_magnitude + table * tsr_symbol_words));
        magnitude = tsr_magnitude(w.r, token);
        uint negative = tsr_raw(w.r, 1);
        uint level = dependent ? 2u * magnitude - uint(quantiser) : magnitude;
        w.damaged = w.damaged || level > 0xFFFFFu;
        uint code = tsr_amplitude_code(dependent ? level : 2u * level);
        uint both = tsr_amplitude_code(tsr_amplitude_of(cross) + tsr_amplitude_of(code));
        w.own |= code << shift;
        w.cross = (w.cross & ~(15u << shift)) | (both << shift);
        tsr_own[tsr_memory(w.lane, word)] = w.own;
        tsr_keep_level(w, tsr_table(entry) & 0xFFFFFu, level & 0xFFFFFu, negative);
    }
    if (dependent)
        w.state = tsr_next_state(w.state, magnitude);
    w.at += 1;
    if (shift == 28u || w.at == w.size)
        tsr_cross[tsr_memory(w.lane, word)] = w.cross;
}

void tsr_decode_segment(uint tile, uint segment_of_tile, uint lane) {
    if (tile >= tsr_header(tsr_b_tiles) || segment_of_tile >= tsr_tile(tile, tsr_tile_segments))
        return;
    uint state = tsr_state_at(tile);
    if ((tsr_work_word(state + uint(tsr_st_damaged)) & tsr_damage_tree) != 0u)
        return;
    uint segment = tsr_tile(tile, tsr_tile_segment) + segment_of_tile;
    TsrSegmentWalk w;
    w.r = tsr_begin(tsr_segment(segment, tsr_seg_byte), tsr_segment(segment, tsr_seg_size));
    int rounds = tsr_max_work;
    if (segment_of_tile == 0u) { // go on behind the tree
        uint left = min(tsr_work_word(state + uint(tsr_st_left)), tsr_segment(segment, tsr_seg_size));
        w.r.state = tsr_work_word(state + uint(tsr_st_rans));
        w.r.at = tsr_segment(segment, tsr_seg_byte) +
                 2u * (tsr_segment(segment, tsr_seg_size) - left);
        w.r.left = left;
        rounds -= int(min(tsr_work_word(state + uint(tsr_st_nodes)), uint(tsr_max_nodes)));
    }
    uint blocks = min(tsr_work_word(state + uint(tsr_st_blocks)), uint(tsr_max_blocks));
    uint end = tsr_segment(segment, tsr_seg_end);
    if (end == tsr_none)
        end = blocks;
    w.lane = lane;
    w.tile = tile;
    w.segment_of_tile = segment_of_tile;
    w.raw = tsr_segment(segment, tsr_seg_raw);
    w.room = tsr_segment(segment, tsr_seg_room);
    w.count = 0u;
    w.block = tsr_segment(segment, tsr_seg_first);
    w.last_rotation = 1;
    w.last_rotated = false;
    w.size = 0;
    w.at = 0;
    w.state = 0;
    w.first_token = 0;
    w.own = 0u;
    w.cross = 0u;
    w.damaged = false;
    if (end > blocks || (segment_of_tile > 0u && end <= w.block)) {
        tsr_damage(tile, tsr_damage_segments);
        return;
    }
    int planes = int(tsr_table(tsr_t_planes));
    if (w.block < end)
        tsr_begin_block(w);
    for (int round = 0; round < rounds; ++round) {
        TSR_LOOP;
        if (w.block >= end || w.damaged)
            break;
        if (w.at < w.size)
            tsr_coefficient(w);
        else
            tsr_plane_head(w);
        if (w.at == w.size) { // the plane ends, and with the last one the block
            w.cross_words = max(w.cross_words, uint(w.size + 7) >> 3);
            w.plane += 1;
            w.size = 0;
            w.at = 0;
            if (w.plane == planes) {
                tsr_end_block(w);
                if (w.block < end)
                    tsr_begin_block(w);
            }
        }
    }
    if (w.block < end || w.damaged)
        tsr_damage(tile, tsr_damage_levels);
    else if (!tsr_ended_well(w.r))
        tsr_damage(tile, tsr_damage_end);
    uint levels = state + uint(tsr_st_levels);
    if (levels < uint(tsr_work.length()))
        TSR_ATOMIC_ADD(levels, w.count);
    tsr_set_work(tsr_header(tsr_b_counts_at) + segment, w.count);
}

#ifndef __cplusplus
layout(local_size_x = TSR_LEVELS_GROUP) in;
void main() {
    tsr_decode_segment(gl_GlobalInvocationID.x, gl_WorkGroupID.y, gl_LocalInvocationIndex);
}
#endif
