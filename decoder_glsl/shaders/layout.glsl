// The decoder's memory layout, in 32-bit words, and other numbers that shaders and host share. GLSL
// includes this file, and C++ does too (shader_layout.h).
#ifndef TSR_LAYOUT
#define TSR_LAYOUT

#ifdef __cplusplus
#define TSR_SHARED inline // C++ includes the functions of this file in several sources
#else
#define TSR_SHARED
#endif

// Invocations per group. These are macros because GLSL ES accepts no constants in layout
// qualifiers.
#define TSR_STREAM_GROUP 16 // tree, corrections
// Tiles are few and their streams long: small groups of segments spread over more processors and
// wait less for each other's branches.
#define TSR_LEVELS_GROUP 4
#define TSR_TEXEL_GROUP 64 // order, items, texels, border, filter
// A dispatch has at most this many groups along x, because devices need not accept more than
// 65,535.
const int tsr_row_groups = 1024;

// ---- Limits of the format (FORMAT.md 3.1).
const int tsr_max_blocks = 4096;
const int tsr_max_nodes = 8192;
const int tsr_max_work = 16000;
const int tsr_max_coded = 4096;
const int tsr_max_tile_texels = 6 * 65536;
const int tsr_max_tile_side = 256; // along u and v
const int tsr_max_block_side = 64; // likewise
const int tsr_max_base_side = 126; // of base pictures
const int tsr_max_angular_side = 32;
const int tsr_max_frequencies = 32;    // coded along an axis
const int tsr_max_sine_side = 32;      // of blocks with a transform symbol
const int tsr_correction_chunk = 4096; // texels
const int tsr_rotations = 49;          // of a block's colours
const int tsr_most_share = 64;         // of luma in a chroma plane
const int tsr_directions = 32;         // of predictions from the border
const int tsr_base_taps = 6;           // of the base picture's filter

// ---- Contexts of the entropy decoder (format/tile/code_tables.h).
const int tsr_depth_classes = 6; // of each pair of axes; the last class holds all deeper nodes
const int tsr_size_classes = 9;
const int tsr_neighbour_classes = 16;
const int tsr_cross_classes = 6;
const int tsr_zero_positions = 6;
const int tsr_zero_rows = 1 + tsr_cross_classes; // plane 0; the other planes by cross class
// Magnitude tables of one quantiser: plane 0 by neighbours, its DC by size class; the other planes
// by half the neighbours and by cross class, where the first three share one, and their DC by size
// class.
const int tsr_magnitude_crosses = tsr_cross_classes - 2;
const int tsr_first_magnitude_dc = tsr_neighbour_classes;
const int tsr_other_magnitudes = tsr_first_magnitude_dc + tsr_size_classes;
const int tsr_other_magnitude_dc =
    tsr_other_magnitudes + tsr_neighbour_classes / 2 * tsr_magnitude_crosses;
const int tsr_magnitude_tables = tsr_other_magnitude_dc + tsr_size_classes;

// ---- Binding 0, tables: one set per file, read only. Single words come first.
const int tsr_t_sample_type = 0; // 0 unorm8, 1 half16
const int tsr_t_planes = 1;      // 1..4
const int tsr_t_colour = 2;      // 1: YCoCg-R
const int tsr_t_rotates = 3;     // 1: blocks may rotate their colours
const int tsr_t_background = 4;  // four planes, signed
const int tsr_t_fraction = 8;    // bits of a transform output below a code
const int tsr_t_correction_step = 9;   // 2 E + 1
const int tsr_t_offsets = 10;          // plane 0: magnitude 1, larger; the other planes: the same
const int tsr_t_background_texel = 14; // two words: the texel as it is stored, see tsr_samples
const int tsr_t_dependent = 16;        // 1: dependent quantisation
const int tsr_t_shapes = 17;           // word of the first shape record
const int tsr_t_predicts = 18;         // 1: leaves of split trees are followed by predictions
const int tsr_t_smooth = 19;           // 1: smooth copies
const int tsr_t_filtered = 20;         // 1: the file has a filter
const int tsr_t_base_pictures = 21;    // 1: tiles may have a base picture
const int tsr_t_base_margin = 22;      // texels
const int tsr_t_any_plane = 23;        // 1: transform symbols also follow planes 1 to 3
const int tsr_t_plane_trees = 24;      // 1: each of two planes may have a split tree of its own
const int tsr_t_fields = 25;           // number of these words

