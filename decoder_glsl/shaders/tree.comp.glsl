// Pass 1, one invocation a tile: the split tree, which gives the tile's blocks (FORMAT.md 3.4).
#include "rans.glsl"

struct TsrNode {
    uint place; // as in tsr_k_place
    uint shape;
    uint depths; // spatial | angular << 4
};

// Child number `child` of a node split along both axes of a pair, or along the only one of them that
// is longer than 1.
TsrNode tsr_child(TsrNode parent, int split, uint child) {
    ivec4 sides = tsr_sides_of(parent.shape);
    int side_a = split == 1 ? sides.x : sides.z;
    int side_b = split == 1 ? sides.y : sides.w;
    uint a = side_a > 1 ? child & 1u : 0u;
    uint b = side_a > 1 ? child >> 1 : child;
    // The first half of a side is the larger one.
    uint moved_a = a * uint((side_a + 1) / 2);
    uint moved_b = b * uint((side_b + 1) / 2);
    uint moved = split == 1 ? moved_a + (moved_b << tsr_place_v)
                            : (moved_a << tsr_place_s) + (moved_b << tsr_place_t);
    uint ids = tsr_shape(parent.shape, tsr_s_children + 2 * (split - 1) + int(child >> 1));
    TsrNode node;
    node.place = (parent.place + moved) & tsr_place_mask;
    node.shape = (ids >> ((child & 1u) * 16u)) & 0xFFFFu;
    node.depths = parent.depths + (split == 1 ? 1u : 16u);
    return node;
}

void tsr_pass_difference(TSR_INOUT(TsrRans) r, uint table) {
    int token = tsr_symbol(r, table);
    if (token > 0) {
        tsr_raw(r, token - 1);
        tsr_raw(r, 1);
    }
}

void tsr_pass_displacement(TSR_INOUT(TsrRans) r, int direction) {
    if (tsr_symbol3(r, uint(tsr_t_displacement_kind + direction)) == 2) {
        tsr_pass_difference(r, uint(tsr_t_displacement + direction * tsr_symbol_words));
        tsr_pass_difference(r, uint(tsr_t_displacement + (1 - direction) * tsr_symbol_words));
    }
}

// Reads past the prediction of a leaf. What it says comes with the batch: the host, which counts the
// tree, knows it, and has the depths of the copies besides. `copies`: whether the last leaf that has
// a prediction copies something.
void tsr_pass_prediction(TSR_INOUT(TsrRans) r, uint place, TSR_INOUT(bool) copies) {
    ivec4 origin = tsr_origin_of(place);
    bool along_s = origin.z != 0;
    bool along_t = origin.w != 0;
    if (!along_s && !along_t)
        return;
    int context = (along_s ? (along_t ? 4 : 0) : 2) + (copies ? 1 : 0);
    int symbol = tsr_symbol3(r, uint(tsr_t_prediction + context));
    copies = symbol != 0;
    if (copies)
        tsr_pass_displacement(r, along_s && symbol == 1 ? 0 : 1);
}

// Reads past whether a leaf copies the base picture, and by how much. Returns the first.
bool tsr_pass_base(TSR_INOUT(TsrRans) r, bool before) {
    bool copies = tsr_symbol3(r, uint(tsr_t_from_base + (before ? 1 : 0))) != 0;
    if (copies)
        tsr_pass_difference(r, uint(tsr_t_base_displacement));
    return copies;
}

// Reads whether a tile has a base picture, where it can have one.
bool tsr_has_base(TSR_INOUT(TsrRans) r, ivec4 sides) {
    if (tsr_table(tsr_t_base_pictures) == 0u || sides.z * sides.w < 4)
        return false;
    return tsr_symbol3(r, uint(tsr_t_base)) != 0;
}

