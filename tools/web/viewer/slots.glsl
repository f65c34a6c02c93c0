// Reads colours of angular images from the tile cache. The coarse level replaces missing tiles.
//
// With MARKS defined nothing is read. Instead, `marks` receives the numbers + 1 of tiles that the pixel needs.

uniform highp usampler2D pages;       // a word per tile, 1024 per row: 0 or 1 << 31 | layer << 20 | row << 10 | column
uniform highp sampler2DArray slots;   // layout: slot_layout.js
uniform highp sampler2DArray coarse;  // class CoarseLevel
uniform ivec4 size;                   // texels along u, v, s, t
uniform ivec4 tiles;                  // tiles along u, v, s, t
uniform ivec4 tileSide;               // size of the largest tile
uniform vec4 sides, tileCount;        // `size` and `tiles` as floats
uniform vec4 perTexel, perTile;       // tiles per texel, texels per tile
uniform ivec2 slotSize;               // pixels
uniform vec2 layerSize;               // pixels of a layer of `slots`
uniform int mipRow[5];                // first row of each mip in a slot, in surface texels
uniform ivec4 coarseSize;             // size of the coarse level; 0: there is none
uniform ivec2 coarseLod;              // log2 of the texels of level 0 per texel: spatial, angular
uniform ivec2 coarseFold;             // angular images along x and y of a layer
uniform vec4 emptyColour;             // of missing tiles if there is no coarse level

#ifdef MARKS
uniform int corner; // see Renderer.tilesOf()
uvec4 marks = uvec4(0u);
int marked = 0;
#endif

// The tile of a texel, and the first texel of a tile. A product that is not an integer differs from the nearest one by
// at least 1 / axisSize or 1 / axisTiles, so an offset of a quarter of that absorbs rounding errors.
// TileGrid.checkFloats() tests all values.
ivec2 tileOf(ivec2 texel, vec2 axisSize, vec2 perTexel) {
    return ivec2(ceil(vec2(texel + 1) * perTexel - 0.25 / axisSize)) - 1;
}
ivec2 tileBegin(ivec2 tile, vec2 axisTiles, vec2 perTile) {
    return ivec2(floor(vec2(tile) * perTile + 0.25 / axisTiles));
}

// The tile of a texel of the atlas or of a mip, and the texel's position in the slot of the tile.
struct SlotPlace {
    ivec2 tile;
    ivec2 place;
};

SlotPlace slotPlace(ivec2 uv, int mip) {
    ivec2 first = uv << mip;
    SlotPlace p;
    p.tile = tileOf(first, sides.xy, perTexel.xy);
    ivec2 begin = tileBegin(p.tile, tileCount.xy, perTile.xy);
    p.place = uv - (begin >> mip) + ivec2(mip > 0 ? tileSide.x : 0, mipRow[mip]);
    return p;
}

int tileNumber(ivec2 uv, ivec2 st) {
    return ((st.y * tiles.z + st.x) * tiles.y + uv.y) * tiles.x + uv.x;
}

uint pageOf(int tile) {
    return texelFetch(pages, ivec2(tile & 1023, tile >> 10), 0).r;
}

// The first pixel of an angular image in its slot.
ivec3 slotPixel(uint page, ivec2 place) {
    ivec2 slot = ivec2(int(page & 1023u), int((page >> 10) & 1023u));
    return ivec3(slot * slotSize + place * tileSide.zw, int((page >> 20) & 2047u));
}

ivec2 directionTile(ivec2 st) {
    return tileOf(st, sides.zw, perTexel.zw);
}
ivec2 directionBegin(ivec2 tile) {
    return tileBegin(tile, tileCount.zw, perTile.zw);
}

// The coarse level, interpolated linearly. Positions and directions are in texels of level 0; texel 0 is 0..1.
vec4 coarseImage(ivec2 uv, vec2 st) {
    ivec2 image = clamp(uv, ivec2(0), coarseSize.xy - 1);
    ivec2 cell = image / coarseFold;
    ivec2 at = (image - cell * coarseFold) * coarseSize.zw;
    int across = (coarseSize.x + coarseFold.x - 1) / coarseFold.x;
    vec2 place = vec2(at) + clamp(st, vec2(0.5), vec2(coarseSize.zw) - 0.5);
    return textureLod(coarse, vec3(place / vec2(coarseFold * coarseSize.zw), float(cell.y * across + cell.x)), 0.0);
}
vec4 coarseColour(vec2 place, vec2 direction) {
    if (coarseSize.x == 0)
        return emptyColour;
    vec2 at = place / float(1 << coarseLod.x) - 0.5;
    vec2 st = direction / float(1 << coarseLod.y);
    ivec2 low = ivec2(floor(at));
    vec2 w = at - vec2(low);
    return mix(mix(coarseImage(low, st), coarseImage(low + ivec2(1, 0), st), w.x),
               mix(coarseImage(low + ivec2(0, 1), st), coarseImage(low + ivec2(1, 1), st), w.x), w.y);
}

// Work that only few pixels need is written as loops that most pixels skip. On devices that execute both branches of an
// if, such as software renderers, skipped loops cost nothing.