// Probability tables hold the starts of their symbols in pairs, c[1] | c[2] << 16 and so on, padded
// with 4096: one word where there are at most three symbols, two where there are at most five, and
// tsr_symbol_words elsewhere.
const int tsr_symbol_words = 12;
const int tsr_symbol5_words = 2;
const int tsr_symbol7_words = 3;

// Each line gives the first word of a table and the word behind its last. A table begins where the
// one above it ends: to add one, insert its line and let the next line begin at its end.

// Frequencies of zero coefficients, one word each: [copies][quantiser][row][position][neighbours].
const int tsr_t_zero = tsr_t_fields,
    tsr_zero_end = tsr_t_zero + 4 * tsr_zero_rows * tsr_zero_positions * tsr_neighbour_classes;
// Tokens of magnitudes: [copies][quantiser][table].
const int tsr_t_magnitude = tsr_zero_end,
    tsr_magnitude_end = tsr_t_magnitude + 4 * tsr_magnitude_tables * tsr_symbol_words;
// Length tokens of plane 0 by size class, of blocks that copy nothing and of blocks that copy; of
// the other planes by plane 0's token.
const int tsr_t_first_length = tsr_magnitude_end,
    tsr_first_length_end = tsr_t_first_length + tsr_size_classes * tsr_symbol_words;
const int tsr_t_copying_length = tsr_first_length_end,
    tsr_copying_length_end = tsr_t_copying_length + tsr_size_classes * tsr_symbol_words;
const int tsr_t_other_length = tsr_copying_length_end,
    tsr_other_length_end = tsr_t_other_length + 14 * tsr_symbol_words;
// Tokens of corrections, by context.
const int tsr_t_correction = tsr_other_length_end,
    tsr_correction_end = tsr_t_correction + 21 * tsr_symbol_words;
// Splits, two words each: [spatial depth class][angular depth class].
const int tsr_t_split = tsr_correction_end,
    tsr_split_end = tsr_t_split + tsr_depth_classes * tsr_depth_classes * tsr_symbol5_words;
// Kinds of a block's colour, two words each: [the previous block: plain, rotated, predicted].
const int tsr_t_kind = tsr_split_end, tsr_kind_end = tsr_t_kind + 3 * tsr_symbol5_words;
// Lengths of differences of shares: [Co, Cg].
const int tsr_t_share = tsr_kind_end, tsr_share_end = tsr_t_share + 2 * tsr_symbol_words;
// Predictions, one word each, by context.
const int tsr_t_prediction = tsr_share_end, tsr_prediction_end = tsr_t_prediction + 6;
// Kinds of displacements, one word each: [along s, along t]. Then their lengths: [along the
// parallax, across it].
const int tsr_t_displacement_kind = tsr_prediction_end,
    tsr_displacement_kind_end = tsr_t_displacement_kind + 2;
const int tsr_t_displacement = tsr_displacement_kind_end,
    tsr_displacement_end = tsr_t_displacement + 2 * tsr_symbol_words;
// Whether a tile has a base picture, one word; whether a block copies it, one word each: [the
// previous block copied it]; lengths of its displacements.
const int tsr_t_base = tsr_displacement_end, tsr_base_end = tsr_t_base + 1;
const int tsr_t_from_base = tsr_base_end, tsr_from_base_end = tsr_t_from_base + 2;
const int tsr_t_base_displacement = tsr_from_base_end,
    tsr_base_displacement_end = tsr_t_base_displacement + tsr_symbol_words;
// Modes of blocks of pictures, by context.
const int tsr_mode_contexts = 9;
const int tsr_t_mode = tsr_base_displacement_end,
    tsr_mode_end = tsr_t_mode + tsr_mode_contexts * tsr_symbol_words;
