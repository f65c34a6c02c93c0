// Pass 2, one invocation per segment: decodes the levels of its blocks (FORMAT.md 3.4).
//
// There is one loop. Each round decodes either the head of a plane or one coefficient, which is
// what the format counts as the work of a segment, or one of the two shares of a block. A block with
// shares has four units of work or more, so rounds are bounded, and invocations stay in step.
//
// Decoded amplitudes are kept as codes of four bits per coefficient, in scan order. A coefficient's
// context is the sum over its earlier neighbours, whose indices are in the scan entry.
#include "rans.glsl"

const int tsr_levels_group = TSR_LEVELS_GROUP; // they take 16 KiB of shared memory
const int tsr_memory_words = 512; // four bits for each of 4,096 coefficients

#ifndef __cplusplus
// Codes of this plane, and of the sums over the earlier planes of the block.
shared uint tsr_own[tsr_levels_group * tsr_memory_words];
shared uint tsr_cross[tsr_levels_group * tsr_memory_words];
#endif

// Invocations interleave their words, so that those at the same scan index use different memory
// banks.
int tsr_memory(uint lane, uint word) {
    return int((word & 511u) * uint(tsr_levels_group) + lane);
}
// Codes 0, 1, 2, 3, 4, 5, ..., 15 stand for amplitudes 0, 1, 2, 3, 4, 6, ..., 192: two binary
// digits.
uint tsr_amplitude_of(uint code) {
    return code < 2u ? code : (2u + (code & 1u)) << ((code >> 1) - 1u);
}
uint tsr_amplitude_code(uint amplitude) {
    if (amplitude < 2u)
        return amplitude;
    if (amplitude > 191u)
        return 15u;
    // The number of binary digits, without a loop, because tests count all rounds as the segment's
    // work.
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
    uint lane; // of the invocation in its group
    uint tile;
    uint segment_of_tile;
    uint raw;   // the segment's first raw level
    uint room;  // raw levels that fit
    uint count; // raw levels so far
    // The block.
    uint block;
    uint shape;
    uint scan; // word of its first scan entry
    int coded; // number of scan entries
    bool copies;
    uint colour; // see tsr_k_colour
    uint axes;   // see tsr_k_rest
    uint first;     // raw levels of the segment before it
    uint counts;    // see tsr_k_counts
    uint largest_s; // frequency
    uint largest_t;
    int first_plane;
    int planes_end;
    // The plane.
    int plane;
    int size;         // coded coefficients
    int at;           // coefficients decoded
    int state;        // of dependent quantisation
    int first_token;  // length token of plane 0
    int shares_left;  // that come before the coefficients
    uint own;         // the word of codes that is being filled
    uint cross;       // the same word of the earlier planes
    uint cross_words; // number of words that earlier planes have filled
    // The segment's blocks so far.
    int last_kind;    // of the last block with a colour symbol: 0 plain, 1 rotated, 2 with shares
    uint last_colour; // of the last block that was not plain
    ivec2 shares;     // of luma in Co and Cg, in the last block that has shares
    bool alike;       // all planes have the tables of plane 0
    bool damaged;
};

void tsr_begin_block(TSR_INOUT(TsrSegmentWalk) w) {
    w.first_plane = 0;
    w.planes_end = int(tsr_table(tsr_t_planes));
    uint copy = w.alike ? tsr_copy(w.tile, w.block) : 0u;
    if ((copy & tsr_copy_one_plane) != 0u) {
        w.first_plane = (copy & tsr_copy_of_base) != 0u ? 0 : 1;
        w.planes_end = w.first_plane + 1;
    }
    w.plane = w.first_plane;
    w.colour = 0u;
    w.axes = 0u;
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
    tsr_set_work(at + uint(tsr_k_rest),
                 w.axes | (w.largest_s << 8) | (w.largest_t << 16) | (w.segment_of_tile << 24));
    tsr_set_work(at + uint(tsr_k_colour), w.colour);
    w.block += 1u;
}

