// Where things lie in the four buffers of the decoder, in 32-bit words. Shared by shaders and host.
#ifndef TSR_LAYOUT
#define TSR_LAYOUT

// Limits of the format (FORMAT.md 3.1).
const int tsr_max_blocks = 4096;
const int tsr_max_nodes = 8192;
const int tsr_max_work = 16000;
const int tsr_max_coded = 4096;
const int tsr_max_spatial_side = 64; // of tiles and blocks
const int tsr_max_base_side = 126;   // of base pictures, whose blocks lie that far from the first texel
const int tsr_max_angular_side = 32;
const int tsr_max_frequencies = 32;    // coded along an axis
const int tsr_depth_classes = 6;       // of either pair, the deepest in one
const int tsr_correction_chunk = 4096; // texels

// ---- Binding 0, tables: one a file, read only.
const int tsr_t_sample_type = 0; // 0 unorm8, 1 half16
const int tsr_t_planes = 1;      // 1..4
const int tsr_t_colour = 2;      // 1: YCoCg-R
const int tsr_t_rotates = 3;
const int tsr_t_background = 4; // four planes, signed
const int tsr_t_fraction = 8;
const int tsr_t_correction_step = 9; // 2 E + 1
const int tsr_t_offsets = 10;        // plane 0: magnitude 1, larger; the other planes: the same
const int tsr_t_background_texel = 14; // two words: the texel as it is stored, see tsr_pack
const int tsr_t_dependent = 16; // 1: dependent quantisation
const int tsr_t_shapes = 17;    // word of the first shape record
const int tsr_t_predicts = 18;  // leaves of split trees are followed by predictions
const int tsr_t_smooth = 19;    // 1: smooth copies
const int tsr_t_filtered = 20;  // 1: a filter
const int tsr_t_base_pictures = 21; // 1: tiles may have one
const int tsr_t_base_margin = 22;
const int tsr_t_base = 23;      // [1] words c[1] | c[2] << 16
const int tsr_t_from_base = 24; // [2] likewise
const int tsr_t_zero = 32;      // frequencies of 0: [2][2][7][6][16]
const int tsr_symbol_words = 12; // a symbol table: the starts c[1] | c[2] << 16, ..., padded with 4096
const int tsr_t_magnitude = 2720;    // [2][2][66] symbol tables
const int tsr_t_first_length = 5888; // [9]
const int tsr_t_other_length = 5996; // [14]
const int tsr_t_correction = 6164;   // [21]
const int tsr_t_split = 6416;        // [depth classes][depth classes] words c[1] | c[2] << 16
const int tsr_t_kind = 6452;         // [2] likewise: the kind of a block's colour
const int tsr_t_rotation = 6456;     // [49][9] signed
const int tsr_t_basis = 6904;        // b(n, k, x) of n <= 32, signed: see tsr_basis_of
const int tsr_t_prediction = 18344;        // [6] words c[1] | c[2] << 16
const int tsr_t_displacement = 18350;      // [2]
const int tsr_t_displacement_kind = 18374; // [2] words c[1] | c[2] << 16
const int tsr_t_copying_length = 18376;    // [9] tsr_t_first_length of blocks that copy something
const int tsr_t_wide_basis = 18484;        // b(n, k, x) of n = 33..64, the coded frequencies only
const int tsr_t_filter = 68148;      // of planes 0..3, for each of 3 rings: slope | strength << 16
const int tsr_t_base_displacement = 68160; // [1]
const int tsr_t_base_filter = 68172; // [8][6] signed
const int tsr_t_end = 68220;         // shape records and their scans follow

// A shape record. A scan entry: frequency (5 bits each of u, v, s, t, u lowest), then the 12 earlier
// neighbours as 16-bit scan indices, the four that count double first; the entry's own index where
// there is none; last its share | position << 16 (see ScanContext).
const int tsr_shape_words = 36;
const int tsr_s_sides = 0; // nu | nv << 8 | ns << 16 | nt << 24
const int tsr_s_scan = 1;  // word of its first scan entry
const int tsr_s_coded = 2; // number of scan entries
const int tsr_s_size_class = 3;
const int tsr_s_children = 4; // two words a split: four 16-bit shapes, 0xFFFF none
const int tsr_s_scales = 8;   // [planes 0..3, rotated][axes 0..4] mantissa | exponent + 128 << 16
const int tsr_scan_words = 8;

// ---- Binding 1, batch: what to decode and the payloads; read only.
const int tsr_b_tiles = 0;
const int tsr_b_raw_chunks = 2; // of 64 raw levels
const int tsr_b_corrections = 3;
const int tsr_b_tile_at = 4; // words where the records begin
const int tsr_b_segment_at = 5;
const int tsr_b_raw_chunk_at = 6; // the segment of each raw chunk
const int tsr_b_correction_at = 7;
const int tsr_b_payload_at = 8;
const int tsr_b_fold_u = 9; // where texels go: see tsr_place in texels.comp.glsl
const int tsr_b_fold_v = 10;
const int tsr_b_folds_u = 11;
const int tsr_b_stride_s = 12;
const int tsr_b_stride_t = 13;
const int tsr_b_blocks_at = 14; // words in the work buffer
const int tsr_b_raw_at = 15;
const int tsr_b_multipliers_at = 16;
const int tsr_b_payload_bytes = 17;
const int tsr_b_counts_at = 18; // in the work buffer: how many raw levels each segment gave
const int tsr_b_items_at = 19;
const int tsr_b_items_room = 20; // items
const int tsr_b_copies_at = 21;  // what the blocks of predicted tiles copy
const int tsr_b_values_at = 22;  // in the work buffer: values that tiles keep
const int tsr_batch_words = 32;