// The colour of one texel.
vec4 texelColour(SlotPlace p, ivec2 uv, int mip, ivec2 st) {
    ivec2 tile = directionTile(st);
    uint page = pageOf(tileNumber(p.tile, tile));
    vec4 colour = texelFetch(slots, slotPixel(page, p.place) + ivec3(st - directionBegin(tile), 0), 0);
    for (int missing = page == 0u ? 0 : 1; missing < 1; ++missing)
        colour = coarseColour((vec2(uv) + 0.5) * float(1 << mip), vec2(st) + 0.5);
    return colour;
}

#ifdef MARKS
// The texel that this pixel marks, out of four; plus 4 for the second mip. Neighbouring pixels mark others.
int chosen() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    return corner >= 0 ? corner : (at.x & 1) | ((at.y & 1) << 1) | (((at.x + at.y) & 2) << 1);
}
void mark(SlotPlace p, ivec2 st) {
    if (marked < 4 || (chosen() & 4) != 0)
        marks[marked & 3] = uint(tileNumber(p.tile, directionTile(st))) + 1u;
    ++marked;
}
#endif

// Interpolates in the angular image of one surface texel between the texels `low` and `high`. `weight` is the weight of
// `high` along s and t.
vec4 imageColour(ivec2 uv, int mip, ivec2 low, ivec2 high, vec2 weight) {
    SlotPlace p = slotPlace(uv, mip);
#ifdef MARKS
    mark(p, ivec2((chosen() & 1) == 0 ? low.x : high.x, (chosen() & 2) == 0 ? low.y : high.y));
    return vec4(0.0);
#else
    ivec2 tile = directionTile(low);
    uint page = pageOf(tileNumber(p.tile, tile));
    vec2 beyond = weight * vec2(notEqual(low, high)); // equal texels need no interpolation
    ivec3 pixel = slotPixel(page, p.place) + ivec3(low - directionBegin(tile), 0);
    vec4 colour = textureLod(slots, vec3((vec2(pixel.xy) + 0.5 + beyond) / layerSize, float(pixel.z)), 0.0);
    // The texture unit has interpolated correctly if one tile contains all four texels and is present.
    int corner = page != 0u && tile == directionTile(high) ? 4 : 0;
    if (corner == 0)
        colour = vec4(0.0);
    for (; corner < 4; ++corner) {
        ivec2 st = ivec2((corner & 1) == 0 ? low.x : high.x, (corner & 2) == 0 ? low.y : high.y);
        vec2 share = mix(1.0 - weight, weight, vec2(corner & 1, corner >> 1));
        colour += share.x * share.y * texelColour(p, uv, mip, st);
    }
    return colour;
#endif
}

// Selects one of four values.
ivec2 oneOf(int i, ivec2 a, ivec2 b, ivec2 c, ivec2 d) {
    return i == 0 ? a : i == 1 ? b : i == 2 ? c : d;
}
vec2 oneOf(int i, vec2 a, vec2 b, vec2 c, vec2 d) {
    return i == 0 ? a : i == 1 ? b : i == 2 ? c : d;
}

vec4 filtered(ivec3 image, ivec2 begin, TsrAngularFootprint f) {
    vec2 place = vec2(image.xy + f.low - begin) + 0.5 + f.weight * vec2(notEqual(f.low, f.high));
    return textureLod(slots, vec3(place / layerSize, float(image.z)), 0.0);
}

// The weighted mean of the angular images of four surface texels of the atlas or a mip, in the order (low, low),
// (high, low), (low, high), (high, high). Usually one tile contains all of them.
vec4 fourImages(ivec2 low, ivec2 high, int mip, vec4 share, TsrAngularFootprint a, TsrAngularFootprint b,
                TsrAngularFootprint c, TsrAngularFootprint d) {
    int corner = 0;
    vec4 colour = vec4(0.0);
#ifndef MARKS
    SlotPlace p = slotPlace(low, mip);
    ivec2 tile = directionTile(min(min(a.low, b.low), min(c.low, d.low)));
    uint page = pageOf(tileNumber(p.tile, tile));
    ivec2 begin = directionBegin(tile);
    ivec3 image = slotPixel(page, p.place);
    ivec2 next = (high - low) * tileSide.zw;
    colour = share.x * filtered(image, begin, a) +
             share.y * filtered(image + ivec3(next.x, 0, 0), begin, b) +
             share.z * filtered(image + ivec3(0, next.y, 0), begin, c) +
             share.w * filtered(image + ivec3(next, 0), begin, d);
    if (page != 0u && slotPlace(high, mip).tile == p.tile &&
        directionTile(max(max(a.high, b.high), max(c.high, d.high))) == tile)
        corner = 4;
    if (corner == 0)
        colour = vec4(0.0);
#endif
    for (; corner < 4; ++corner)
        colour += share[corner] * imageColour(ivec2((corner & 1) == 0 ? low.x : high.x,
                                                    (corner & 2) == 0 ? low.y : high.y), mip,
                                              oneOf(corner, a.low, b.low, c.low, d.low),
                                              oneOf(corner, a.high, b.high, c.high, d.high),
                                              oneOf(corner, a.weight, b.weight, c.weight, d.weight));
    return colour;
}

vec4 shares(vec2 w) {
    return vec4((1.0 - w.x) * (1.0 - w.y), w.x * (1.0 - w.y), (1.0 - w.x) * w.y, w.x * w.y);
}