// Transforms of blocks of pictures, three words each, by context.
const int tsr_transform_contexts = 12;
const int tsr_t_transform = tsr_mode_end,
    tsr_transform_end = tsr_t_transform + tsr_transform_contexts * tsr_symbol7_words;
// Colour rotations, signed: [rotation][row][column].
const int tsr_t_rotation = tsr_transform_end,
    tsr_rotation_end = tsr_t_rotation + tsr_rotations * 9;
// The base picture's filter, signed: [displacement mod 8][tap].
const int tsr_t_base_filter = tsr_rotation_end,
    tsr_base_filter_end = tsr_t_base_filter + 8 * tsr_base_taps;
// Directions of predictions from the border, one word each: slope, as 16 bits | inverse << 16.
const int tsr_t_direction = tsr_base_filter_end,
    tsr_direction_end = tsr_t_direction + tsr_directions;
// The filter, slope | strength << 16: [plane][ring].
const int tsr_t_filter = tsr_direction_end, tsr_filter_end = tsr_t_filter + 4 * 3;
// The cosine basis b(n, k, x), signed (tsr_basis_of): n * n words for each n up to 32, then 32 n
// words for each n up to 64, because only 32 frequencies are coded.
const int tsr_t_basis = tsr_filter_end,
    tsr_basis_end = tsr_t_basis + tsr_max_frequencies * (tsr_max_frequencies + 1) *
                                      (2 * tsr_max_frequencies + 1) / 6;
const int tsr_t_wide_basis = tsr_basis_end,
    tsr_wide_basis_end =
        tsr_t_wide_basis + tsr_max_frequencies / 2 *
                               (tsr_max_block_side * (tsr_max_block_side + 1) -
                                tsr_max_frequencies * (tsr_max_frequencies + 1));
// The sine basis s(n, k, x), signed (tsr_sine_basis_of): n * n words for each n up to 32.
const int tsr_t_sine_basis = tsr_wide_basis_end,
    tsr_sine_basis_end = tsr_t_sine_basis + (tsr_basis_end - tsr_t_basis);
const int tsr_t_end = tsr_sine_basis_end; // the shape records and their scans follow

// A shape record.
const int tsr_s_sides = 0; // nu | nv << 9 | ns << 18 | nt << 24
const int tsr_s_scan = 1;  // word of its first scan entry; 0 if no tile has needed it yet
const int tsr_s_coded = 2; // number of scan entries
const int tsr_s_size_class = 3;
// 16-bit shapes, 0xFFFF for none: four each of splits 1 (along u and v) and 2 (along s and t), two
// each of splits 3 (along u) and 4 (along v).
const int tsr_s_children = 4;
const int tsr_s_scales = 10; // [planes 0..3, rotated][axes 0..4] mantissa | exponent + 128 << 16
const int tsr_scales_of_set = 5;
const int tsr_shape_words = tsr_s_scales + 5 * tsr_scales_of_set;
const int tsr_max_shapes = 16384; // of a file; the host refuses files with more
// A scan entry: the frequency (5 bits each of u, v, s, t, u lowest); six words of 16-bit scan
// indices of the 12 earlier neighbours, first the four that count double, its own index where there
// is none; its share | position << 16 (ScanContext in format/tile/scan_order.h).
const int tsr_scan_context = 7;
const int tsr_scan_words = 8;