// Takes the colour that a symbol of kind, and the raw bits behind it, gave a block. Shares follow in
// rounds of their own.
void tsr_take_kind(TSR_INOUT(TsrSegmentWalk) w, int kind, uint raw) {
    if (kind == 1)
        w.colour = w.last_colour;
    if (kind == 2)
        w.colour = 1u + raw;
    w.damaged = w.damaged || (kind == 2 && w.colour > uint(tsr_rotations));
    if (kind >= 3) {
        w.colour = tsr_colour_shares;
        w.shares_left = 2;
    }
    w.last_kind = w.colour == 0u ? 0 : (w.colour < tsr_colour_shares ? 1 : 2);
    if (w.colour != 0u)
        w.last_colour = w.colour;
}

// Takes the difference of a share from that of the last block with shares.
void tsr_take_share(TSR_INOUT(TsrSegmentWalk) w, int difference) {
    if (w.shares_left == 2)
        w.shares.x += difference;
    else
        w.shares.y += difference;
    w.shares_left -= 1;
    if (w.shares_left > 0)
        return;
    w.damaged = w.damaged || max(abs(w.shares.x), abs(w.shares.y)) > tsr_most_share ||
                (w.shares.x == 0 && w.shares.y == 0);
    w.colour = tsr_colour_shares | ((uint(w.shares.x) & 255u) << 16) |
               ((uint(w.shares.y) & 255u) << 24);
    w.last_colour = w.colour;
}

// Whether an axis with this side may have no transform: the side is a power of 2 above 1.
bool tsr_may_be_plain(int side) {
    return side > 1 && (side & (side - 1)) == 0;
}

// Decodes the transform of a block, if it has a symbol for it.
void tsr_take_transform(TSR_INOUT(TsrSegmentWalk) w) {
    uint copy = tsr_copy(w.tile, w.block);
    uint context = (copy >> uint(tsr_copy_transform)) & 15u;
    if ((copy & tsr_copy_of_border) == 0u || context == 0u)
        return;
    int symbol =
        tsr_symbol7(w.r, uint(tsr_t_transform) + (context - 1u) * uint(tsr_symbol7_words));
    ivec4 sides = tsr_sides_of(w.shape);
    if (sides.x > 1 && (symbol == 1 || symbol == 2))
        w.axes |= tsr_sines_u;
    if (sides.y > 1 && (symbol == 1 || symbol == 3))
        w.axes |= tsr_sines_v;
    if (tsr_may_be_plain(sides.x) && (symbol == 4 || symbol == 5))
        w.axes |= tsr_plain_u;
    if (tsr_may_be_plain(sides.y) && (symbol == 4 || symbol == 6))
        w.axes |= tsr_plain_v;
}

// Decodes the length of a plane and, behind that of plane 0, the colour of the block; or a share,
// which is not part of the work of a segment. They use the same calls, because some devices run the
// code of all branches in every round. The transform follows behind the colour or the last share.
void tsr_plane_head(TSR_INOUT(TsrSegmentWalk) w) {
    bool is_share = w.shares_left > 0;
    uint table = uint(tsr_t_other_length + w.first_token * tsr_symbol_words);
    if (is_share) {
        table = uint(tsr_t_share + (2 - w.shares_left) * tsr_symbol_words);
    } else if (w.plane == 0 || w.alike) {
        w.copies = (tsr_copy(w.tile, w.block) & 3u) != 0u;
        table = uint(w.copies ? tsr_t_copying_length : tsr_t_first_length) +
                tsr_shape(w.shape, tsr_s_size_class) * uint(tsr_symbol_words);
    }
    int token = tsr_symbol(w.r, table);
    int bits = token <= 1 ? 0 : (token == 2 ? 1 : 2);
    if (is_share)
        bits = clamp(token - 1, 0, 8);
    int raw = int(tsr_raw(w.r, bits));
    int length = token == 0 ? 0 : 1 << (token - 1);
    length += raw << max(0, token - 1 - bits);
    bool has_colour = false;
    int more = is_share && token > 0 ? 1 : 0; // the sign of the difference
    int kind = 0;
    if (!is_share) {
        w.size = min(length, w.coded);
        w.at = 0;
        w.state = 0;
        if (w.plane == 0) {
            w.first_token = token;
            has_colour = w.size > 0 && tsr_table(tsr_t_rotates) != 0u;
        }
    }
    if (has_colour) {
        kind = tsr_symbol5(w.r, uint(tsr_t_kind + w.last_kind * tsr_symbol5_words));
        more = kind == 2 ? 6 : 0;
    }
    uint last = tsr_raw(w.r, more);
    if (is_share)
        tsr_take_share(w, last != 0u ? -length : length);
    if (has_colour)
        tsr_take_kind(w, kind, last);
    bool may_follow = w.plane == w.first_plane || (tsr_table(tsr_t_any_plane) != 0u && w.cross_words == 0u);
    if (may_follow && w.size > 0 && w.shares_left == 0)
        tsr_take_transform(w);
}

