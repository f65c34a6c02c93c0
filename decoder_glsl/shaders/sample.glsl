// The colour that leaves a textured surface in a direction. For any shader stage.
//
//     #define TESSERA_RESIDENT_CACHE 1     a tile cache; without it a plain texture
//     #define TESSERA_HARDWARE_FILTER 1    4 filtered fetches instead of 16
//     #include "sample.glsl"
//     // on a sphere, and on a mesh:
//     vec4 colour = tessera_sample(from_centre, direction);
//     vec4 colour = tessera_sample_surface(uv, normal, tangent, direction, footprint);
//
//   from_centre   from the sphere's centre to the point on its surface; any length above 0
//   uv            position in the atlas, 0..1
//   normal        interpolated between the vertices; of any length
//   tangent       mesh_tangents() (format/surface_mesh.h), interpolated; of any length
//   direction     of unit length, from the surface to the observer, who is inside the sphere where
//                 the file says so
//   footprint     texels of the atlas along u and v that a pixel covers; it selects the mips
//   result        linear mix of the stored texels; transfer functions are not undone. Grey textures
//                 give the same value in all three colours; alpha is 1 where a texture has none.
//
// Bindings, and the macros that move them when they are defined before the include. In Vulkan
// buffers are in set 0, textures in set 2 and uniform blocks in set 3.
//   TESSERA_BINDING_SAMPLER     4  storage buffer: sizes, page table, coarse texels
//   TESSERA_BINDING_MARKS       5  storage buffer, written, one word per tile: tile cache only.
//                                  Several textures share it. Its default is then 4 + N.
//   TESSERA_BINDING_PARAMETERS  2  uniform block: the first 128 bytes of SAMPLER
//   TESSERA_UNIT_TEXELS         0  sampler2DArray
//   TESSERA_UNIT_SAMPLER       12  the linear sampler, where it is apart from the texture
// The host class SampledTexture (gl_sampled_texture.h) fills and binds them.
//
// With TESSERA_TEXTURES defined as N, there are N textures, all plain or all with tile caches. Their
// bindings count up from those above, and tsr_select(i) chooses the one that is sampled, which must be the same in all
// invocations. OpenGL ES, HLSL, MSL and WGSL share one storage buffer and one uniform block between
// the textures: see texture_list.glsl.
//
// With a tile cache, a sample of a missing tile returns coarse texels and marks the tile, so that
// the host decodes it.
#ifndef TSR_SAMPLE
#define TSR_SAMPLE
#ifndef TESSERA_BINDING_SAMPLER
#define TESSERA_BINDING_SAMPLER 4
#endif
#if !defined(TESSERA_BINDING_MARKS) && defined(TESSERA_TEXTURES)
#define TESSERA_BINDING_MARKS (TESSERA_BINDING_SAMPLER + TESSERA_TEXTURES)
#elif !defined(TESSERA_BINDING_MARKS)
#define TESSERA_BINDING_MARKS 5
#endif
#ifndef TESSERA_BINDING_PARAMETERS
#define TESSERA_BINDING_PARAMETERS 2
#endif
#ifndef TESSERA_UNIT_TEXELS
#define TESSERA_UNIT_TEXELS 0
#endif
#ifndef TESSERA_UNIT_SAMPLER
#define TESSERA_UNIT_SAMPLER 12
#endif
#include "dialect.glsl"
#include "sampler_layout.glsl"
#include "surface.glsl"
#include "octahedral.glsl"

// The parameters are the first words of the sampler again. Pixels share reads of uniforms, but each
// pixel reads words of a buffer itself.
#if defined(TSR_TRANSLATED) && defined(TESSERA_HARDWARE_FILTER)
layout(TSR_TEXTURE(TESSERA_UNIT_SAMPLER)) uniform sampler tsr_linear_sampler;
#endif
#if defined(TESSERA_TEXTURES) && (defined(TSR_TRANSLATED) || defined(TSR_ES310))
#include "texture_list.glsl"
#else
#ifdef TESSERA_TEXTURES
const int tsr_textures = TESSERA_TEXTURES;
int tsr_selected = 0;
void tsr_select(int texture_number) {
    tsr_selected = texture_number;
}
layout(std430, binding = TESSERA_BINDING_SAMPLER) restrict readonly buffer TesseraSampler {
    uint words[];
}
tsr_samplers[TESSERA_TEXTURES];
layout(std140, TSR_UNIFORMS(TESSERA_BINDING_PARAMETERS)) uniform TesseraParameters {
    uvec4 fours[tsr_sampler_words / 4];
}
tsr_all_parameters[TESSERA_TEXTURES];
layout(TSR_TEXTURE(TESSERA_UNIT_TEXELS)) uniform highp sampler2DArray
    tsr_all_texels[TESSERA_TEXTURES];
