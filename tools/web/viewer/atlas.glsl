// Places in the atlas of a mesh and its mips (FORMAT.md 5.2). The layers of a file may have atlases of different sizes.
uniform highp usampler2DArray charts; // a layer per atlas, with all of its mips; class Charts has the layout
uniform ivec4 atlases[9];             // x, y: texels; z: number of mips

// The size of a mip, and its place in a picture with the mips to the right of the atlas, each below the previous one.
ivec2 mipSize(int atlas, int mip) {
    return (atlases[atlas].xy + (1 << mip) - 1) >> mip;
}
ivec2 mipBegin(int atlas, int mip) {
    ivec2 begin = ivec2(mip > 0 ? atlases[atlas].x : 0, 0);
    for (int above = 1; above < mip; ++above)
        begin.y += mipSize(atlas, above).y;
    return begin;
}

uint chartAt(int atlas, ivec2 begin, ivec2 texel) {
    return texelFetch(charts, ivec3(begin + texel, atlas), 0).r;
}

// The mip for a pixel that covers `footprint` of the whole atlas along u and v.
float mipOf(int atlas, vec2 footprint) {
    vec2 texels = footprint * vec2(atlases[atlas].xy);
    float covered = max(min(texels.x, texels.y) * 0.70710678, max(texels.x, texels.y) / 4.0);
    return covered > 1.0 ? min(log2(covered), float(atlases[atlas].z)) : 0.0;
}

// The four texels around a place, with their weights.
struct AtlasPlace {
    int mip; // 0 if no texel of the wanted mip shows the chart
    ivec2 low, high;
    vec4 share; // (low, low), (high, low), (low, high), (high, high)
};

AtlasPlace atlasPlace(int atlas, vec2 uv, int mip) {
    ivec2 whole = atlases[atlas].xy;
    TsrSurfaceFootprint f = tsr_atlas_footprint(uv, whole);
    AtlasPlace found = AtlasPlace(0, f.low, f.high, shares(f.weight));
    for (int once = mip > 0 ? 0 : 1; once < 1; ++once) {
        vec2 place = clamp(uv, 0.0, 1.0) * vec2(whole);
        ivec2 begin = mipBegin(atlas, mip), sides = mipSize(atlas, mip);
        uint own = chartAt(atlas, ivec2(0), min(ivec2(place), whole - 1));
        f = tsr_atlas_footprint(place / float(1 << mip) / vec2(sides), sides);
        vec4 same = shares(f.weight) *
                    vec4(equal(uvec4(chartAt(atlas, begin, f.low), chartAt(atlas, begin, ivec2(f.high.x, f.low.y)),
                                     chartAt(atlas, begin, ivec2(f.low.x, f.high.y)), chartAt(atlas, begin, f.high)),
                               uvec4(own)));
        float sum = same.x + same.y + same.z + same.w;
        if (own != 0u && sum > 0.0)
            found = AtlasPlace(mip, f.low, f.high, same / sum);
    }
    return found;
}
