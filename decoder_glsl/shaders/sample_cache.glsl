// Sampling a tile cache: the page table gives the slot of a tile, and sampling marks the tiles that
// it touches.
layout(std430, binding = TESSERA_BINDING_MARKS) restrict buffer TesseraMarks { uint tsr_marks[]; };

// All invocations write the same value, so their order does not matter. Most find it written
// already.
void tsr_mark(uint tile) {
    uint at = tsr_parameter(tsr_p_marks_at) + tile;
    if (tsr_marks[at] == 0u)
        tsr_marks[at] = 1u;
}

// The tiles along s (axis 2) or t (axis 3) that contain texels, and the first texels of tiles. As
// in TileGrid: floor(((x + 1) n - 1) / d) and floor(i d / n), for n tiles of d texels. Adding a
// half keeps floats away from whole numbers if d n < 2^23 / 5. Reading a table instead is slower on
// llvmpipe.
ivec4 tsr_angular_tiles(int axis, ivec4 texels) {
    float n = float(tsr_parameter(tsr_p_tiles + axis));
    return ivec4((vec4(texels + 1) * n - 0.5) / float(tsr_parameter(tsr_p_size + axis)));
}
ivec4 tsr_angular_begins(int axis, ivec4 tiles) {
    float d = float(tsr_parameter(tsr_p_size + axis));
    return ivec4((vec4(tiles) * d + 0.5) / float(tsr_parameter(tsr_p_tiles + axis)));
}