const int tsr_tile_words = 14;
const int tsr_tile_shape = 0;
const int tsr_tile_segment = 1; // its first one
const int tsr_tile_segments = 2;
const int tsr_tile_x = 3; // pixel of its first texel
const int tsr_tile_y = 4;
const int tsr_tile_layer = 5;
const int tsr_tile_origin = 6;      // its first u | v << 16, when texels are folded over layers
const int tsr_tile_multipliers = 7; // of its corrections, from tsr_b_multipliers_at; or none
const int tsr_tile_blocks = 8;      // its first block record, counted in records
const int tsr_tile_block_room = 9;  // records
const int tsr_tile_copies = 10; // word of its first copy record, from tsr_b_copies_at; none: not predicted
const int tsr_tile_values = 11; // word of its values, from tsr_b_values_at; or none
const int tsr_tile_base = 12;   // shape of its base picture; or none
const int tsr_tile_stored = 13; // byte of a stored tile's first sample, of the payload area; or none

// A copy record, one a block of a predicted tile (FORMAT.md 4.6).
// 1 along s, 2 along t, 3 the base picture | depth << 8 | displacement in half texels, of the base in
// eighths, signed bytes: u << 16 | v << 24. Or, of a block of the base picture, 4 | fineness << 16.
const int tsr_copy_words = 1;
const uint tsr_copy_of_base = 4u;
// Depths of the root of a base picture's split tree, see TsrNode: none spatial, more angular ones than a
// tile has.
const uint tsr_depths_of_base = 0x1000u;

const int tsr_segment_words = 7;
const int tsr_seg_tile = 0;
const int tsr_seg_byte = 1;  // of the payload area
const int tsr_seg_size = 2;  // 16-bit words
const int tsr_seg_first = 3; // first block
const int tsr_seg_end = 4;   // one past its last block; tsr_none: all that are left
const int tsr_seg_raw = 5;   // its first raw level; where its sorted coefficients go, too
const int tsr_seg_room = 6;  // raw levels there is room for

const int tsr_correction_words = 4; // tile, byte, 16-bit words, chunk

const uint tsr_none = 0xFFFFFFFFu;
const uint tsr_nowhere = 0xF0000000u; // a word past any buffer

// ---- Binding 2, work: what the passes hand to each other.
const int tsr_w_groups = 0; // arguments of the indirect dispatch of texels.comp, three words
const int tsr_w_items = 3;  // number of items, as they are made
const int tsr_w_wave = 4;   // blocks of this depth of copies are next
const int tsr_w_ready = 5;  // number of items of the wave that texels.comp is at
const int tsr_w_state = 8;  // the tile states; what follows is placed by the batch header
const int tsr_state_words = 6;
const int tsr_st_blocks = 0;
const int tsr_st_rans = 1;  // where segment 0 goes on after the tree
const int tsr_st_left = 2;  // 16-bit words
const int tsr_st_nodes = 3;
const int tsr_st_damaged = 4; // 0: sound; else a bit for what was wrong
const int tsr_st_levels = 5;  // coefficients of the tile
const int tsr_block_words = 5;
const int tsr_k_place = 0; // origin, see tsr_place_*
const int tsr_k_shape = 1;
const int tsr_k_first = 2; // its first level, counted in its segment
const int tsr_k_counts = 3; // of planes 0 to 2 | of plane 3 << 16
const int tsr_k_rest = 4;   // colour | largest ks << 8 | largest kt << 16 | segment of the tile << 24
// A place: the origin in the tile or its base picture, 7 bits of u and v and 5 of s and t. Where each begins.
const int tsr_place_v = 7;
const int tsr_place_s = 14;
const int tsr_place_t = 19;
const uint tsr_place_mask = 0xFFFFFFu;
const int tsr_max_shapes = 1024; // of a file, which the host sees to
// An item is a run of positions of one block: tile << 12 | block, then its first position and the
// number of positions << 16. Every item but a block's last covers 64 texels or more, so a tile has at
// most its blocks + (409,092 - blocks) / 64, with those of a base picture.
const int tsr_max_items = 10496;
const int tsr_item_words = 2;

const uint tsr_damage_tree = 1u;
const uint tsr_damage_segments = 2u;
const uint tsr_damage_levels = 4u;
const uint tsr_damage_end = 8u;
const uint tsr_damage_corrections = 16u;

// The values of a tile, for its blocks to copy and for the filter: texels t, s, v, u with u fastest, once for
// planes 0 and 1 (16 bits each, plane 0 low) and again for planes 2 and 3; halves: once a plane.

// ---- Binding 3, coefficients: sorted by t, s, v, u frequency, four words each: frequency, planes 0..2.

// ---- Page table of the sampler: a slot of the tile cache, or one of these.
const uint tsr_page_missing = 0xFFFFFFFFu;
const uint tsr_page_background = 0xFFFFFFFEu;

#endif