void tsr_keep_level(TSR_INOUT(TsrSegmentWalk) w, uint frequency, uint magnitude, uint negative) {
    if (w.count < w.room) {
        uint at = tsr_header(tsr_b_raw_at) + (w.raw + w.count) * uint(tsr_raw_words);
        tsr_set_work(at, (frequency << 12) | w.block);
        tsr_set_work(at + 1u, magnitude | (negative << 20) | (uint(w.plane) << 30));
        w.count += 1u;
    } else
        w.damaged = true;
    w.counts += w.plane < 3 ? 1u : 0x10000u;
    w.largest_s = max(w.largest_s, (frequency >> 10) & 31u);
    w.largest_t = max(w.largest_t, frequency >> 15);
}

// The state of dependent quantisation after a magnitude: next_state of format/tile/code_tables.h,
// packed as four bits per state for even and for odd magnitudes.
int tsr_next_state(int state, uint magnitude) {
    uint next = (magnitude & 1u) == 0u ? 0x73426150u : 0x51604372u;
    return int((next >> uint(4 * state)) & 7u);
}

// Index of a magnitude's table: magnitude_table() of format/tile/code_tables.h.
int tsr_magnitude_table(TsrSegmentWalk w, int quantiser, int neighbours, int cross) {
    bool dc = w.at == 0;
    int first = ((w.copies ? 2 : 0) + quantiser) * tsr_magnitude_tables;
    if (w.plane == 0 || w.alike)
        return first + (dc ? tsr_first_magnitude_dc : 0) + neighbours;
    if (dc)
        return first + tsr_other_magnitude_dc + neighbours;
    return first + tsr_other_magnitudes + (neighbours >> 1) * tsr_magnitude_crosses +
           max(cross - 2, 0);
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
    uint context = tsr_table(entry + uint(tsr_scan_context));
    uint cross = (w.cross >> shift) & 15u;
    int cross_class = min(int(cross + 1u) >> 1, tsr_cross_classes - 1);
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
    int row = ((w.copies ? 2 : 0) + quantiser) * tsr_zero_rows +
              (w.plane == 0 || w.alike ? 0 : 1 + cross_class);
    int zero = tsr_t_zero +
               (row * tsr_zero_positions + int(context >> 16)) * tsr_neighbour_classes + neighbours;
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

// The entropy state behind the tree, where segment 0 goes on.
void tsr_skip_tree(uint state, uint byte_at, uint words, TSR_INOUT(TsrRans) r) {
    r.left = min(tsr_work_word(state + uint(tsr_st_left)), words);
    r.at = byte_at + 2u * (words - r.left);
    r.state = tsr_work_word(state + uint(tsr_st_rans));
}

TsrSegmentWalk tsr_start_segment(uint tile, uint segment_of_tile, uint segment, uint lane) {
    TsrSegmentWalk w;
    uint byte_at = tsr_segment(segment, tsr_seg_byte);
    uint words = tsr_segment(segment, tsr_seg_size);
    w.r = tsr_begin(byte_at, words);
    if (segment_of_tile == 0u)
        tsr_skip_tree(tsr_state_at(tile), byte_at, words, w.r);
    w.lane = lane;
    w.tile = tile;
    w.segment_of_tile = segment_of_tile;
    w.raw = tsr_segment(segment, tsr_seg_raw);
    w.room = tsr_segment(segment, tsr_seg_room);
    w.count = 0u;
    w.block = tsr_segment(segment, tsr_seg_first);
    w.copies = false;
    w.last_kind = 0;
    w.last_colour = 1u;
    w.shares = ivec2(0);
    w.size = 0;
    w.at = 0;
    w.state = 0;
    w.first_token = 0;
    w.shares_left = 0;
    w.own = 0u;
    w.cross = 0u;
    w.alike = tsr_table(tsr_t_plane_trees) != 0u;
    w.damaged = false;
    return w;
}

// Ends a plane and, after the last plane, its block.
void tsr_end_plane(TSR_INOUT(TsrSegmentWalk) w, uint end) {
    w.cross_words = max(w.cross_words, uint(w.size + 7) >> 3);
    w.plane += 1;
    w.size = 0;
    w.at = 0;
    if (w.plane < w.planes_end)
        return;
    tsr_end_block(w);
    if (w.block < end)
        tsr_begin_block(w);
}

void tsr_end_segment(TsrSegmentWalk w, uint segment, uint end) {
    if (w.block < end || w.damaged)
        tsr_damage(w.tile, tsr_damage_levels);
    else if (!tsr_ended_well(w.r))
        tsr_damage(w.tile, tsr_damage_end);
    uint levels = tsr_state_at(w.tile) + uint(tsr_st_levels);
    if (levels < uint(tsr_work.length()))
        TSR_ATOMIC_ADD(levels, w.count);
    tsr_set_work(tsr_header(tsr_b_counts_at) + segment, w.count);
}

void tsr_decode_segment(uint tile, uint segment_of_tile, uint lane) {
    if (tile >= tsr_header(tsr_b_tiles) || segment_of_tile >= tsr_tile(tile, tsr_tile_segments))
        return;
    uint state = tsr_state_at(tile);
    if ((tsr_work_word(state + uint(tsr_st_damaged)) & tsr_damage_tree) != 0u)
        return;
    uint segment = tsr_tile(tile, tsr_tile_segment) + segment_of_tile;
    TsrSegmentWalk w = tsr_start_segment(tile, segment_of_tile, segment, lane);
    int rounds = tsr_max_work;
    if (segment_of_tile == 0u) // the tree's nodes count as work of segment 0
        rounds -= int(min(tsr_work_word(state + uint(tsr_st_nodes)), uint(tsr_max_nodes)));
    uint blocks = min(tsr_work_word(state + uint(tsr_st_blocks)), uint(tsr_max_blocks));
    uint end = tsr_segment(segment, tsr_seg_end);
    if (end == tsr_none)
        end = blocks;
    if (end > blocks || (segment_of_tile > 0u && end <= w.block)) {
        tsr_damage(tile, tsr_damage_segments);
        return;
    }
    if (w.block < end)
        tsr_begin_block(w);
    for (int round = 0; round < rounds; ++round) {
        TSR_LOOP;
        if (w.block >= end || w.damaged)
            break;
        if (w.at < w.size && w.shares_left == 0) {
            tsr_coefficient(w);
        } else {
            tsr_plane_head(w);
            rounds += w.shares_left == 2 ? 2 : 0; // they take a round each
        }
        if (w.at == w.size)
            tsr_end_plane(w, end);
    }
    tsr_end_segment(w, segment, end);
}

#ifndef __cplusplus
layout(local_size_x = TSR_LEVELS_GROUP) in;
void main() {
    tsr_decode_segment(gl_GlobalInvocationID.x, gl_WorkGroupID.y, gl_LocalInvocationIndex);
}
#endif
