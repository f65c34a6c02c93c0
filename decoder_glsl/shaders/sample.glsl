// The colour that leaves a textured surface in a direction. For any stage.
//
//     #define TESSERA_RESIDENT_CACHE 1         a tile cache; without, a plain texture
//     #define TESSERA_HARDWARE_FILTER 1        4 filtered fetches instead of 16
//     #include "sample.glsl"
//     vec4 colour = tessera_sample(from_centre, direction);                                  of a sphere
//     vec4 colour = tessera_sample_surface(uv, normal, tangent, direction, footprint);       of a mesh
//
//   from_centre   from the sphere's centre to the place on its surface; any length above 0
//   uv            the place in the atlas, 0..1
//   normal        interpolated between the vertices, as is
//   tangent       mesh_tangents() (format/surface_mesh.h); of any length
//   direction     of unit length, from the surface to the observer
//   footprint     texels of the atlas along u and v that a pixel covers; without effect as yet
//   result        linear mix of texels as they are stored (no transfer function undone); grey in all
//                 three colours, alpha 1 where the texture has none
//
// Bindings (define others before the include where these are taken;
// in Vulkan set 0, but textures set 2):
//   TESSERA_BINDING_SAMPLER  4  storage buffer: sizes, page table, coarse texels
//   TESSERA_BINDING_MARKS    5  storage buffer, written: CACHE only, one word a tile
//   TESSERA_UNIT_TEXELS      0  sampler2DArray
// The host class SampledTexture (gl_sampled_texture.h) fills and binds them.
//
// CACHE: a tile that is not there yet gives its coarse texels, and is marked so that the host
// decodes it.
#ifndef TSR_SAMPLE
#define TSR_SAMPLE
#ifndef TESSERA_BINDING_SAMPLER
#define TESSERA_BINDING_SAMPLER 4
#endif
#ifndef TESSERA_BINDING_MARKS
#define TESSERA_BINDING_MARKS 5
#endif
#ifndef TESSERA_UNIT_TEXELS
#define TESSERA_UNIT_TEXELS 0
#endif
#include "dialect.glsl"
#include "layout.glsl"
#include "sampler_layout.glsl"
#include "surface.glsl"
#include "octahedral.glsl"

layout(std430, binding = TESSERA_BINDING_SAMPLER) restrict readonly buffer TesseraSampler {
    uint tsr_sampler[];
};

uint tsr_parameter(int field) {
    return tsr_sampler[field];
}
ivec4 tsr_four(int field) {
    return ivec4(int(tsr_sampler[field]), int(tsr_sampler[field + 1]), int(tsr_sampler[field + 2]),
                 int(tsr_sampler[field + 3]));
}

// A texel of two packed words: 8-bit samples in the first, or four halves.
vec4 tsr_unpack(uint low, uint high) {
    if (tsr_parameter(tsr_p_half) != 0u) {
        vec2 a = unpackHalf2x16(low);
        vec2 b = unpackHalf2x16(high);
        return vec4(a.x, a.y, b.x, b.y);
    }
    return unpackUnorm4x8(low);
}

// The word of an axis, see sampler_layout.glsl.
uint tsr_axis(int axis, int texel) {
    return tsr_sampler[tsr_sampler[tsr_p_axis_at + axis] + uint(texel)];
}
int tsr_axis_tile(uint word) {
    return int(word & 0xFFFFu);
}
int tsr_axis_place(uint word) {
    return int(word >> tsr_axis_place_at) & (tsr_max_spatial_side - 1);
}
int tsr_axis_extent(uint word) {
    return (int(word >> tsr_axis_extent_at) & (tsr_max_spatial_side - 1)) + 1;
}

vec4 tsr_mix4(vec4 a, vec4 b, vec4 c, vec4 d, vec2 weight) {
    return mix(mix(a, b, weight.x), mix(c, d, weight.x), weight.y);
}

