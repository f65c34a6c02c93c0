// The texels that a sample of a mesh reads: FORMAT.md 5.2 in single precision. Tests compare it
// with format/surface_mesh.h, which is the same in double precision. It keeps to the subset of
// surface.glsl.
#include "surface.glsl"

const int tsr_map_mirrored = 4; // number of this angular map in FORMAT.md

// The frame at a point of a mesh; y is cross(z, x).
struct TsrMeshFrame {
    vec3 x;
    vec3 z; // the normal
};

// The four texels around a position in the square of an octahedral map. They may lie one texel
// outside the square: tsr_folded() moves them inside.
struct TsrOctahedralTaps {
    ivec2 first;
    vec2 weight; // of the texels after it
};

float tsr_length(vec3 v) {
    return sqrt(dot(v, v));
}

// The unit vector along v's component at right angles to n. If there is none, that of the axis
// which is least parallel to n.
vec3 tsr_made_tangent(vec3 v, vec3 n) {
    vec3 flat_v = v - dot(v, n) * n;
    float left = tsr_length(flat_v);
    if (left > tsr_no_direction * tsr_length(v))
        return flat_v / left;
    vec3 size = abs(n);
    vec3 axis = vec3(0.0f, 0.0f, 1.0f);
    if (size.x <= size.y && size.x <= size.z)
        axis = vec3(1.0f, 0.0f, 0.0f);
    else if (size.y <= size.z)
        axis = vec3(0.0f, 1.0f, 0.0f);
    return normalize(axis - dot(axis, n) * n);
}

// The frame of an interpolated normal and tangent. Where normals cancel out, d takes the normal's
// place.
TsrMeshFrame tsr_mesh_frame(vec3 normal, vec3 tangent, vec3 d) {
    float left = tsr_length(normal);
    TsrMeshFrame f;
    f.z = left > tsr_no_direction ? normal / left : d;
    f.x = tsr_made_tangent(tangent, f.z);
    return f;
}

// Projects directions into the surface onto the surface. Returns the normal for those of no length.
vec3 tsr_away_from(vec3 n, vec3 d) {
    vec3 away = d - min(0.0f, dot(n, d)) * n;
    float left = tsr_length(away);
    return left > tsr_no_direction ? away / left : n;
}

float tsr_side_of(float x) {
    return x < 0.0f ? -1.0f : 1.0f; // 1 for 0
}

vec2 tsr_hemisphere_square(TsrMeshFrame f, vec3 d) {
    float x = dot(f.x, d);
    float y = dot(cross(f.z, f.x), d);
    float sum = abs(x) + abs(y) + max(0.0f, dot(f.z, d));
    return vec2((x + y) / sum, (x - y) / sum);
}

vec2 tsr_mirrored_square(vec3 n, vec3 d) {
    vec3 r = 2.0f * dot(n, d) * n - d;
    float sum = abs(r.x) + abs(r.y) + abs(r.z);
    float p = r.x / sum;
    float q = r.z / sum;
    if (r.y < 0.0f)
        return vec2((1.0f - abs(q)) * tsr_side_of(p), (1.0f - abs(p)) * tsr_side_of(q));
    return vec2(p, q);
}

// (s, t) in 0..1 of the unit direction d, which points away from the surface.
vec2 tsr_octahedral_place(int map, TsrMeshFrame frame, vec3 d) {
    vec3 away = tsr_away_from(frame.z, d);
    vec2 square = map == tsr_map_mirrored ? tsr_mirrored_square(frame.z, away)
                                          : tsr_hemisphere_square(frame, away);
    return clamp((square + vec2(1.0f)) / 2.0f, 0.0f, 1.0f);
}

// The clamps keep texels inside the texture even if `place` is not a number.
TsrOctahedralTaps tsr_octahedral_taps(vec2 place, ivec2 size) {
    float across = place.x * float(size.x) - 0.5f;
    float up = place.y * float(size.y) - 0.5f;
    TsrOctahedralTaps taps;
    taps.first = ivec2(clamp(int(floor(across)), -1, size.x - 1),
                       clamp(int(floor(up)), -1, size.y - 1));
    taps.weight = vec2(across - float(taps.first.x), up - float(taps.first.y));
    return taps;
}

// Whether some of the texels lie outside the square, where the mirrored map folds.
bool tsr_crosses_fold(TsrOctahedralTaps taps, ivec2 size) {
    return taps.first.x < 0 || taps.first.y < 0 || taps.first.x >= size.x - 1 ||
           taps.first.y >= size.y - 1;
}

// Beyond an edge of the mirrored map's square the same edge follows, in reverse.
ivec2 tsr_folded(ivec2 tap, ivec2 size) {
    ivec2 at = tap;
    if (at.x < 0 || at.x >= size.x)
        at = ivec2(at.x < 0 ? 0 : size.x - 1, size.y - 1 - at.y);
    if (at.y < 0 || at.y >= size.y)
        at = ivec2(size.x - 1 - at.x, at.y < 0 ? 0 : size.y - 1);
    return at;
}

// The same texels, clamped to the square.
TsrAngularFootprint tsr_ended(TsrOctahedralTaps taps, ivec2 size) {
    TsrAngularFootprint f;
    f.weight = taps.weight;
    f.low = ivec2(max(taps.first.x, 0), max(taps.first.y, 0));
    f.high = ivec2(min(taps.first.x + 1, size.x - 1), min(taps.first.y + 1, size.y - 1));
    return f;
}

// The four texels of the atlas around uv, clamped to its edges. size: texels along u and v.
TsrSurfaceFootprint tsr_atlas_footprint(vec2 uv, ivec2 size) {
    float across = clamp(uv.x, 0.0f, 1.0f) * float(size.x) - 0.5f;
    float up = clamp(uv.y, 0.0f, 1.0f) * float(size.y) - 0.5f;
    int i = clamp(int(floor(across)), -1, size.x - 1);
    int j = clamp(int(floor(up)), -1, size.y - 1);
    TsrSurfaceFootprint f;
    f.weight = vec2(across - float(i), up - float(j));
    f.low = ivec2(max(i, 0), max(j, 0));
    f.high = ivec2(min(i + 1, size.x - 1), min(j + 1, size.y - 1));
    return f;
}
