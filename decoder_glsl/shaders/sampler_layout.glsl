// The words of the sampler's buffer: sizes, page table and coarse texels. Shared by shaders and host.
#ifndef TSR_SAMPLER_LAYOUT
#define TSR_SAMPLER_LAYOUT

const int tsr_p_size = 0;       // texels along u, v, s, t
const int tsr_p_tiles = 4;      // tiles along u, v, s, t
const int tsr_p_fold_u = 8;     // of a plain texture: angular images side by side in a layer
const int tsr_p_fold_v = 9;
const int tsr_p_folds_u = 10;   // layers side by side
const int tsr_p_columns = 11;   // of a cache: slots side by side in a layer
const int tsr_p_rows = 12;
const int tsr_p_slot_width = 13; // pixels
const int tsr_p_slot_height = 14;
const int tsr_p_stride_s = 15; // pixels from one angular image to the next
const int tsr_p_stride_t = 16;
const int tsr_p_half = 17;       // 1: half floats
const int tsr_p_background = 18; // two words, packed as texels are
const int tsr_p_coarse_at = 20;  // word of the coarse texels, two a texel
const int tsr_p_has_coarse = 21;
const int tsr_p_width = 22; // pixels of a layer
const int tsr_p_height = 23;
const int tsr_p_pages = 32; // the page table

// A coarse tile has this many texels along u and v, and along s and t.
const int tsr_coarse_uv = 4;
const int tsr_coarse_st = 2;
const int tsr_coarse_texels = 64;

// Directory of a texture that is sampled from its coefficients: two words a tile (its first node, its
// first block record), then nodes and block records (layout.glsl).
const int tsr_d_words = 2;

#endif
