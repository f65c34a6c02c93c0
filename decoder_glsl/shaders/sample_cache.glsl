// A tile cache: the page table says where a tile is, and sampling marks the tiles that it touches.
layout(std430, binding = TESSERA_BINDING_MARKS) restrict buffer TesseraMarks { uint tsr_marks[]; };

// Every invocation writes the same word, so the order does not matter; most find it written.
void tsr_mark(uint tile) {
    if (tsr_marks[tile] == 0u)
        tsr_marks[tile] = 1u;
}

// A surface texel among the tiles: the part of a tile's number and of a pixel that u and v give.
struct TsrColumn {
    uint u; // words of the axes
    uint v;
    uint tile;
    ivec2 pixel;
};

TsrColumn tsr_column(ivec2 texel) {
    TsrColumn c;
    c.u = tsr_axis(0, texel.x);
    c.v = tsr_axis(1, texel.y);
    c.tile = uint(tsr_axis_tile(c.v)) * tsr_parameter(tsr_p_tiles) + uint(tsr_axis_tile(c.u));
    c.pixel = ivec2(tsr_axis_place(c.u) * int(tsr_parameter(tsr_p_stride_s)),
                    tsr_axis_place(c.v) * int(tsr_parameter(tsr_p_stride_t)));
    return c;
}

// Number of the tile, from the words of the axes of s and t.
uint tsr_tile_of(TsrColumn c, uint s, uint t) {
    uint angular = uint(tsr_axis_tile(t)) * tsr_parameter(tsr_p_tiles + 2) + uint(tsr_axis_tile(s));
    return angular * tsr_parameter(tsr_p_tiles) * tsr_parameter(tsr_p_tiles + 1) + c.tile;
}

uint tsr_page(uint tile) {
    return tsr_sampler[tsr_parameter(tsr_p_page_at) + tile];
}

ivec3 tsr_cache_pixel(uint page, TsrColumn c, uint s, uint t) {
    return ivec3(int(page & 1023u) * int(tsr_parameter(tsr_p_slot_width)) + c.pixel.x +
                     tsr_axis_place(s),
                 int((page >> 10) & 1023u) * int(tsr_parameter(tsr_p_slot_height)) + c.pixel.y +
                     tsr_axis_place(t),
                 int(page >> 20));
}

vec4 tsr_background() {
    return tsr_unpack(tsr_parameter(tsr_p_background), tsr_parameter(tsr_p_background + 1));
}

// The mean over a part of the tile, or the background where there are no coarse texels.
vec4 tsr_coarse(TsrColumn c, uint s, uint t, uint tile) {
    if (tsr_parameter(tsr_p_has_coarse) == 0u)
        return tsr_background();
    int part_u = tsr_axis_place(c.u) * tsr_coarse_uv / tsr_axis_extent(c.u);
    int part_v = tsr_axis_place(c.v) * tsr_coarse_uv / tsr_axis_extent(c.v);
    int part_s = tsr_axis_place(s) * tsr_coarse_st / tsr_axis_extent(s);
    int part_t = tsr_axis_place(t) * tsr_coarse_st / tsr_axis_extent(t);
    int cell = ((part_t * tsr_coarse_st + part_s) * tsr_coarse_uv + part_v) * tsr_coarse_uv + part_u;
    uint word = tsr_parameter(tsr_p_coarse_at) + (tile * uint(tsr_coarse_texels) + uint(cell)) * 2u;
    return tsr_unpack(tsr_sampler[word], tsr_sampler[word + 1u]);
}

// One texel, its tile marked.
vec4 tsr_cached(TsrColumn c, uint s, uint t) {
    uint tile = tsr_tile_of(c, s, t);
    tsr_mark(tile);
    uint page = tsr_page(tile);
    if (page == tsr_page_background)
        return tsr_background();
    if (page == tsr_page_missing)
        return tsr_coarse(c, s, t, tile);
    return texelFetch(tsr_texels, tsr_cache_pixel(page, c, s, t), 0);
}

vec4 tsr_angular_image(ivec2 texel, TsrAngularFootprint f) {
    TsrColumn c = tsr_column(texel);
    uint s0 = tsr_axis(2, f.low.x);
    uint s1 = tsr_axis(2, f.high.x);
    uint t0 = tsr_axis(3, f.low.y);
    uint t1 = tsr_axis(3, f.high.y);
    uint tile = tsr_tile_of(c, s0, t0);
    uint page = tsr_page(tile);
    bool inside = ((s0 ^ s1) & 0xFFFFu) == 0u && ((t0 ^ t1) & 0xFFFFu) == 0u;
    // Inside one tile, all four texels are one lookup away.
    if (inside && page < tsr_page_background) {
        tsr_mark(tile);
#ifdef TESSERA_HARDWARE_FILTER
        return tsr_filtered(tsr_cache_pixel(page, c, s0, t0), f);
#else
        return tsr_fetched(tsr_cache_pixel(page, c, s0, t0), f);
#endif
    }
#ifdef TESSERA_HARDWARE_FILTER
    // Across a border: the tile's own copy of its neighbours' first texels, once all are there.
    uint tile_s = tsr_tile_of(c, s1, t0);
    uint tile_t = tsr_tile_of(c, s0, t1);
    uint tile_st = tsr_tile_of(c, s1, t1);
    if (page < tsr_page_background && tsr_page(tile_s) != tsr_page_missing &&
        tsr_page(tile_t) != tsr_page_missing && tsr_page(tile_st) != tsr_page_missing) {
        tsr_mark(tile);
        tsr_mark(tile_s);
        tsr_mark(tile_t);
        tsr_mark(tile_st);
        return tsr_filtered(tsr_cache_pixel(page, c, s0, t0), f);
    }
#endif
    return tsr_mix4(tsr_cached(c, s0, t0), tsr_cached(c, s1, t0), tsr_cached(c, s0, t1),
                    tsr_cached(c, s1, t1), f.weight);
}