#define tsr_sampler tsr_samplers[tsr_selected].words
#define tsr_parameters tsr_all_parameters[tsr_selected].fours
#define tsr_texels tsr_all_texels[tsr_selected]
#else
const int tsr_textures = 1;
void tsr_select(int texture_number) {}
layout(std430, binding = TESSERA_BINDING_SAMPLER) restrict readonly buffer TesseraSampler {
    uint tsr_sampler[];
};
layout(std140, TSR_UNIFORMS(TESSERA_BINDING_PARAMETERS)) uniform TesseraParameters {
    uvec4 tsr_parameters[tsr_sampler_words / 4];
};
layout(TSR_TEXTURE(TESSERA_UNIT_TEXELS)) uniform highp TSR_TEXTURE_TYPE tsr_texels;
#endif

uint tsr_word(int i) {
    return tsr_sampler[i];
}
uvec4 tsr_parameters_from(int field) {
    return tsr_parameters[field >> 2];
}
vec4 tsr_texel(ivec3 at) {
    return texelFetch(tsr_texels, at, 0);
}
#ifdef TESSERA_HARDWARE_FILTER
vec4 tsr_filtered_texel(vec3 place) {
    return textureLod(TSR_WITH_SAMPLER(tsr_texels), place, 0.0);
}
#endif
#endif

uint tsr_parameter(int field) {
    return tsr_parameters_from(field)[field & 3];
}
ivec4 tsr_four(int field) {
    return ivec4(tsr_parameters_from(field));
}

// Unpacks a texel: 8-bit samples in the first word, or halves in both.
vec4 tsr_unpack(uint low, uint high) {
    if (tsr_parameter(tsr_p_half) != 0u) {
        vec2 a = unpackHalf2x16(low);
        vec2 b = unpackHalf2x16(high);
        return vec4(a.x, a.y, b.x, b.y);
    }
    return unpackUnorm4x8(low);
}

// The word of a texel on the axis of u (0) or v (1), see sampler_layout.glsl, and its fields.
uint tsr_axis(int axis, int texel) {
    return tsr_word(int(tsr_parameter(tsr_p_axis_at + axis)) + texel);
}
int tsr_axis_tile(uint word) {
    return int(word & 0xFFFFu);
}
int tsr_axis_place(uint word) {
    return int(word >> tsr_axis_place_at) & (tsr_axis_places - 1);
}
int tsr_axis_mip(uint word) {
    return int(word >> tsr_axis_mip_at);
}
// Texels of the word's tile along the axis.
int tsr_axis_extent(int axis, uint word) {
    return int(tsr_parameter(tsr_p_size + axis) / tsr_parameter(tsr_p_tiles + axis)) +
           int((word >> tsr_axis_longer_at) & 1u);
}

vec4 tsr_mix4(vec4 a, vec4 b, vec4 c, vec4 d, vec2 weight) {
    return mix(mix(a, b, weight.x), mix(c, d, weight.x), weight.y);
}
// The shares of the four texels in that mix, and a sum by shares.
vec4 tsr_shares(vec2 weight) {
    vec2 rest = vec2(1.0) - weight;
    return vec4(rest.x * rest.y, weight.x * rest.y, rest.x * weight.y, weight.x * weight.y);
}
vec4 tsr_sum4(vec4 a, vec4 b, vec4 c, vec4 d, vec4 shares) {
    return a * shares.x + b * shares.y + c * shares.z + d * shares.w;
}

// Four texels of an angular image, and their shares. `neighbours`: x and y, and x and z, are
// adjacent or, at an edge, the same.
struct TsrAngularTaps {
    ivec4 s;
    ivec4 t;
    vec4 shares;
    bool neighbours;
};

TsrAngularTaps tsr_taps(TsrAngularFootprint f) {
    return TsrAngularTaps(ivec4(f.low.x, f.high.x, f.low.x, f.high.x),
                          ivec4(f.low.y, f.low.y, f.high.y, f.high.y), tsr_shares(f.weight), true);
}

