// A texture on a mesh with mips (FORMAT.md 5.2), like tessera_sample_surface() in decoder_glsl/shaders/sample.glsl. With
// LAYERED defined it is the first layer of several.
uniform int angularMap; // code of FORMAT.md 1.1
uniform float rayWidth; // width in pixels of the area that a ray covers

in vec3 toEye;
in vec3 surfaceNormal;
in vec3 surfaceTangent;
in vec2 surfacePlace;

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
    AtlasPlace at = atlasPlace(0, uv, mip);
    TsrAngularFootprint ended = tsr_ended(taps, size.zw);
    vec4 colour = vec4(0.0);
    int corner = folds ? 0 : 4;
    for (int once = folds ? 1 : 0; once < 1; ++once)
        colour = fourImages(at.low, at.high, at.mip, at.share, ended, ended, ended, ended);
    for (; corner < 4; ++corner)
        colour += at.share[corner] * foldedColour(ivec2((corner & 1) == 0 ? at.low.x : at.high.x,
                                                        (corner & 2) == 0 ? at.low.y : at.high.y), at.mip);
    return colour;
}

void main() {
    vec2 across = dFdx(surfacePlace), down = dFdy(surfacePlace);
    vec2 footprint = sqrt(across * across + down * down) * rayWidth; // in atlases
#ifdef LAYERED
    if (isHole(surfacePlace))
        discard;
    float opacity = opacityAt(surfacePlace, footprint);
    if (opacity <= 0.0)
        discard;
#endif
    vec3 direction = normalize(toEye);
    TsrMeshFrame frame = tsr_mesh_frame(surfaceNormal, surfaceTangent, direction);
    taps = tsr_octahedral_taps(tsr_octahedral_place(angularMap, frame, direction), size.zw);
    folds = angularMap == tsr_map_mirrored && size.zw != ivec2(1) && tsr_crosses_fold(taps, size.zw);
    float mip = mipOf(0, footprint);
    int first = int(mip);
    float second = mip - float(first); // weight of the second mip
    vec4 colour = vec4(0.0);
    for (int i = 0; i <= (second > 0.0 ? 1 : 0); ++i)
        colour += (i == 0 ? 1.0 - second : second) * mipColour(surfacePlace, first + i);
#ifdef LAYERED
    colour = vec4(opacity * withLayers(colour.rgb, surfacePlace, footprint, frame, direction), opacity);
#endif
    finish(colour);
}
