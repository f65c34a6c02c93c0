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

vec4 tsr_angular_texel(ivec2 texel, ivec2 angle) {
    return tsr_cached(tsr_column(texel), tsr_axis(2, angle.x), tsr_axis(3, angle.y));
}

// Where an angular image is read: words of the axes of s and t, low and high.
struct TsrAngle {
    uint s0;
    uint s1;
    uint t0;
    uint t1;
};

TsrAngle tsr_angle(TsrAngularFootprint f) {
    TsrAngle a;
    a.s0 = tsr_axis(2, f.low.x);
    a.s1 = tsr_axis(2, f.high.x);
    a.t0 = tsr_axis(3, f.low.y);
    a.t1 = tsr_axis(3, f.high.y);
    return a;
}

// The tile of a surface texel's image where all of it lies in one tile, else tsr_no_tile.
const uint tsr_no_tile = 0xFFFFFFFFu;
uint tsr_only_tile(TsrColumn c, TsrAngle a) {
    bool inside = ((a.s0 ^ a.s1) & 0xFFFFu) == 0u && ((a.t0 ^ a.t1) & 0xFFFFu) == 0u;
    return inside ? tsr_tile_of(c, a.s0, a.t0) : tsr_no_tile;
}

// The image of a surface texel, of tiles that may not be there.
vec4 tsr_image_in_parts(TsrColumn c, TsrAngle a, TsrAngularFootprint f) {
    uint tile = tsr_tile_of(c, a.s0, a.t0);
    uint page = tsr_page(tile);
    bool missing = page == tsr_page_missing;
    bool there = page < tsr_page_background;
#ifdef TESSERA_HARDWARE_FILTER
    // Across a border: the tile's own copy of its neighbours' first texels, once all are there.
    for (int k = 1; k < 4; ++k) {
        uint other = tsr_tile_of(c, (k & 1) != 0 ? a.s1 : a.s0, (k & 2) != 0 ? a.t1 : a.t0);
        if (other == tile)
            continue;
        tsr_mark(other);
        there = there && tsr_page(other) != tsr_page_missing;
    }
#else
    there = there && tsr_only_tile(c, a) != tsr_no_tile;
#endif
    if (there) {
        tsr_mark(tile);
        return tsr_mixed(tsr_cache_pixel(page, c, a.s0, a.t0), f);
    }
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        bool after_s = (k & 1) != 0;
        bool after_t = (k & 2) != 0;
        uint s = after_s ? a.s1 : a.s0;
        uint t = after_t ? a.t1 : a.t0;
        if (missing)
            tsr_mark(tsr_tile_of(c, s, t));
        else
            sum += (after_s ? f.weight.x : 1.0 - f.weight.x) *
                   (after_t ? f.weight.y : 1.0 - f.weight.y) * tsr_cached(c, s, t);
    }
    return missing ? tsr_coarse(c, a.s0, a.t0, tsr_beyond(f)) : sum;
}

// The four surface texels' images, mixed. Most pixels lie in one tile: one page is looked up for them and
// one tile marked. The rest is done in a loop, which is left at once where nothing is to do: where an if
// costs the time of both its sides, as on llvmpipe, this is three times as fast.
vec4 tsr_four_images(TsrSurfaceFootprint f, TsrAngularFootprint low_low,
                     TsrAngularFootprint high_low, TsrAngularFootprint low_high,
                     TsrAngularFootprint high_high) {
    TsrColumn c0 = tsr_column(f.low);
    TsrColumn c1 = tsr_column(ivec2(f.high.x, f.low.y));
    TsrColumn c2 = tsr_column(ivec2(f.low.x, f.high.y));
    TsrColumn c3 = tsr_column(f.high);
    TsrAngle a0 = tsr_angle(low_low);
    TsrAngle a1 = tsr_angle(high_low);
    TsrAngle a2 = tsr_angle(low_high);
    TsrAngle a3 = tsr_angle(high_high);
    uint tile = tsr_only_tile(c0, a0);
    bool together = tile != tsr_no_tile && tile == tsr_only_tile(c1, a1) &&
                    tile == tsr_only_tile(c2, a2) && tile == tsr_only_tile(c3, a3);
    vec4 sum = vec4(0.0);
    int left = 0; // the first that is not in `sum`
    if (together) {
        uint page = tsr_page(tile);
        if (page < tsr_page_background) {
            sum = tsr_mix4(tsr_mixed(tsr_cache_pixel(page, c0, a0.s0, a0.t0), low_low),
                           tsr_mixed(tsr_cache_pixel(page, c1, a1.s0, a1.t0), high_low),
                           tsr_mixed(tsr_cache_pixel(page, c2, a2.s0, a2.t0), low_high),
                           tsr_mixed(tsr_cache_pixel(page, c3, a3.s0, a3.t0), high_high),
                           f.weight);
        } else if (page == tsr_page_background) {
            sum = tsr_background();
        }
        if (page != tsr_page_missing) {
            tsr_mark(tile);
            left = 4;
        }
    }
    for (int k = left; k < 4; ++k) {
        bool high_u = (k & 1) != 0;
        bool high_v = (k & 2) != 0;
        TsrColumn c = c0;
        TsrAngle a = a0;
        TsrAngularFootprint angles = low_low;
        if (k == 1) {
            c = c1;
            a = a1;
            angles = high_low;
        } else if (k == 2) {
            c = c2;
            a = a2;
            angles = low_high;
        } else if (k == 3) {
            c = c3;
            a = a3;
            angles = high_high;
        }
        sum += (high_u ? f.weight.x : 1.0 - f.weight.x) *
               (high_v ? f.weight.y : 1.0 - f.weight.y) * tsr_image_in_parts(c, a, angles);
    }
    return sum;
}