// How far the mix of neighbours lies from the first one, in texels. Where two are the same texel,
// it must not reach the texel beside it.
vec2 tsr_beyond(TsrAngularTaps taps) {
    return vec2(taps.s.x == taps.s.y ? 0.0 : taps.shares.y + taps.shares.w,
                taps.t.x == taps.t.z ? 0.0 : taps.shares.z + taps.shares.w);
}

vec4 tsr_fetched(ivec3 image, ivec4 s, ivec4 t, vec4 shares) {
    return tsr_sum4(tsr_texel(image + ivec3(s.x, t.x, 0)),
                    tsr_texel(image + ivec3(s.y, t.y, 0)),
                    tsr_texel(image + ivec3(s.z, t.z, 0)),
                    tsr_texel(image + ivec3(s.w, t.w, 0)), shares);
}

#ifdef TESSERA_HARDWARE_FILTER
// A mix by the texture unit, `beyond` texels from the centre of a pixel.
vec4 tsr_filtered(ivec3 pixel, vec2 beyond) {
    vec2 size = vec2(float(tsr_parameter(tsr_p_width)), float(tsr_parameter(tsr_p_height)));
    vec2 place = (vec2(float(pixel.x), float(pixel.y)) + vec2(0.5) + beyond) / size;
    return tsr_filtered_texel(vec3(place.x, place.y, float(pixel.z)));
}
#endif

// Work that few pixels need is in loops which most pixels do not enter. Some devices, llvmpipe
// among them, spend the time of both sides of an `if`, but only one short round of such a loop.

#ifdef TESSERA_RESIDENT_CACHE
#include "sample_cache.glsl"
#else
#include "sample_plain.glsl"
#endif

TsrAngularTaps tsr_taps_of(int u, int v, ivec4 size, vec3 direction) {
    return tsr_taps(tsr_angular_footprint(ivec2(u, v), ivec2(size.x, size.y),
                                          ivec2(size.z, size.w), tsr_parameter(tsr_p_inside) != 0u,
                                          direction));
}

vec4 tessera_sample(vec3 from_centre, vec3 direction) {
    ivec4 size = tsr_four(tsr_p_size);
    TsrSurfaceFootprint f = tsr_surface_footprint(from_centre, ivec2(size.x, size.y));
    // Each of the four surface texels has its own frame, and so its own angles.
    return tsr_four_images(f, tsr_shares(f.weight),
                           tsr_taps_of(f.low.x, f.low.y, size, direction),
                           tsr_taps_of(f.high.x, f.low.y, size, direction),
                           tsr_taps_of(f.low.x, f.high.y, size, direction),
                           tsr_taps_of(f.high.x, f.high.y, size, direction));
}

uint tsr_mip_word(int mip, int field) {
    return tsr_word(int(tsr_parameter(tsr_p_mip_at) + uint(mip * tsr_mip_words + field)));
}
uint tsr_chart(int mip, ivec2 texel) {
    uint width = tsr_mip_word(mip, tsr_mip_size) & 0xFFFFu;
    uint at = uint(texel.y) * width + uint(texel.x);
    uint halves = tsr_mip_word(mip, tsr_mip_halves);
    uint word = tsr_word(int(tsr_mip_word(mip, tsr_mip_charts) + (at >> halves)));
    return halves == 0u ? word : (word >> ((at & 1u) * 16u)) & 0xFFFFu;
}

// The texels around a position in a mip, and their shares. Only texels of the position's own chart
// count. Where the mip has none of them, the texels of the atlas are used.
struct TsrMipFootprint {
    TsrSurfaceFootprint f; // texels as the axes count them
    vec4 shares;
};