// ---- Binding 1, batch: what to decode, and the payloads; read only. The header comes first.
const int tsr_b_tiles = 0;
const int tsr_b_raw_chunks = 1;
const int tsr_b_corrections = 2;
const int tsr_b_tile_at = 3; // words where the records begin
const int tsr_b_segment_at = 4;
const int tsr_b_raw_chunk_at = 5; // the segment of each raw chunk
const int tsr_b_correction_at = 6;
const int tsr_b_copies_at = 7; // what the blocks of predicted tiles copy
const int tsr_b_borders_at = 8; // blocks that are predicted from their border
const int tsr_b_payload_at = 9;
const int tsr_b_payload_bytes = 10;
const int tsr_b_fold_u = 11; // where texels go: see tsr_place in target.glsl
const int tsr_b_fold_v = 12;
const int tsr_b_folds_u = 13;
const int tsr_b_stride_s = 14;
const int tsr_b_stride_t = 15;
const int tsr_b_blocks_at = 16; // words of the work buffer, up to tsr_b_values_at
const int tsr_b_items_at = 17;
const int tsr_b_counts_at = 18; // number of raw levels that each segment has
const int tsr_b_multipliers_at = 19;
const int tsr_b_raw_at = 20;    // raw levels, tsr_raw_words each
const int tsr_b_values_at = 21; // values that tiles keep
const int tsr_b_items_room = 22; // items that fit
const int tsr_batch_words = 23;

const int tsr_tile_shape = 0;
const int tsr_tile_segment = 1; // its first one
const int tsr_tile_segments = 2;
const int tsr_tile_x = 3; // pixel of its first texel
const int tsr_tile_y = 4;
const int tsr_tile_layer = 5;
const int tsr_tile_origin = 6; // u | v << 16 of its first texel, if layers are folded
const int tsr_tile_multipliers = 7; // word of its corrections, from tsr_b_multipliers_at; or none
const int tsr_tile_blocks = 8;      // number of its first block record
const int tsr_tile_block_room = 9;  // records
const int tsr_tile_copies = 10; // first copy record, from tsr_b_copies_at; none: not predicted
const int tsr_tile_values = 11; // word of its values, from tsr_b_values_at; or none
const int tsr_tile_base = 12;   // shape of its base picture; or none
const int tsr_tile_stored = 13; // payload byte of a stored tile's first sample; or none
const int tsr_tile_borders = 14; // its border list, from tsr_b_borders_at; or none
const int tsr_tile_words = 15;

const int tsr_seg_tile = 0;
const int tsr_seg_byte = 1;  // of the payload area
const int tsr_seg_size = 2;  // 16-bit words
const int tsr_seg_first = 3; // first block
const int tsr_seg_end = 4;   // one past its last block; tsr_none: all remaining blocks
const int tsr_seg_raw = 5;   // its first raw level and its first sorted coefficient
const int tsr_seg_room = 6;  // raw levels that fit
const int tsr_segment_words = 7;

const int tsr_correction_tile = 0;
const int tsr_correction_byte = 1; // of the payload area
const int tsr_correction_size = 2; // 16-bit words
const int tsr_correction_number = 3; // of the chunk in its tile
const int tsr_correction_words = 4;

// A copy record, one per block of a predicted tile (FORMAT.md 4.6): what it copies (0 nothing, 1
// along s, 2 along t, 3 the base picture) | depth << 8 | displacement as signed bytes u << 16 | v
// << 24, in half texels or, from the base picture, in eighths. A block of the base picture itself
// has 4 | fineness << 16. A block of a picture has the context of its mode << 4. If the mode is
// above 0 it also has 8 and, << 24, 1 + the context of its transform, or 0 if it has no transform
// symbol. Where each plane has a split tree of its own, all blocks have 4096, and those of plane 0
// have 4 as well: the tree of plane 0 is kept like that of a base picture with the tile's sides.
const int tsr_copy_words = 1;
const uint tsr_copy_of_base = 4u;
const uint tsr_copy_of_border = 8u;
const uint tsr_copy_one_plane = 4096u;
const int tsr_copy_transform = 24;

// A border list: the blocks of a picture that are predicted from their border, in an order in which
// each comes after the blocks that it needs. It has the number of steps; for each step the number
// of blocks up to its end, where a step needs only blocks of earlier steps; and a record per block.
const int tsr_border_block = 0; // block | mode << 12
const int tsr_border_texels = 1; // of the border that exist: above | to the left << 8
const int tsr_border_words = 2;

const uint tsr_none = 0xFFFFFFFFu;
const uint tsr_nowhere = 0xF0000000u; // a word behind the end of any buffer