layout(TSR_TEXTURE(TESSERA_UNIT_TEXELS)) uniform highp sampler2DArray tsr_texels;
// The mix of the four texels of a footprint, neighbours in one layer.
vec4 tsr_fetched(ivec3 pixel, TsrAngularFootprint f) {
    ivec2 step = f.high - f.low;
    return tsr_mix4(texelFetch(tsr_texels, pixel, 0),
                    texelFetch(tsr_texels, pixel + ivec3(step.x, 0, 0), 0),
                    texelFetch(tsr_texels, pixel + ivec3(0, step.y, 0), 0),
                    texelFetch(tsr_texels, pixel + ivec3(step.x, step.y, 0), 0), f.weight);
}
// How far the footprint lies beyond its low texels. Where it was clamped both are the same one, and the
// weight must not reach for its neighbour.
vec2 tsr_beyond(TsrAngularFootprint f) {
    return vec2(f.low.x == f.high.x ? 0.0 : f.weight.x, f.low.y == f.high.y ? 0.0 : f.weight.y);
}
// The same as tsr_fetched() by the texture unit.
vec4 tsr_filtered(ivec3 pixel, TsrAngularFootprint f) {
    vec2 offset = tsr_beyond(f);
    vec2 size = vec2(float(tsr_parameter(tsr_p_width)), float(tsr_parameter(tsr_p_height)));
    vec2 place = (vec2(float(pixel.x), float(pixel.y)) + vec2(0.5) + offset) / size;
    return textureLod(tsr_texels, vec3(place.x, place.y, float(pixel.z)), 0.0);
}
// The mix of a footprint whose texels are neighbours, by whoever does it faster.
vec4 tsr_mixed(ivec3 pixel, TsrAngularFootprint f) {
#ifdef TESSERA_HARDWARE_FILTER
    return tsr_filtered(pixel, f);
#else
    return tsr_fetched(pixel, f);
#endif
}

#ifdef TESSERA_RESIDENT_CACHE
#include "sample_cache.glsl"
#else
#include "sample_plain.glsl"
#endif

TsrAngularFootprint tsr_angles_of(int u, int v, ivec4 size, vec3 direction) {
    return tsr_angular_footprint(ivec2(u, v), ivec2(size.x, size.y), ivec2(size.z, size.w),
                                 direction);
}

vec4 tessera_sample(vec3 from_centre, vec3 direction) {
    ivec4 size = tsr_four(tsr_p_size);
    TsrSurfaceFootprint f = tsr_surface_footprint(from_centre, ivec2(size.x, size.y));
    // Each of the four surface texels has its own frame, hence its own angles.
    return tsr_four_images(f, tsr_angles_of(f.low.x, f.low.y, size, direction),
                           tsr_angles_of(f.high.x, f.low.y, size, direction),
                           tsr_angles_of(f.low.x, f.high.y, size, direction),
                           tsr_angles_of(f.high.x, f.high.y, size, direction));
}

// The same angle of the four texels of the atlas.
vec4 tsr_atlas_texels(TsrSurfaceFootprint f, ivec2 angle) {
    return tsr_mix4(tsr_angular_texel(f.low, angle),
                    tsr_angular_texel(ivec2(f.high.x, f.low.y), angle),
                    tsr_angular_texel(ivec2(f.low.x, f.high.y), angle),
                    tsr_angular_texel(f.high, angle), f.weight);
}

vec4 tessera_sample_surface(vec2 uv, vec3 normal, vec3 tangent, vec3 direction, vec2 footprint) {
    ivec4 size = tsr_four(tsr_p_size);
    ivec2 angular = ivec2(size.z, size.w);
    int map = int(tsr_parameter(tsr_p_angular_map));
    TsrMeshFrame frame = tsr_mesh_frame(normal, tangent, direction);
    TsrOctahedralTaps taps =
        tsr_octahedral_taps(tsr_octahedral_place(map, frame, direction), angular);
    TsrSurfaceFootprint f = tsr_atlas_footprint(uv, ivec2(size.x, size.y));
    bool folds = map == tsr_map_mirrored && tsr_crosses_fold(taps, angular);
    if (!folds) {
        TsrAngularFootprint a = tsr_ended(taps, angular);
        return tsr_four_images(f, a, a, a, a);
    }
    // Texels of an angular image that are no neighbours: one by one.
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 after = ivec2(k & 1, k >> 1);
        vec2 weight = mix(vec2(1.0) - taps.weight, taps.weight, vec2(after));
        sum += weight.x * weight.y *
               tsr_atlas_texels(f, tsr_folded(taps.first + after, angular));
    }
    return sum;
}

#endif
