// A tile cache: the page table says where a tile is, and sampling marks the tiles that it touches.
layout(std430, binding = TESSERA_BINDING_MARKS) restrict buffer TesseraMarks { uint tsr_marks[]; };

// Every invocation writes the same word, so the order does not matter; most find it written.
void tsr_mark(uint tile) {
    if (tsr_marks[tile] == 0u)
        tsr_marks[tile] = 1u;
}

void tsr_mark_all(uvec4 tiles) {
    tsr_mark(tiles.x);
    tsr_mark(tiles.y);
    tsr_mark(tiles.z);
    tsr_mark(tiles.w);
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

// Where the place lies among the coarse texels of an axis, counted over all its tiles, of which each has
// `parts`. `axis`: the word of a texel; the place is `beyond` texels after its centre.
float tsr_coarse_place(uint axis, float beyond, int parts, uint tiles) {
    float inside = (float(tsr_axis_place(axis)) + 0.5 + beyond) / float(tsr_axis_extent(axis));
    float place = (float(tsr_axis_tile(axis)) + inside) * float(parts) - 0.5;
    return clamp(place, 0.0, float(int(tiles) * parts - 1));
}

vec4 tsr_coarse_places(TsrColumn c, uint s, uint t, vec2 beyond) {
    return vec4(tsr_coarse_place(c.u, 0.0, tsr_coarse_uv, tsr_parameter(tsr_p_tiles)),
                tsr_coarse_place(c.v, 0.0, tsr_coarse_uv, tsr_parameter(tsr_p_tiles + 1)),
                tsr_coarse_place(s, beyond.x, tsr_coarse_st, tsr_parameter(tsr_p_tiles + 2)),
                tsr_coarse_place(t, beyond.y, tsr_coarse_st, tsr_parameter(tsr_p_tiles + 3)));
}

vec4 tsr_coarse_texel(ivec4 at) {
    uint tile = uint(at.w / tsr_coarse_st);
    tile = tile * tsr_parameter(tsr_p_tiles + 2) + uint(at.z / tsr_coarse_st);
    tile = tile * tsr_parameter(tsr_p_tiles + 1) + uint(at.y / tsr_coarse_uv);
    tile = tile * tsr_parameter(tsr_p_tiles) + uint(at.x / tsr_coarse_uv);
    int cell = (at.w % tsr_coarse_st * tsr_coarse_st + at.z % tsr_coarse_st) * tsr_coarse_uv;
    cell = (cell + at.y % tsr_coarse_uv) * tsr_coarse_uv + at.x % tsr_coarse_uv;
    uint word = tsr_parameter(tsr_p_coarse_at) + (tile * uint(tsr_coarse_texels) + uint(cell)) * 2u;
    return tsr_unpack(tsr_sampler[word], tsr_sampler[word + 1u]);
}

// The coarse texel nearest to a texel, or the background where there are none.
vec4 tsr_coarse_nearest(TsrColumn c, uint s, uint t) {
    if (tsr_parameter(tsr_p_has_coarse) == 0u)
        return tsr_background();
    return tsr_coarse_texel(ivec4(tsr_coarse_places(c, s, t, vec2(0.0)) + vec4(0.5)));
}

// The linear mix of coarse texels `beyond` texels after s and t.
vec4 tsr_coarse(TsrColumn c, uint s, uint t, vec2 beyond) {
    if (tsr_parameter(tsr_p_has_coarse) == 0u)
        return tsr_background();
    vec4 place = tsr_coarse_places(c, s, t, beyond);
    ivec4 low = ivec4(place);
    vec4 weight = place - vec4(low);
    vec4 sum = vec4(0.0);
    // A place at the last texel has weight 0 beyond it: texels are added only where they count.
    for (int i = 0; i < 16; ++i) {
        bvec4 high = bvec4((i & 1) != 0, (i & 2) != 0, (i & 4) != 0, (i & 8) != 0);
        vec4 w = mix(vec4(1.0) - weight, weight, vec4(high));
        float share = w.x * w.y * w.z * w.w;
        if (share > 0.0)
            sum += share * tsr_coarse_texel(low + ivec4(high));
    }
    return sum;
}

// One texel, its tile marked.
vec4 tsr_cached(TsrColumn c, uint s, uint t) {
    uint tile = tsr_tile_of(c, s, t);
    tsr_mark(tile);
    uint page = tsr_page(tile);
    if (page == tsr_page_background)
        return tsr_background();
    if (page == tsr_page_missing)
        return tsr_coarse_nearest(c, s, t);
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
    uint tile_s = tsr_tile_of(c, s1, t0);
    uint tile_t = tsr_tile_of(c, s0, t1);
    uint tile_st = tsr_tile_of(c, s1, t1);
    if (page == tsr_page_missing) {
        tsr_mark_all(uvec4(tile, tile_s, tile_t, tile_st));
        return tsr_coarse(c, s0, t0, tsr_beyond(f));
    }
#ifdef TESSERA_HARDWARE_FILTER
    // Across a border: the tile's own copy of its neighbours' first texels, once all are there.
    if (page < tsr_page_background && tsr_page(tile_s) != tsr_page_missing &&
        tsr_page(tile_t) != tsr_page_missing && tsr_page(tile_st) != tsr_page_missing) {
        tsr_mark_all(uvec4(tile, tile_s, tile_t, tile_st));
        return tsr_filtered(tsr_cache_pixel(page, c, s0, t0), f);
    }
#endif
    return tsr_mix4(tsr_cached(c, s0, t0), tsr_cached(c, s1, t0), tsr_cached(c, s0, t1),
                    tsr_cached(c, s1, t1), f.weight);
}
