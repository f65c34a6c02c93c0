// The words of the sampler's buffer: sizes, axes, page table and coarse texels. Shared by shaders and
// host.
#ifndef TSR_SAMPLER_LAYOUT
#define TSR_SAMPLER_LAYOUT

const int tsr_p_size = 0;        // texels along u, v, s, t
const int tsr_p_tiles = 4;       // tiles along u, v, s, t
const int tsr_p_axis_at = 8;     // words where the axes of u and v begin
const int tsr_p_stride_s = 12;   // pixels from one angular image to the next
const int tsr_p_stride_t = 13;
const int tsr_p_folds_u = 14;    // of a plain texture: layers side by side
const int tsr_p_slot_width = 15; // of a cache: pixels of a slot
const int tsr_p_slot_height = 16;
const int tsr_p_half = 17;       // 1: half floats
const int tsr_p_background = 18; // two words, packed as texels are
const int tsr_p_coarse_at = 20;  // word of the coarse texels, two a texel
const int tsr_p_has_coarse = 21;
const int tsr_p_width = 22; // pixels of a layer
const int tsr_p_height = 23;
const int tsr_p_page_at = 24; // word of the page table
const int tsr_p_angular_map = 25; // as FORMAT.md numbers them
const int tsr_p_mips = 26;        // mip levels of the atlas besides itself
const int tsr_p_mip_at = 27;      // word of their table, the atlas' line first
// Of a cache: texels of the atlas along u and v in a slot. Mips are behind them along u, each below the one
// before it along v.
const int tsr_p_slot_u = 28;
const int tsr_p_slot_v = 29;
const int tsr_p_inside = 30; // 1: a sphere that is seen from inside
const int tsr_sampler_words = 32;

// Each of these two axes has a word a texel, so that sampling divides nothing:
//   its tile | its place in the slot << 16 | the tile's extent - 1 << 23 | its mip << 29;
// u and v of a plain texture: its pixel in the layer | its fold << 16.
// u and v go on with the texels of mip 1, then 2, ..., whose tile is that of what they stand for.

const int tsr_axis_place_at = 16; // bits, seven
const int tsr_axis_places = 128;
const int tsr_axis_extent_at = 23; // bits, six
const int tsr_axis_mip_at = 29;

// A mip has four words: where its texels begin on the axes of u and v, its texels along u and v
// (u | v << 16), word of its charts, one a texel, u fastest: 0, or a number of the chart that it shows.
const int tsr_mip_words = 4;

// A page is where the slot of a tile lies, in slots: column | row << 10 | layer << 20; or missing or
// background (layout.glsl), which are larger than any slot's.

// A coarse tile has this many texels along u and v, and along s and t.
const int tsr_coarse_uv = 4;
const int tsr_coarse_st = 2;
const int tsr_coarse_texels = 64;

#endif
