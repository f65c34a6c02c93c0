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

vec4 foldedColour(ivec2 uv, int mip, ivec2 st, int corner) {
    SlotPlace p = slotPlace(uv, mip);
#ifdef MARKS
    if (corner == (chosen() & 3)) {
        --marked; // in place of what imageColour() has marked
        mark(p, st);
    }
    return vec4(0.0);
#else
    return texelColour(p, uv, mip, st);
#endif
}

vec4 placeColour(ivec2 uv, int mip) {
    ivec2 angular = size.zw;
    TsrAngularFootprint f = tsr_ended(taps, angular);
    vec4 colour = imageColour(uv, mip, f.low, f.high, f.weight);
    int corner = folds ? 0 : 4;
    if (corner == 0)
        colour = vec4(0.0);
    for (; corner < 4; ++corner) {
        ivec2 step = ivec2(corner & 1, corner >> 1);
        vec2 share = mix(1.0 - taps.weight, taps.weight, vec2(step));
        colour += share.x * share.y * foldedColour(uv, mip, tsr_folded(taps.first + step, angular), corner);
    }
    return colour;
}

vec4 shares(vec2 w) {
    return vec4((1.0 - w.x) * (1.0 - w.y), w.x * (1.0 - w.y), (1.0 - w.x) * w.y, w.x * w.y);
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
    vec4 colour = vec4(0.0);
    for (int i = 0; i <= (second > 0.0 ? 1 : 0); ++i)
        colour += (i == 0 ? 1.0 - second : second) * mipColour(surfacePlace, first + i);
    finish(colour);
}
