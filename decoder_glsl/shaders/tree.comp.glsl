// Pass 1, one invocation per tile: decodes the split tree, which gives the tile's blocks (FORMAT.md
// 3.4).
#include "rans.glsl"

struct TsrNode {
    uint place; // origin, as in tsr_k_place
    uint shape;
    uint depths; // spatial splits above | angular splits << 8
    bool of_base; // of the base picture's tree, or of plane 0 where each plane has a tree
};

// Word of a shape's record with the children of a split: 1 along u and v, 2 along s and t, 3 along
// u, 4 along v.
int tsr_children_of(int split) {
    return tsr_s_children + (split < 3 ? 2 * (split - 1) : split + 1);
}

// Child number `child` of a node. A side of 1 is not divided, so a split along two axes then gives
// two children.
TsrNode tsr_child(TsrNode parent, int split, uint child) {
    ivec4 sides = tsr_sides_of(parent.shape);
    bool angular = split == 2;
    int side_a = angular ? sides.z : sides.x;
    int side_b = angular ? sides.w : sides.y;
    bool halves_a = side_a > 1 && split != 4;
    uint a = halves_a ? child & 1u : 0u;
    uint b = halves_a ? child >> 1 : child;
    // The first half of a side is the larger one.
    uint moved_a = a * uint((side_a + 1) / 2);
    uint moved_b = b * uint((side_b + 1) / 2);
    uint moved = angular ? (moved_a << tsr_place_s) + (moved_b << tsr_place_t)
                         : moved_a + (moved_b << tsr_place_v);
    uint ids = tsr_shape(parent.shape, tsr_children_of(split) + int(child >> 1));
    TsrNode node;
    node.place = (parent.place + moved) & tsr_place_mask;
    node.shape = (ids >> ((child & 1u) * 16u)) & 0xFFFFu;
    node.depths = parent.depths + (angular ? 256u : 1u);
    node.of_base = parent.of_base;
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

// Decodes whether a tile has a base picture. Tiles of fewer than four views and tiles that are
// larger than a block cannot have one.
bool tsr_has_base(TSR_INOUT(TsrRans) r, ivec4 sides) {
    if (tsr_table(tsr_t_base_pictures) == 0u || sides.z * sides.w < 4 ||
        max(sides.x, sides.y) > tsr_max_block_side)
        return false;
    return tsr_symbol3(r, uint(tsr_t_base)) != 0;
}

// Decodes whether each plane of a tile of one view has a tree of its own. That of plane 0 is then
// decoded like that of a base picture.
bool tsr_has_plane_trees(TSR_INOUT(TsrRans) r, bool is_picture) {
    return is_picture && tsr_table(tsr_t_plane_trees) != 0u && tsr_raw(r, 1) != 0u;
}

struct TsrTree {
    TsrRans r;
    uint tile;
    uint blocks; // so far
    uint nodes;
    bool is_picture; // has one view
    bool has_base;
    bool copies; // see tsr_pass_prediction
    bool copies_base;
};

// Reads past the mode of a leaf of a picture, or past another leaf's copy of the base picture, if it
// has one. Returns whether it copies. Both use the same calls, because some devices run the code of
// all branches in every round. `copy`: the leaf's copy record, which has the context of a mode: it
// depends on earlier modes, which the host knows.
bool tsr_pass_mode_or_base(TSR_INOUT(TsrTree) tree, bool of_picture, uint copy) {
    uint table = uint(tsr_t_mode) + ((copy >> 4) & 15u) * uint(tsr_symbol_words);
    if (!of_picture) {
        table = uint(tsr_t_base_displacement);
        if (tsr_symbol3(tree.r, uint(tsr_t_from_base + (tree.copies_base ? 1 : 0))) == 0)
            return false;
    }
    int token = tsr_symbol(tree.r, table);
    tsr_raw(tree.r, of_picture ? (token == 5 ? 5 : 0) : max(token - 1, 0));
    tsr_raw(tree.r, !of_picture && token > 0 ? 1 : 0);
    return !of_picture;
}

// Adds a leaf to the tile's blocks and reads past its prediction.
void tsr_add_leaf(TSR_INOUT(TsrTree) tree, TsrNode leaf) {
    uint number = tree.blocks;
    uint at = tsr_block_at(tree.tile, number);
    tsr_set_work(at + uint(tsr_k_place), leaf.place);
    tsr_set_work(at + uint(tsr_k_shape), leaf.shape);
    tree.blocks += 1u;
    if (tsr_table(tsr_t_predicts) == 0u)
        return;
    bool of_picture = tree.is_picture || leaf.of_base;
    if (of_picture || tree.has_base)
        tree.copies_base = tsr_pass_mode_or_base(tree, of_picture, tsr_copy(tree.tile, number));
    if (!of_picture && !tree.copies_base)
        tsr_pass_prediction(tree.r, leaf.place, tree.copies);
}

// Decodes how a node is split: 0 not at all, else as in tsr_children_of(). A node that is too large
// for a block is split along u and v without a symbol.
int tsr_split_of(TSR_INOUT(TsrTree) tree, TsrNode node) {
    tree.nodes += 1u;
    ivec4 sides = tsr_sides_of(node.shape);
    if (max(sides.x, sides.y) > tsr_max_block_side)
        return 1;
    uint last = uint(tsr_depth_classes - 1);
    uint spatial = min(node.depths & 255u, last);
    uint angular = min(node.depths >> 8, last);
    return min(tsr_symbol5(tree.r, uint(tsr_t_split) +
                                       (spatial * uint(tsr_depth_classes) + angular) *
                                           uint(tsr_symbol5_words)),
               4);
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
    ivec4 sides = tsr_sides_of(tsr_tile(tile, tsr_tile_shape));
    tree.is_picture = sides.z * sides.w == 1;
    tree.has_base =
        tsr_has_base(tree.r, sides) || tsr_has_plane_trees(tree.r, tree.is_picture);
    tree.copies = false;
    tree.copies_base = false;
    return tree;
}

void tsr_decode_tree(uint tile) {
    if (tile >= tsr_header(tsr_b_tiles))
        return;
    TsrTree tree = tsr_start_tree(tile);
    // The nodes that are not decoded yet, the next one last. No legal tree has more than 34: each
    // of 6 splits of sides up to 64 and 5 of sides up to 32 adds three, and tiles with longer sides
    // have few views.
    TsrNode stack[36];
    stack[0].place = 0u;
    stack[0].shape = tsr_tile(tile, tsr_tile_shape);
    stack[0].depths = 0u;
    stack[0].of_base = false;
    int waiting = 1;
    uint room = min(tsr_tile(tile, tsr_tile_block_room), uint(tsr_max_blocks));
    uint base = tsr_tile(tile, tsr_tile_base);
    if (tree.has_base && base == tsr_none) {
        room = 0u; // the host has found the tile damaged
    } else if (tree.has_base) { // its tree comes first
        stack[1].place = 0u;
        stack[1].shape = base;
        stack[1].depths = tree.is_picture ? 0u : tsr_depths_of_base;
        stack[1].of_base = true;
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
        int children = tsr_children_of(split);
        // A node has no children along sides of 1.
        if ((tsr_shape(node.shape, children) & 0xFFFFu) == 0xFFFFu || waiting > 32)
            break;
        waiting -= 1;
        bool four = split < 3 && (tsr_shape(node.shape, children + 1) & 0xFFFFu) != 0xFFFFu;
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
