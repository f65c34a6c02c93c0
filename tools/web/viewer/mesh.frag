// A texture on a mesh with mips (FORMAT.md 5.2), like tessera_sample_surface() in decoder_glsl/shaders/sample.glsl.
uniform highp usampler2D charts;  // of all mips; class Charts has the layout
uniform int mips;
uniform ivec2 mipSize[5];         // surface texels
uniform int chartRow[5];          // first row of each mip in `charts`
uniform int angularMap;           // code of FORMAT.md 1.1
uniform float rayWidth;           // width in pixels of the area that a ray covers

in vec3 toEye;
in vec3 surfaceNormal;
in vec3 surfaceTangent;
in vec2 surfacePlace;

uint chartAt(int mip, ivec2 texel) {
    return texelFetch(charts, texel + ivec2(mip > 0 ? size.x : 0, chartRow[mip]), 0).r;
}

// The four (s, t) texels around the direction. At the edge of the mirrored map they are not adjacent (`folds`).
TsrOctahedralTaps taps;
bool folds;

// The colour of one surface texel if the four (s, t) texels are not adjacent.
vec4 foldedColour(ivec2 uv, int mip) {
    SlotPlace p = slotPlace(uv, mip);
    vec4 colour = vec4(0.0), share = shares(taps.weight);
    for (int corner = 0; corner < 4; ++corner) {
        ivec2 st = tsr_folded(taps.first + ivec2(corner & 1, corner >> 1), size.zw);
#ifdef MARKS
        if (corner == (chosen() & 3))
            mark(p, st);
#else
        colour += share[corner] * texelColour(p, uv, mip, st);
#endif
    }
    return colour;
}

vec4 mipColour(vec2 uv, int mip) {
    TsrSurfaceFootprint f = tsr_atlas_footprint(uv, size.xy);
    vec4 share = shares(f.weight);
    int level = 0;
    for (int once = mip > 0 ? 0 : 1; once < 1; ++once) {
        vec2 place = clamp(uv, 0.0, 1.0) * vec2(size.xy);
        uint own = chartAt(0, min(ivec2(place), size.xy - 1));
        TsrSurfaceFootprint g = tsr_atlas_footprint(place / float(1 << mip) / vec2(mipSize[mip]), mipSize[mip]);
        vec4 same = shares(g.weight) * vec4(equal(uvec4(chartAt(mip, g.low), chartAt(mip, ivec2(g.high.x, g.low.y)),
                                                         chartAt(mip, ivec2(g.low.x, g.high.y)), chartAt(mip, g.high)),
                                                   uvec4(own)));
        float sum = same.x + same.y + same.z + same.w;
        if (own != 0u && sum > 0.0) { // otherwise the texels of the atlas are used
            f = g;
            share = same / sum;
            level = mip;
        }
    }
    TsrAngularFootprint ended = tsr_ended(taps, size.zw);
    vec4 colour = vec4(0.0);
    int corner = folds ? 0 : 4;
    for (int once = folds ? 1 : 0; once < 1; ++once)
        colour = fourImages(f.low, f.high, level, share, ended, ended, ended, ended);
    for (; corner < 4; ++corner)
        colour += share[corner] * foldedColour(ivec2((corner & 1) == 0 ? f.low.x : f.high.x,
                                                     (corner & 2) == 0 ? f.low.y : f.high.y), level);
    return colour;
}

void main() {
    vec2 across = dFdx(surfacePlace) * vec2(size.xy) * rayWidth;
    vec2 down = dFdy(surfacePlace) * vec2(size.xy) * rayWidth;
    vec2 footprint = sqrt(across * across + down * down);
    vec3 direction = normalize(toEye);
    TsrMeshFrame frame = tsr_mesh_frame(surfaceNormal, surfaceTangent, direction);
    taps = tsr_octahedral_taps(tsr_octahedral_place(angularMap, frame, direction), size.zw);
    folds = angularMap == tsr_map_mirrored && tsr_crosses_fold(taps, size.zw);
    float covered = max(min(footprint.x, footprint.y) * 0.70710678, max(footprint.x, footprint.y) / 4.0);
    float mip = covered > 1.0 ? min(log2(covered), float(mips)) : 0.0;
    int first = int(mip);
    float second = mip - float(first); // weight of the second mip
    vec4 colour = vec4(0.0);
    for (int i = 0; i <= (second > 0.0 ? 1 : 0); ++i)
        colour += (i == 0 ? 1.0 - second : second) * mipColour(surfacePlace, first + i);
    finish(colour);
}