// The parts of a tile's number and of a pixel that depend on u and v.
struct TsrColumn {
    uint u; // word of the axis
    uint v;
    uint tile;
    ivec2 pixel; // from the first pixel of the slot
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

// Number of the tile that is the s-th along s and the t-th along t.
uint tsr_tile_of(TsrColumn c, int s, int t) {
    uint angular = uint(t) * tsr_parameter(tsr_p_tiles + 2) + uint(s);
    return angular * tsr_parameter(tsr_p_tiles) * tsr_parameter(tsr_p_tiles + 1) + c.tile;
}

uint tsr_page(uint tile) {
    return tsr_word(int(tsr_parameter(tsr_p_page_at) + tile));
}

// The first pixel of a surface texel's angular image.
ivec3 tsr_cache_image(uint page, TsrColumn c) {
    int column = int(page & (tsr_page_side - 1u));
    int row = int((page >> tsr_page_row_at) & (tsr_page_side - 1u));
    return ivec3(column * int(tsr_parameter(tsr_p_slot_width)) + c.pixel.x,
                 row * int(tsr_parameter(tsr_p_slot_height)) + c.pixel.y,
                 int(page >> tsr_page_layer_at));
}

vec4 tsr_background() {
    return tsr_unpack(tsr_parameter(tsr_p_background), tsr_parameter(tsr_p_background + 1));
}

// Position among the coarse texels of an axis, `parts` per tile, counted over all its `tiles`, of
// the position `texels` into tile `tile` of `extent` texels.
float tsr_coarse_place(int tile, float texels, int extent, int parts, uint tiles) {
    float place = (float(tile) + texels / float(extent)) * float(parts) - 0.5;
    return clamp(place, 0.0, float(int(tiles) * parts - 1));
}

// The same for a texel on the axis of u or v, given its word, whose mip begins `before` texels into
// the slot.
float tsr_coarse_surface_place(int axis, uint word, int before) {
    float texels = (float(tsr_axis_place(word) - before) + 0.5) * float(1 << tsr_axis_mip(word));
    return tsr_coarse_place(tsr_axis_tile(word), texels, tsr_axis_extent(axis, word),
                            tsr_coarse_uv, tsr_parameter(tsr_p_tiles + axis));
}

// The same for a position along s or t, `beyond` texels after the centre of a texel.
float tsr_coarse_angular_place(int axis, int texel, float beyond) {
    int tile = tsr_angular_tiles(axis, ivec4(texel)).x;
    ivec4 begin = tsr_angular_begins(axis, ivec4(tile, tile + 1, 0, 0));
    return tsr_coarse_place(tile, float(texel - begin.x) + 0.5 + beyond, begin.y - begin.x,
                            tsr_coarse_st, tsr_parameter(tsr_p_tiles + axis));
}

vec4 tsr_coarse_places(TsrColumn c, int s, int t, vec2 beyond) {
    int mip = tsr_axis_mip(c.u);
    ivec2 before = ivec2(0);
    if (mip > 0) {
        int v = int(tsr_parameter(tsr_p_slot_v));
        before = ivec2(int(tsr_parameter(tsr_p_slot_u)), v - (v >> (mip - 1)));
    }
    return vec4(tsr_coarse_surface_place(0, c.u, before.x),
                tsr_coarse_surface_place(1, c.v, before.y),
                tsr_coarse_angular_place(2, s, beyond.x), tsr_coarse_angular_place(3, t, beyond.y));
}

vec4 tsr_coarse_texel(ivec4 at) {
    uint tile = uint(at.w / tsr_coarse_st);
    tile = tile * tsr_parameter(tsr_p_tiles + 2) + uint(at.z / tsr_coarse_st);
    tile = tile * tsr_parameter(tsr_p_tiles + 1) + uint(at.y / tsr_coarse_uv);
    tile = tile * tsr_parameter(tsr_p_tiles) + uint(at.x / tsr_coarse_uv);
    int cell = (at.w % tsr_coarse_st * tsr_coarse_st + at.z % tsr_coarse_st) * tsr_coarse_uv;
    cell = (cell + at.y % tsr_coarse_uv) * tsr_coarse_uv + at.x % tsr_coarse_uv;
    uint word = tsr_parameter(tsr_p_coarse_at) + (tile * uint(tsr_coarse_texels) + uint(cell)) * 2u;
    return tsr_unpack(tsr_word(int(word)), tsr_word(int(word + 1u)));
}

// One of the 16 coarse texels that are mixed linearly at a position `beyond` texels after s and t,
// times its share.
vec4 tsr_coarse_part(int part, TsrColumn c, int s, int t, vec2 beyond) {
    vec4 place = tsr_coarse_places(c, s, t, beyond);
    ivec4 low = ivec4(place);
    vec4 weight = place - vec4(low);
    bvec4 high = bvec4((part & 1) != 0, (part & 2) != 0, (part & 4) != 0, (part & 8) != 0);
    vec4 w = mix(vec4(1.0) - weight, weight, vec4(high));
    float share = w.x * w.y * w.z * w.w;
    // A position at the last texel gives weight 0 to the texel behind it, which does not exist.
    return share > 0.0 ? share * tsr_coarse_texel(low + ivec4(high)) : vec4(0.0);
}

// The four texels of an angular image: their tiles along s and t, and their positions in these.
struct TsrAngle {
    ivec4 s_tile;
    ivec4 t_tile;
    ivec4 s;
    ivec4 t;
};

TsrAngle tsr_angle(TsrAngularTaps taps) {
    ivec4 s_tile = tsr_angular_tiles(2, taps.s);
    ivec4 t_tile = tsr_angular_tiles(3, taps.t);
    return TsrAngle(s_tile, t_tile, taps.s - tsr_angular_begins(2, s_tile),
                    taps.t - tsr_angular_begins(3, t_tile));
}

// The tile that contains all four texels of an angular image, else tsr_no_tile.
const uint tsr_no_tile = 0xFFFFFFFFu;
uint tsr_only_tile(TsrColumn c, TsrAngle a) {
    bool together = a.s_tile == ivec4(a.s_tile.x) && a.t_tile == ivec4(a.t_tile.x);
    return together ? tsr_tile_of(c, a.s_tile.x, a.t_tile.x) : tsr_no_tile;
}

// The mix of an angular image whose texels are all in the tile of that page.
vec4 tsr_cached_image(uint page, TsrColumn c, TsrAngle a, TsrAngularTaps taps) {
    ivec3 image = tsr_cache_image(page, c);
#ifdef TESSERA_HARDWARE_FILTER
    return tsr_filtered(image + ivec3(a.s.x, a.t.x, 0), tsr_beyond(taps));
#else
    return tsr_fetched(image, a.s, a.t, taps.shares);
#endif
}

// The angular image of one of the four surface texels, and its share in the result.
struct TsrImage {
    TsrColumn c;
    TsrAngle a;
    TsrAngularTaps taps;
    float share;
};

TsrImage tsr_choose(int k, TsrImage a, TsrImage b, TsrImage c, TsrImage d) {
    if (k == 0)
        return a;
    if (k == 1)
        return b;
    if (k == 2)
        return c;
    return d;
}

// The mix of four images from several tiles, some of which may be missing. An image of which a
// texel is missing is replaced by coarse texels.
vec4 tsr_images_in_parts(bool wanted, TsrImage i0, TsrImage i1, TsrImage i2, TsrImage i3) {
    vec4 sum = vec4(0.0);
    vec4 image = vec4(0.0);
    bool whole = true;       // no texel of the image is missing so far
    int coarse = 0;          // one bit per image
    uint tile = tsr_no_tile; // of the previous texel
    uint page = 0u;
    for (int k = wanted ? 0 : 16; k < 16; ++k) {
        TsrImage i = tsr_choose(k >> 2, i0, i1, i2, i3);
        uint next = tsr_tile_of(i.c, i.a.s_tile[k & 3], i.a.t_tile[k & 3]);
        if (next != tile) {
            tile = next;
            tsr_mark(tile);
            page = tsr_page(tile);
        }
        whole = whole && page != tsr_page_missing;
        vec4 texel = tsr_background();
        if (page < tsr_page_background)
            texel = tsr_texel(tsr_cache_image(page, i.c) + ivec3(i.a.s[k & 3], i.a.t[k & 3], 0));
        image += i.taps.shares[k & 3] * texel;
        if ((k & 3) == 3) {
            bool stands_in = !whole && tsr_parameter(tsr_p_coarse_at) != 0u;
            coarse |= (stands_in ? 1 : 0) << (k >> 2);
            if (!stands_in)
                sum += i.share * (whole ? image : tsr_background());
            image = vec4(0.0);
            whole = true;
        }
    }
    for (int k = coarse != 0 ? 0 : 64; k < 64; ++k) {
        TsrImage i = tsr_choose(k >> 4, i0, i1, i2, i3);
        vec2 beyond = i.taps.neighbours ? tsr_beyond(i.taps) : vec2(0.0);
        if (((coarse >> (k >> 4)) & 1) != 0)
            sum += i.share * tsr_coarse_part(k & 15, i.c, i.taps.s.x, i.taps.t.x, beyond);
    }
    return sum;
}

// Most pixels need one tile only: they look up one page and mark one tile.
vec4 tsr_four_images(TsrSurfaceFootprint f, vec4 shares, TsrAngularTaps low_low,
                     TsrAngularTaps high_low, TsrAngularTaps low_high, TsrAngularTaps high_high) {
    TsrImage i0 = TsrImage(tsr_column(f.low), tsr_angle(low_low), low_low, shares.x);
    TsrImage i1 = TsrImage(tsr_column(ivec2(f.high.x, f.low.y)), tsr_angle(high_low), high_low,
                           shares.y);
    TsrImage i2 = TsrImage(tsr_column(ivec2(f.low.x, f.high.y)), tsr_angle(low_high), low_high,
                           shares.z);
    TsrImage i3 = TsrImage(tsr_column(f.high), tsr_angle(high_high), high_high, shares.w);
    uint tile = tsr_only_tile(i0.c, i0.a);
    bool together = tile != tsr_no_tile && tile == tsr_only_tile(i1.c, i1.a) &&
                    tile == tsr_only_tile(i2.c, i2.a) && tile == tsr_only_tile(i3.c, i3.a);
#ifdef TESSERA_HARDWARE_FILTER
    together = together && low_low.neighbours;
#endif
    uint page = tsr_page(together ? tile : 0u);
    together = together && page != tsr_page_missing;
    vec4 sum = tsr_background();
    if (together) {
        tsr_mark(tile);
        if (page < tsr_page_background)
            sum = tsr_sum4(tsr_cached_image(page, i0.c, i0.a, low_low),
                           tsr_cached_image(page, i1.c, i1.a, high_low),
                           tsr_cached_image(page, i2.c, i2.a, low_high),
                           tsr_cached_image(page, i3.c, i3.a, high_high), shares);
    }
    vec4 parts = tsr_images_in_parts(!together, i0, i1, i2, i3);
    return together ? sum : parts;
}