TsrMipFootprint tsr_mip_footprint(vec2 uv, int mip) {
    ivec2 size = ivec2(int(tsr_parameter(tsr_p_size)), int(tsr_parameter(tsr_p_size + 1)));
    TsrMipFootprint m;
    m.f = tsr_atlas_footprint(uv, size);
    m.shares = tsr_shares(m.f.weight);
    vec2 place = clamp(uv, vec2(0.0), vec2(1.0)) * vec2(float(size.x), float(size.y));
    TsrSurfaceFootprint f = m.f; // in the mip
    uint own = 0u;
    vec4 shares = vec4(0.0);
    // Round 0 finds the chart at the position, rounds 1 to 4 the texels around it in the mip.
    for (int k = mip > 0 ? 0 : 5; k < 5; ++k) {
        ivec2 texel = ivec2(clamp(int(place.x), 0, size.x - 1), clamp(int(place.y), 0, size.y - 1));
        if (k > 0)
            texel = ivec2((k & 1) != 0 ? f.low.x : f.high.x, k < 3 ? f.low.y : f.high.y);
        uint chart = tsr_chart(k == 0 ? 0 : mip, texel);
        if (k == 0) {
            own = chart;
            uint sides = tsr_mip_word(mip, tsr_mip_size);
            ivec2 side = ivec2(int(sides & 0xFFFFu), int(sides >> 16));
            f = tsr_atlas_footprint(place / float(1 << mip) / vec2(float(side.x), float(side.y)),
                                    side);
        } else if (chart == own) {
            vec4 all = tsr_shares(f.weight);
            shares += vec4(k == 1 ? all.x : 0.0, k == 2 ? all.y : 0.0, k == 3 ? all.z : 0.0,
                           k == 4 ? all.w : 0.0);
        }
    }
    float sum = shares.x + shares.y + shares.z + shares.w;
    if (own != 0u && sum > 0.0) {
        ivec2 begin = ivec2(int(tsr_mip_word(mip, tsr_mip_u)), int(tsr_mip_word(mip, tsr_mip_v)));
        m.f.low = f.low + begin;
        m.f.high = f.high + begin;
        m.shares = shares / sum;
    }
    return m;
}

// The mip to sample; two mips are mixed in between. It is half a level finer than the shorter side
// of the footprint, but such that the longer side covers at most four texels (AtlasMips::mip_for).
float tsr_mip_for(vec2 footprint) {
    float covered =
        max(min(footprint.x, footprint.y) * 0.70710678, max(footprint.x, footprint.y) / 4.0);
    return covered > 1.0 ? min(log2(covered), float(tsr_parameter(tsr_p_mips))) : 0.0;
}

TsrAngularTaps tsr_folded_taps(TsrOctahedralTaps taps, ivec2 angular) {
    ivec2 a = tsr_folded(taps.first, angular);
    ivec2 b = tsr_folded(taps.first + ivec2(1, 0), angular);
    ivec2 c = tsr_folded(taps.first + ivec2(0, 1), angular);
    ivec2 d = tsr_folded(taps.first + ivec2(1, 1), angular);
    return TsrAngularTaps(ivec4(a.x, b.x, c.x, d.x), ivec4(a.y, b.y, c.y, d.y),
                          tsr_shares(taps.weight), false);
}

// The texels around a direction of unit length in the frame.
TsrAngularTaps tsr_taps_towards(TsrMeshFrame frame, vec3 direction) {
    ivec4 size = tsr_four(tsr_p_size);
    ivec2 angular = ivec2(size.z, size.w);
    int map = int(tsr_parameter(tsr_p_angular_map));
    TsrOctahedralTaps octahedral =
        tsr_octahedral_taps(tsr_octahedral_place(map, frame, direction), angular);
    if (map == tsr_map_mirrored && tsr_crosses_fold(octahedral, angular))
        return tsr_folded_taps(octahedral, angular);
    return tsr_taps(tsr_ended(octahedral, angular));
}

// A mix of two mips, by the footprint in texels, for the same angular texels everywhere.
vec4 tsr_sample_atlas(vec2 uv, TsrAngularTaps taps, vec2 footprint) {
    float mip = tsr_mip_for(footprint);
    int first = int(mip);
    float second = mip - float(first); // share of the next mip
    vec4 colour = vec4(0.0);
    for (int i = 0; i <= (second > 0.0 ? 1 : 0); ++i) {
        TsrMipFootprint m = tsr_mip_footprint(uv, first + i);
        colour += (i == 0 ? 1.0 - second : second) *
                  tsr_four_images(m.f, m.shares, taps, taps, taps, taps);
    }
    return colour;
}

vec4 tessera_sample_surface(vec2 uv, vec3 normal, vec3 tangent, vec3 direction, vec2 footprint) {
    return tsr_sample_atlas(
        uv, tsr_taps_towards(tsr_mesh_frame(normal, tangent, direction), direction), footprint);
}

#endif