void tsr_decode_tree(uint tile) {
    if (tile >= tsr_header(tsr_b_tiles))
        return;
    uint segment = tsr_tile(tile, tsr_tile_segment);
    TsrRans r = tsr_begin(tsr_segment(segment, tsr_seg_byte), tsr_segment(segment, tsr_seg_size));
    // Younger siblings wait here for the subtrees of the elder: 3 a level that cuts two sides, else 1.
    TsrNode stack[36];
    stack[0].place = 0u;
    stack[0].shape = tsr_tile(tile, tsr_tile_shape);
    stack[0].depths = 0u;
    int waiting = 1;
    uint room = min(tsr_tile(tile, tsr_tile_block_room), uint(tsr_max_blocks));
    uint base = tsr_tile(tile, tsr_tile_base);
    bool has_base = tsr_has_base(r, tsr_sides_of(stack[0].shape));
    if (has_base && base == tsr_none) {
        room = 0u; // the host found that a tree is not one: the tile is damaged
    } else if (has_base) { // its tree comes first
        stack[1].place = 0u;
        stack[1].shape = base;
        stack[1].depths = tsr_depths_of_base;
        waiting = 2;
    }
    // The root of a base picture that is too large for a block is split without a symbol.
    ivec4 base_sides = has_base ? tsr_sides_of(base) : ivec4(0);
    bool base_is_cut = max(base_sides.x, base_sides.y) > tsr_max_spatial_side;
    uint blocks = 0u;
    uint nodes = 0u;
    bool predicts = tsr_table(tsr_t_predicts) != 0u;
    bool copies = false;
    bool copies_base = false;
    for (int step = 0; step < tsr_max_nodes && waiting > 0; ++step) {
        TSR_LOOP;
        TsrNode node = stack[waiting - 1];
        uint classes = uint(tsr_depth_classes);
        uint spatial = min(node.depths & 15u, classes - 1u);
        uint angular = min(node.depths >> 4, classes - 1u);
        int split = 1;
        if (!base_is_cut || node.depths != tsr_depths_of_base)
            split = tsr_symbol3(r, uint(tsr_t_split) + spatial * classes + angular);
        nodes += 1u;
        if (split == 0) {
            if (blocks >= room)
                break;
            waiting -= 1;
            uint at = tsr_block_at(tile, blocks);
            tsr_set_work(at + uint(tsr_k_place), node.place);
            tsr_set_work(at + uint(tsr_k_shape), node.shape);
            blocks += 1u;
            if (!predicts || node.depths >= tsr_depths_of_base)
                continue;
            if (has_base)
                copies_base = tsr_pass_base(r, copies_base);
            if (!copies_base)
                tsr_pass_prediction(r, node.place, copies);
            continue;
        }
        int children = tsr_s_children + 2 * (split - 1);
        uint ids = tsr_shape(node.shape, children);
        // Sides of 1 cannot be split; no stack of a legal tree grows past 34, with 3 more for each of 6
        // splits of sides up to 64 and of 5 of sides up to 32.
        if ((ids & 0xFFFFu) == 0xFFFFu || waiting > 32)
            break;
        waiting -= 1;
        bool four = (tsr_shape(node.shape, children + 1) & 0xFFFFu) != 0xFFFFu;
        if (four) {
            stack[waiting] = tsr_child(node, split, 3u);
            stack[waiting + 1] = tsr_child(node, split, 2u);
            waiting += 2;
        }
        stack[waiting] = tsr_child(node, split, 1u);
        stack[waiting + 1] = tsr_child(node, split, 0u);
        waiting += 2;
    }
    uint at = tsr_state_at(tile);
    tsr_set_work(at + uint(tsr_st_blocks), blocks);
    tsr_set_work(at + uint(tsr_st_rans), r.state);
    tsr_set_work(at + uint(tsr_st_left), r.left);
    tsr_set_work(at + uint(tsr_st_nodes), nodes);
    tsr_set_work(at + uint(tsr_st_damaged), waiting > 0 ? tsr_damage_tree : 0u);
    tsr_set_work(at + uint(tsr_st_levels), 0u);
}

#ifndef __cplusplus
layout(local_size_x = 16) in;
void main() {
    tsr_decode_tree(gl_GlobalInvocationID.x);
}
#endif
