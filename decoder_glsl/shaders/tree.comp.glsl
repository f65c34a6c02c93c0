// Pass 1, one invocation per tile: decodes the split tree, which gives the tile's blocks (FORMAT.md
// 3.4).
#include "rans.glsl"

struct TsrNode {
    uint place; // origin, as in tsr_k_place
    uint shape;
    uint depths; // spatial splits above | angular splits << 4
};

// Child number `child` of a node that is split along a pair of axes (1 spatial, 2 angular). A side
// of 1 is not divided, so the node then has two children.
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

// Reads past the prediction of a leaf. The batch holds what it says, because the host decodes the
// tree as well and knows the depths of the copies. `copies`: whether the last leaf that had a
// prediction copied something.
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

// Reads past a leaf's copy of the base picture. Returns whether it copies; `before`: whether the
// previous leaf did.
bool tsr_pass_base(TSR_INOUT(TsrRans) r, bool before) {
    bool copies = tsr_symbol3(r, uint(tsr_t_from_base + (before ? 1 : 0))) != 0;
    if (copies)
        tsr_pass_difference(r, uint(tsr_t_base_displacement));
    return copies;
}

// Decodes whether a tile has a base picture. Tiles of fewer than four views cannot have one.
bool tsr_has_base(TSR_INOUT(TsrRans) r, ivec4 sides) {
    if (tsr_table(tsr_t_base_pictures) == 0u || sides.z * sides.w < 4)
        return false;
    return tsr_symbol3(r, uint(tsr_t_base)) != 0;
}

struct TsrTree {
    TsrRans r;
    uint tile;
    uint blocks; // so far
    uint nodes;
    bool has_base;
    bool copies; // see tsr_pass_prediction
    bool copies_base;
};

// Adds a leaf to the tile's blocks and reads past its prediction.
void tsr_add_leaf(TSR_INOUT(TsrTree) tree, TsrNode leaf) {
    uint at = tsr_block_at(tree.tile, tree.blocks);
    tsr_set_work(at + uint(tsr_k_place), leaf.place);
    tsr_set_work(at + uint(tsr_k_shape), leaf.shape);
    tree.blocks += 1u;
    if (tsr_table(tsr_t_predicts) == 0u || leaf.depths >= tsr_depths_of_base)
        return;
    if (tree.has_base)
        tree.copies_base = tsr_pass_base(tree.r, tree.copies_base);
    if (!tree.copies_base)
        tsr_pass_prediction(tree.r, leaf.place, tree.copies);
}

// Decodes how a node is split: 0 not at all, 1 spatially, 2 angularly. The root of a base picture
// that is too large for a block is split spatially without a symbol.
int tsr_split_of(TSR_INOUT(TsrTree) tree, TsrNode node) {
    tree.nodes += 1u;
    if (node.depths == tsr_depths_of_base) {
        ivec4 sides = tsr_sides_of(node.shape);
        if (max(sides.x, sides.y) > tsr_max_spatial_side)
            return 1;
    }
    uint last = uint(tsr_depth_classes - 1);
    uint spatial = min(node.depths & 15u, last);
    uint angular = min(node.depths >> 4, last);
    return tsr_symbol3(tree.r,
                       uint(tsr_t_split) + spatial * uint(tsr_depth_classes) + angular);
}

void tsr_end_tree(TsrTree tree, bool damaged) {
    uint at = tsr_state_at(tree.tile);
    tsr_set_work(at + uint(tsr_st_blocks), tree.blocks);
    tsr_set_work(at + uint(tsr_st_rans), tree.r.state);
    tsr_set_work(at + uint(tsr_st_left), tree.r.left);
    tsr_set_work(at + uint(tsr_st_nodes), tree.nodes);
    tsr_set_work(at + uint(tsr_st_damaged), damaged ? tsr_damage_tree : 0u);
    tsr_set_work(at + uint(tsr_st_levels), 0u);
}

TsrTree tsr_start_tree(uint tile) {
    uint segment = tsr_tile(tile, tsr_tile_segment);
    TsrTree tree;
    tree.r = tsr_begin(tsr_segment(segment, tsr_seg_byte), tsr_segment(segment, tsr_seg_size));
    tree.tile = tile;
    tree.blocks = 0u;
    tree.nodes = 0u;
    tree.has_base = tsr_has_base(tree.r, tsr_sides_of(tsr_tile(tile, tsr_tile_shape)));
    tree.copies = false;
    tree.copies_base = false;
    return tree;
}

void tsr_decode_tree(uint tile) {
    if (tile >= tsr_header(tsr_b_tiles))
        return;
    TsrTree tree = tsr_start_tree(tile);
    // The nodes that are not decoded yet, the next one last. No legal tree has more than 34: each
    // of 6 splits of sides up to 64 and 5 of sides up to 32 adds three.
    TsrNode stack[36];
    stack[0].place = 0u;
    stack[0].shape = tsr_tile(tile, tsr_tile_shape);
    stack[0].depths = 0u;
    int waiting = 1;
    uint room = min(tsr_tile(tile, tsr_tile_block_room), uint(tsr_max_blocks));
    uint base = tsr_tile(tile, tsr_tile_base);
    if (tree.has_base && base == tsr_none) {
        room = 0u; // the host has found the tile damaged
    } else if (tree.has_base) { // its tree comes first
        stack[1].place = 0u;
        stack[1].shape = base;
        stack[1].depths = tsr_depths_of_base;
        waiting = 2;
    }
    for (int step = 0; step < tsr_max_nodes && waiting > 0; ++step) {
        TSR_LOOP;
        TsrNode node = stack[waiting - 1];
        int split = tsr_split_of(tree, node);
        if (split == 0) {
            if (tree.blocks >= room)
                break;
            waiting -= 1;
            tsr_add_leaf(tree, node);
            continue;
        }
        int children = tsr_s_children + 2 * (split - 1);
        // A node whose sides are all 1 has no children.
        if ((tsr_shape(node.shape, children) & 0xFFFFu) == 0xFFFFu || waiting > 32)
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
    tsr_end_tree(tree, waiting > 0);
}

#ifndef __cplusplus
layout(local_size_x = TSR_STREAM_GROUP) in;
void main() {
    tsr_decode_tree(gl_GlobalInvocationID.x);
}
#endif
