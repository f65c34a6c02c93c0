// The words of the buffer that sampling reads: header, axes, page table, mips and coarse texels.
// Shared by shaders and host.
#ifndef TSR_SAMPLER_LAYOUT
#define TSR_SAMPLER_LAYOUT

// ---- The header, which shaders read as a uniform block of uvec4 as well.
const int tsr_p_size = 0;        // texels along u, v, s, t
const int tsr_p_tiles = 4;       // tiles along u, v, s, t
const int tsr_p_axis_at = 8;     // words where the axes of u and v begin
const int tsr_p_stride_s = 12;   // pixels from one angular image to the next
const int tsr_p_stride_t = 13;
const int tsr_p_folds_u = 14;    // plain texture: layers side by side
const int tsr_p_slot_width = 15; // cache: pixels of a slot
const int tsr_p_slot_height = 16;
const int tsr_p_half = 17;       // 1: half floats
const int tsr_p_background = 18; // two words, packed as texels are
const int tsr_p_coarse_at = 20;  // word of the coarse texels, two words each; 0: there are none
const int tsr_p_marks_at = 21;   // cache: word of its first tile's mark
const int tsr_p_width = 22;      // pixels of a layer
const int tsr_p_height = 23;
const int tsr_p_page_at = 24;     // word of the page table
const int tsr_p_angular_map = 25; // as FORMAT.md numbers them
const int tsr_p_mips = 26;        // mip levels of the atlas besides level 0
const int tsr_p_mip_at = 27;      // word of their table, which begins with level 0
// Cache: texels of the atlas along u and v in a slot. The mips lie behind them along u, each below
// the one before it along v.
const int tsr_p_slot_u = 28;
const int tsr_p_slot_v = 29;
const int tsr_p_inside = 30; // 1: a sphere that is seen from inside
const int tsr_p_words_at = 31; // where the words begin in a buffer of several textures
const int tsr_sampler_words = 32;

// ---- The axes of u and v have one word per texel, so that sampling needs no division:
//   cache          tile | position in the slot << 16 | longer tile << 25 | mip << 29
//   plain texture  pixel in the layer | fold << 16
// The texels of mip 1, 2, ... follow those of the atlas. Their tile is that of the texels they
// average. Along an axis of `size` texels and n tiles, a tile has size / n texels, rounded down, or
// one more if it is a longer one.
const int tsr_axis_place_at = 16; // bits
const int tsr_axis_places = 512;
const int tsr_axis_longer_at = 25; // bits
const int tsr_axis_mip_at = 29; // bits

// ---- A page is the position of a tile's slot, counted in slots: column | row << 10 | layer << 20.
// The two values below are larger than any.
const int tsr_page_row_at = 10; // bits
const int tsr_page_layer_at = 20;
const uint tsr_page_side = 1024u; // columns, and rows
const uint tsr_page_missing = 0xFFFFFFFFu;
const uint tsr_page_background = 0xFFFFFFFEu;

// ---- The table of mips.
const int tsr_mip_u = 0; // where its texels begin on the axes of u and v
const int tsr_mip_v = 1;
const int tsr_mip_size = 2;   // texels u | v << 16
const int tsr_mip_charts = 3; // word of its charts, one per texel, u fastest: a number, or 0
const int tsr_mip_halves = 4; // 1: charts are halves of words, the lower one first; 0: whole words
const int tsr_mip_words = 5;

// ---- Coarse texels of a tile along u and v, along s and t, and in all.
const int tsr_coarse_uv = 4;
const int tsr_coarse_st = 2;
const int tsr_coarse_texels = tsr_coarse_uv * tsr_coarse_uv * tsr_coarse_st * tsr_coarse_st;
const int tsr_coarse_words = 2 * tsr_coarse_texels;

// ---- Jobs of coarse.comp and mips.comp, one per tile.
const int tsr_job_words = 8;
const int tsr_coarse_job_page = 0;
const int tsr_coarse_job_word = 1; // of the tile's coarse texels, in the sampler's buffer
const int tsr_coarse_job_extent = 2; // four words
const int tsr_mip_job_page = 0; // cache only
const int tsr_mip_job_u = 1;    // the tile's first texel of the atlas
const int tsr_mip_job_v = 2;
const int tsr_mip_job_extent = 3; // u | v << 16
const int tsr_mip_job_first = 4;  // first direction in the angular images, s | t << 16
const int tsr_mip_job_count = 5;  // number of directions, s | t << 16

#endif