// ---- Binding 2, work: what the passes hand to each other.
const int tsr_w_groups = 0; // three words: arguments of the indirect dispatch of texels.comp
const int tsr_w_items = 3;  // number of items so far
const int tsr_w_wave = 4;   // depth of copies of the next wave
const int tsr_w_ready = 5;  // number of items of the wave that texels.comp works on
const int tsr_w_state = 6;  // the tile states; the batch header places what follows them

const int tsr_st_blocks = 0;
const int tsr_st_rans = 1; // entropy state of segment 0 behind the tree
const int tsr_st_left = 2; // 16-bit words
const int tsr_st_nodes = 3;
const int tsr_st_damaged = 4; // 0: sound; else the sum of tsr_damage_*
const int tsr_st_levels = 5;  // coefficients of the tile that are not 0
const int tsr_state_words = 6;

const uint tsr_damage_tree = 1u;
const uint tsr_damage_segments = 2u;
const uint tsr_damage_levels = 4u;
const uint tsr_damage_end = 8u;
const uint tsr_damage_corrections = 16u;

const int tsr_k_place = 0; // origin, see tsr_place_v
const int tsr_k_shape = 1;
const int tsr_k_first = 2;  // its first level, counted in its segment
const int tsr_k_counts = 3; // levels of planes 0 to 2 | of plane 3 << 16
// tsr_sines_u and so on | largest ks << 8 | largest kt << 16 | segment of tile << 24
const int tsr_k_rest = 4;
// The axes of a block that have sines, and those without a transform. The others have cosines.
const uint tsr_sines_u = 1u;
const uint tsr_sines_v = 2u;
const uint tsr_plain_u = 4u;
const uint tsr_plain_v = 8u;
const uint tsr_axes_mask = 15u;
// 0 plain; rotation + 1; or tsr_colour_shares | shares of Co and Cg as signed bytes << 16, << 24.
const int tsr_k_colour = 5;
const int tsr_block_words = 6;
const uint tsr_colour_shares = 256u;
// The origin of a block in its tile or base picture, in one word: u, and from these bits on v, s,
// t.
const int tsr_place_v = 8;
const int tsr_place_s = 16;
const int tsr_place_t = 21;
const uint tsr_place_mask = 0x3FFFFFFu;
// Depths of the root of a base picture's split tree (TsrNode): no spatial splits, and more angular
// ones than a tile can have.
const uint tsr_depths_of_base = 0x100000u;

// A raw level: frequency << 12 | block, then magnitude | sign << 20 | plane << 30.
const int tsr_raw_words = 2;
const int tsr_raw_chunk = 64; // segments begin at multiples of this

// An item is a run of positions (u, v) of one block: tile << 12 | block, then its first position |
// number of positions << 16.
const int tsr_item_words = 2;
// Every item but a block's last covers 64 texels or more (tsr_item_positions).
const int tsr_max_items =
    tsr_max_blocks + (tsr_max_tile_texels + tsr_max_base_side * tsr_max_base_side) / 64;

// A group of texels.comp holds the values of its item before and after the pass along s.
const int tsr_patch_words = 8192; // of shared memory, 32 KiB

// The number of positions in an item, 1..64, for a block of ns texels along s whose coefficients
// have that many frequencies along s and t. One position always fits: 4 * 32 * (32 + 32) = 8192.
TSR_SHARED int tsr_item_positions(int planes, int frequencies_s, int frequencies_t, int ns) {
    int fit = tsr_patch_words / (planes * frequencies_t * (frequencies_s + ns));
    // 64 invocations share the positions: 33 to 51 would leave at least a fifth of them idle.
    if (fit > 32 && fit < 52)
        return 32;
    return fit > TSR_TEXEL_GROUP ? TSR_TEXEL_GROUP : (fit < 1 ? 1 : fit);
}

// The kept values of a tile, which its blocks copy and the filter reads: one word for planes 0 and
// 1 (16 bits each, plane 0 low) of every texel t, s, v, u with u fastest, then the same for planes
// 2 and 3. Values of halves take one word per plane.

// ---- Binding 3, coefficients, sorted by t, s, v, u frequency: four words each, the frequency and
// planes 0..2.

#endif
