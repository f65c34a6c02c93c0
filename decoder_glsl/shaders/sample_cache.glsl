// A tile cache: the page table says where a tile is, and sampling marks the tiles that it touches.
layout(std430, binding = TESSERA_BINDING_MARKS) buffer TesseraMarks { uint tsr_marks[]; };

// Every invocation writes the same word, so the order does not matter; most find it written.
void tsr_mark(uint tile) {
    if (tsr_marks[tile] == 0u)
        tsr_marks[tile] = 1u;
}

ivec3 tsr_cache_pixel(uint slot, ivec4 in_tile) {
    uint columns = tsr_parameter(tsr_p_columns);
    uint rows = tsr_parameter(tsr_p_rows);
    uint line = slot / columns;
    return ivec3(int(slot - line * columns) * int(tsr_parameter(tsr_p_slot_width)) +
                     in_tile.x * int(tsr_parameter(tsr_p_stride_s)) + in_tile.z,
                 int(line % rows) * int(tsr_parameter(tsr_p_slot_height)) +
                     in_tile.y * int(tsr_parameter(tsr_p_stride_t)) + in_tile.w,
                 int(line / rows));
}

vec4 tsr_background() {
    return tsr_unpack(tsr_parameter(tsr_p_background), tsr_parameter(tsr_p_background + 1));
}

// The mean over a part of the tile, or the background where there are no coarse texels.
vec4 tsr_coarse(TsrTexel x) {
    if (tsr_parameter(tsr_p_has_coarse) == 0u)
        return tsr_background();
    ivec4 begin = tsr_begin_of_tile(x.tile);
    ivec4 extent = tsr_begin_of_tile(x.tile + ivec4(1)) - begin;
    ivec4 at = x.at - begin;
    int cell = ((at.w * tsr_coarse_st / extent.w * tsr_coarse_st + at.z * tsr_coarse_st / extent.z) *
                    tsr_coarse_uv +
                at.y * tsr_coarse_uv / extent.y) *
                   tsr_coarse_uv +
               at.x * tsr_coarse_uv / extent.x;
    uint word = tsr_parameter(tsr_p_coarse_at) + (x.number * uint(tsr_coarse_texels) + uint(cell)) * 2u;
    return tsr_unpack(tsr_sampler[word], tsr_sampler[word + 1u]);
}

// One texel, its tile marked.
vec4 tsr_cached(ivec4 at) {
    TsrTexel x = tsr_texel(at);
    tsr_mark(x.number);
    uint page = tsr_sampler[uint(tsr_p_pages) + x.number];
    if (page == tsr_page_background)
        return tsr_background();
    if (page == tsr_page_missing)
        return tsr_coarse(x);
    return texelFetch(tsr_texels, tsr_cache_pixel(page, at - tsr_begin_of_tile(x.tile)), 0);
}

vec4 tsr_angular_image(ivec2 texel, TsrAngularFootprint f) {
    ivec4 low = ivec4(texel.x, texel.y, f.low.x, f.low.y);
    ivec4 high = ivec4(texel.x, texel.y, f.high.x, f.high.y);
    TsrTexel a = tsr_texel(low);
    TsrTexel b = tsr_texel(high);
    uint page = tsr_sampler[uint(tsr_p_pages) + a.number];
    // Inside one tile, all four texels are one lookup away.
    if (a.number == b.number && page < tsr_page_background) {
        tsr_mark(a.number);
        ivec3 pixel = tsr_cache_pixel(page, low - tsr_begin_of_tile(a.tile));
#ifdef TESSERA_HARDWARE_FILTER
        return tsr_filtered(pixel, f);
#else
        ivec2 step = f.high - f.low;
        return tsr_mix4(texelFetch(tsr_texels, pixel, 0),
                        texelFetch(tsr_texels, pixel + ivec3(step.x, 0, 0), 0),
                        texelFetch(tsr_texels, pixel + ivec3(0, step.y, 0), 0),
                        texelFetch(tsr_texels, pixel + ivec3(step.x, step.y, 0), 0), f.weight);
#endif
    }
#ifdef TESSERA_HARDWARE_FILTER
    // Across a border: the tile's own copy of its neighbours' first texels, once all are there.
    ivec4 side_s = ivec4(texel.x, texel.y, f.high.x, f.low.y);
    ivec4 side_t = ivec4(texel.x, texel.y, f.low.x, f.high.y);
    uint c = tsr_texel(side_s).number;
    uint d = tsr_texel(side_t).number;
    if (page < tsr_page_background && tsr_sampler[uint(tsr_p_pages) + b.number] != tsr_page_missing &&
        tsr_sampler[uint(tsr_p_pages) + c] != tsr_page_missing &&
        tsr_sampler[uint(tsr_p_pages) + d] != tsr_page_missing) {
        tsr_mark(a.number);
        tsr_mark(b.number);
        tsr_mark(c);
        tsr_mark(d);
        return tsr_filtered(tsr_cache_pixel(page, low - tsr_begin_of_tile(a.tile)), f);
    }
#endif
    return tsr_mix4(tsr_cached(low), tsr_cached(ivec4(texel.x, texel.y, f.high.x, f.low.y)),
                    tsr_cached(ivec4(texel.x, texel.y, f.low.x, f.high.y)), tsr_cached(high),
                    f.weight);
}
