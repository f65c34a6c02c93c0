// A texture on a mesh, with mips: FORMAT.md 5.2, as tessera_sample_surface() in decoder_glsl/shaders/sample.glsl.
uniform highp usampler2D charts;  // of all mips, see class Charts
uniform int mips;
uniform ivec2 mipSize[5];         // places
uniform int chartRow[5];          // first row of each mip in charts
uniform int angularMap;           // as FORMAT.md numbers them
uniform float rayWidth;           // pixels along a side that a ray stands for

in vec3 toEye;
in vec3 surfaceNormal;
in vec3 surfaceTangent;
in vec2 surfacePlace;

uint chartAt(int mip, ivec2 texel) {
    return texelFetch(charts, texel + ivec2(mip > 0 ? size.x : 0, chartRow[mip]), 0).r;
}

// (s, t) texels around a direction. Where the mirrored map folds over, they are no neighbours.
TsrOctahedralTaps taps;
bool folds;

vec4 placeColour(ivec2 uv, int mip) {
    ivec2 angular = size.zw;
    if (!folds) {
        TsrAngularFootprint f = tsr_ended(taps, angular);
        return imageColour(uv, mip, f.low, f.high, f.weight);
    }
    ivec2 a = tsr_folded(taps.first, angular);
    ivec2 b = tsr_folded(taps.first + ivec2(1, 0), angular);
    ivec2 c = tsr_folded(taps.first + ivec2(0, 1), angular);
    ivec2 d = tsr_folded(taps.first + ivec2(1, 1), angular);
    SlotPlace p = slotPlace(uv, mip);
#ifdef MARKS
    int k = chosen() & 3;
    mark(p, k == 0 ? a : k == 1 ? b : k == 2 ? c : d);
    return vec4(0.0);
#else
    vec2 w = taps.weight;
    return mix(mix(texelColour(p, uv, mip, a), texelColour(p, uv, mip, b), w.x),
               mix(texelColour(p, uv, mip, c), texelColour(p, uv, mip, d), w.x), w.y);
#endif
}

vec4 shares(vec2 w) {
    return vec4((1.0 - w.x) * (1.0 - w.y), w.x * (1.0 - w.y), (1.0 - w.x) * w.y, w.x * w.y);
}

vec4 mipColour(vec2 uv, int mip) {
    TsrSurfaceFootprint f = tsr_atlas_footprint(uv, size.xy);
    vec4 share = shares(f.weight);
    int level = 0;
    if (mip > 0) {
        vec2 place = clamp(uv, 0.0, 1.0) * vec2(size.xy);
        uint own = chartAt(0, min(ivec2(place), size.xy - 1));
        TsrSurfaceFootprint g = tsr_atlas_footprint(place / float(1 << mip) / vec2(mipSize[mip]), mipSize[mip]);
        vec4 same = shares(g.weight) * vec4(equal(uvec4(chartAt(mip, g.low), chartAt(mip, ivec2(g.high.x, g.low.y)),
                                                         chartAt(mip, ivec2(g.low.x, g.high.y)), chartAt(mip, g.high)),
                                                   uvec4(own)));
        float sum = same.x + same.y + same.z + same.w;
        if (own != 0u && sum > 0.0) { // else the atlas' own texels
            f = g;
            share = same / sum;
            level = mip;
        }
    }
    return share.x * placeColour(f.low, level) + share.y * placeColour(ivec2(f.high.x, f.low.y), level) +
           share.z * placeColour(ivec2(f.low.x, f.high.y), level) + share.w * placeColour(f.high, level);
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
    float second = mip - float(first); // its share
    vec4 colour = (1.0 - second) * mipColour(surfacePlace, first);
    if (second > 0.0)
        colour += second * mipColour(surfacePlace, first + 1);
    finish(colour);
}
