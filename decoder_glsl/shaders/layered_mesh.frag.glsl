// Fragments of a mesh whose file has layers (FORMAT.md 5.6), as display values, or as linear light if
// there is a layer of opacity. The host defines TESSERA_TEXTURES and, for each layer besides the
// diffuse one, which is texture 0, a macro with the number of its texture: TESSERA_LAYER_EMISSION,
// _SPECULAR, _ROUGHNESS, _NORMAL, _VISIBILITY, _REFLECTION, _COVERAGE, _ENVIRONMENT, _DIFFERENCE,
// _SHARED_DIFFERENCE and _OPACITY. TESSERA_LIGHTS is the number of lights; it is not defined if there
// are none. With TESSERA_COVERAGE_ONLY, the program is for the pass that draws depths. It and the pass
// without further macros draw fragments that hide what is behind them. TESSERA_BLENDED is for a third
// pass, which draws the others from back to front. Its light is multiplied by the opacity. HLSL, MSL
// and WGSL have constants in place of these macros (layer_constants.glsl).
#include "layer_constants.glsl"
#include "sample.glsl"
#include "layers.glsl"

#ifndef TESSERA_COVERAGE_ONLY
layout(early_fragment_tests) in;
#endif

layout(std140, TSR_UNIFORMS(1)) uniform TesseraLayers {
    vec4 tsr_scales[tsr_textures]; // of each texture: x is the scale, y is 1 for transfer sRGB
#ifdef TESSERA_LIGHTS
    vec4 tsr_lights[2 * TSR_ROOM_FOR_LIGHTS]; // direction, spread; irradiance, peak of the visibility
#endif
};

layout(location = 0) in vec3 tsr_to_eye;
layout(location = 1) in vec3 tsr_surface_normal;
layout(location = 2) in vec3 tsr_surface_tangent;
layout(location = 3) in vec2 tsr_place;

layout(location = 0) out vec4 tsr_colour;

// The footprint in texels of a layer. covered: the pixel's share of the atlas along u and v
vec2 tsr_texels_covered(vec2 covered) {
    ivec4 size = tsr_four(tsr_p_size);
    return covered * vec2(float(size.x), float(size.y));
}

vec4 tsr_sample_layer(TsrAngularTaps taps, vec2 covered) {
    return tsr_sample_atlas(tsr_place, taps, tsr_texels_covered(covered));
}

// One texel of every angular image.
TsrAngularTaps tsr_one_direction(ivec2 texel) {
    return TsrAngularTaps(ivec4(texel.x), ivec4(texel.y), vec4(1.0, 0.0, 0.0, 0.0), true);
}

// The same for a layer of one direction, which it selects.
vec4 tsr_sample_flat(int layer, vec2 covered) {
    tsr_select(layer);
    return tsr_sample_layer(tsr_one_direction(ivec2(0)), covered);
}

// The linear value of a sample.
vec3 tsr_value(int layer, vec4 texel) {
    vec4 scale = tsr_scales[layer];
    vec3 value = texel.xyz;
    if (scale.y > 0.0)
        value = vec3(tsr_linear(value.x), tsr_linear(value.y), tsr_linear(value.z));
    return value * scale.x;
}

vec3 tsr_flat_value(int layer, vec2 covered) {
    return tsr_value(layer, tsr_sample_flat(layer, covered));
}

bool tsr_is_hole() {
#ifdef TESSERA_LAYER_COVERAGE
    if (TSR_IF(TESSERA_LAYER_COVERAGE))
        return tsr_sample_flat(TESSERA_LAYER_COVERAGE, vec2(0.0)).x < tsr_least_coverage;
#endif
    return false;
}

#ifdef TESSERA_LIGHTS
#ifdef TESSERA_LAYER_VISIBILITY
#ifdef TESSERA_RESIDENT_CACHE
// What all lights at a place have in common: the share of the atlas that the pixel covers.
struct TsrVisibility {
    vec2 covered;
};

TsrVisibility tsr_visibility(vec2 covered) {
    return TsrVisibility(covered);
}

// The stored visibility of a light, whose column and row in the angular images is given.
float tsr_seen(TsrVisibility visibility, ivec2 light) {
    return tsr_sample_layer(tsr_one_direction(light), visibility.covered).x;
}
#else
// The angular images around the place in one mip, and their shares.
struct TsrImages {
    ivec3 low_low;
    ivec3 high_low;
    ivec3 low_high;
    ivec3 high_high;
    vec4 shares;
};

TsrImages tsr_images(int mip, float share) {
    TsrMipFootprint m = tsr_mip_footprint(tsr_place, mip);
    return TsrImages(
        tsr_plain_pixel(m.f.low), tsr_plain_pixel(ivec2(m.f.high.x, m.f.low.y)),
        tsr_plain_pixel(ivec2(m.f.low.x, m.f.high.y)), tsr_plain_pixel(m.f.high), m.shares * share);
}

float tsr_seen_in(TsrImages images, ivec3 light) {
    return dot(images.shares, vec4(tsr_texel(images.low_low + light).x,
                                   tsr_texel(images.high_low + light).x,
                                   tsr_texel(images.low_high + light).x,
                                   tsr_texel(images.high_high + light).x));
}

// What all lights at a place have in common: the images in one mip or two.
struct TsrVisibility {
    TsrImages finer;
    TsrImages coarser;
    int mips;
};

TsrVisibility tsr_visibility(vec2 covered) {
    float mip = tsr_mip_for(tsr_texels_covered(covered));
    float second = mip - float(int(mip)); // share of the next mip
    TsrImages finer = tsr_images(int(mip), 1.0 - second);
    TsrImages coarser = finer;
    for (int i = second > 0.0 ? 0 : 1; i < 1; ++i)
        coarser = tsr_images(int(mip) + 1, second);
    return TsrVisibility(finer, coarser, second > 0.0 ? 2 : 1);
}

float tsr_seen(TsrVisibility visibility, ivec2 light) {
    ivec3 texel = ivec3(light, 0);
    float seen = tsr_seen_in(visibility.finer, texel);
    for (int i = 1; i < visibility.mips; ++i)
        seen += tsr_seen_in(visibility.coarser, texel);
    return seen;
}
#endif
#endif

// Dimmer lights give no highlight. Where their share decides how much of the environment is seen,
// all but the dimmest count.
float tsr_least_highlight() {
#ifdef TESSERA_LAYER_ENVIRONMENT
    if (TSR_IF(TESSERA_LAYER_ENVIRONMENT))
        return 1e-8f;
#endif
    return 1e-5f;
}

// The specular light of all lights.
TsrLightSum tsr_light_of_lights(TsrReflectance reflectance, vec2 covered) {
#ifdef TESSERA_LAYER_VISIBILITY
    bool blocked = TSR_IF(TESSERA_LAYER_VISIBILITY);
    tsr_select(blocked ? TESSERA_LAYER_VISIBILITY : 0);
    TsrVisibility visibility = tsr_visibility(covered);
    int columns = max(tsr_four(tsr_p_size).z, 1);
#endif
    TsrLightSum sum = TsrLightSum(vec3(0.0), vec3(0.0), vec3(0.0));
    for (int j = 0; j < TESSERA_LIGHTS; ++j) {
        vec4 direction = tsr_lights[2 * j];
        vec4 irradiance = tsr_lights[2 * j + 1];
        vec3 light = tsr_light_of(reflectance,
                                  TsrLight(direction.xyz, direction.w, irradiance.xyz));
        float share = 1.0;
#ifdef TESSERA_LAYER_VISIBILITY
        float seen = 0.0;
        // Most lights give no highlight here.
        bool skipped = !blocked || max(light.x, max(light.y, light.z)) < tsr_least_highlight();
        for (int i = skipped ? 1 : 0; i < 1; ++i)
            seen = tsr_seen(visibility, ivec2(j % columns, j / columns));
        if (blocked)
            share = min(seen / irradiance.w, 1.0);
#endif
        sum = tsr_with_light(sum, direction.w, light, share);
    }
    return sum;
}
#endif

#ifdef TESSERA_LAYER_ENVIRONMENT
// The light of the environment from the mirrored direction. frame.z: the bumped normal
vec3 tsr_environment(int layer, TsrMeshFrame frame, TsrReflectance r) {
    tsr_select(layer);
    float lobes = float(tsr_four(tsr_p_size).x);
    vec2 place = vec2((tsr_environment_lobe(r, lobes) + 0.5) / lobes, 0.5);
    vec3 root =
        tsr_value(layer, tsr_sample_atlas(place, tsr_taps_towards(frame, r.view), vec2(0.0)));
    return root * root / tsr_scales[layer].x;
}
#endif

#if defined(TESSERA_LAYER_DIFFERENCE) || defined(TESSERA_LAYER_SHARED_DIFFERENCE)
// What the display value changes by. mirror.z: the bumped normal
vec3 tsr_difference(int layer, TsrMeshFrame mirror, vec3 view, vec2 covered) {
    tsr_select(layer);
    vec4 texel = tsr_sample_layer(tsr_taps_towards(mirror, view), covered);
    return tsr_signed_value(texel.xyz) * tsr_scales[layer].x;
}
#endif

// The opacity of a fragment that this pass draws; 0 if it does not draw the fragment.
float tsr_opacity(vec2 covered) {
    if (tsr_is_hole())
        return 0.0;
    float opacity = 1.0;
#ifdef TESSERA_LAYER_OPACITY
    if (TSR_IF(TESSERA_LAYER_OPACITY))
        opacity = tsr_sample_flat(TESSERA_LAYER_OPACITY, covered).x;
    if (opacity >= tsr_full_opacity)
        opacity = TSR_BLENDS ? 0.0 : 1.0;
    else if (!TSR_BLENDS)
        opacity = 0.0;
#endif
    return opacity;
}

// The share of the atlas that the pixel covers along u and v.
vec2 tsr_covered() {
    vec2 across = dFdx(tsr_place);
    vec2 up = dFdy(tsr_place);
    return sqrt(across * across + up * up);
}

#ifdef TESSERA_COVERAGE_ONLY
void main() {
    if (tsr_opacity(tsr_covered()) <= 0.0)
        discard;
}
#else
void main() {
    vec2 covered = tsr_covered();
    float opacity = tsr_opacity(covered);
    if (opacity <= 0.0)
        discard;
    vec3 view = normalize(tsr_to_eye);
    TsrMeshFrame frame = tsr_mesh_frame(tsr_surface_normal, tsr_surface_tangent, view);
    vec3 normal = frame.z;
#ifdef TESSERA_LAYER_NORMAL
    // A texture of two channels holds the second one as alpha.
    if (TSR_IF(TESSERA_LAYER_NORMAL))
        normal = tsr_bumped_normal(frame, tsr_sample_flat(TESSERA_LAYER_NORMAL, covered).xw);
#endif
    normal = tsr_facing_normal(normal, view);
    TsrMeshFrame mirror = frame;
    mirror.z = normal;
    vec3 light = tsr_flat_value(0, covered);
    vec3 reflected = vec3(1.0);
#ifdef TESSERA_LAYER_SPECULAR
    if (TSR_IF(TESSERA_LAYER_SPECULAR)) {
        TsrReflectance reflectance =
            TsrReflectance(normal, view, tsr_flat_value(TESSERA_LAYER_SPECULAR, covered), 1.0);
#ifdef TESSERA_LAYER_ROUGHNESS
        if (TSR_IF(TESSERA_LAYER_ROUGHNESS))
            reflectance.roughness = tsr_flat_value(TESSERA_LAYER_ROUGHNESS, covered).x;
#endif
        reflected = tsr_reflection_share(reflectance);
#ifdef TESSERA_LIGHTS
        TsrLightSum sum = tsr_light_of_lights(reflectance, covered);
        vec3 highlights = sum.points + sum.patches;
#ifdef TESSERA_LAYER_ENVIRONMENT
        if (TSR_IF(TESSERA_LAYER_ENVIRONMENT))
            highlights = tsr_with_environment(
                sum,
                reflected * tsr_environment(TESSERA_LAYER_ENVIRONMENT, mirror, reflectance),
                reflectance.roughness);
#endif
        light += highlights;
#endif
    }
#endif
#ifdef TESSERA_LAYER_REFLECTION
    if (TSR_IF(TESSERA_LAYER_REFLECTION)) {
        tsr_select(TESSERA_LAYER_REFLECTION);
        vec4 mirrored = tsr_sample_layer(tsr_taps_towards(mirror, view), covered);
        light += reflected * tsr_value(TESSERA_LAYER_REFLECTION, mirrored);
    }
#endif
#ifdef TESSERA_LAYER_EMISSION
    if (TSR_IF(TESSERA_LAYER_EMISSION))
        light += tsr_flat_value(TESSERA_LAYER_EMISSION, covered);
#endif
    vec3 shown = vec3(tsr_displayed(light.x), tsr_displayed(light.y), tsr_displayed(light.z));
#ifdef TESSERA_LAYER_DIFFERENCE
    if (TSR_IF(TESSERA_LAYER_DIFFERENCE))
        shown += tsr_difference(TESSERA_LAYER_DIFFERENCE, mirror, view, covered);
#endif
#ifdef TESSERA_LAYER_SHARED_DIFFERENCE
    if (TSR_IF(TESSERA_LAYER_SHARED_DIFFERENCE))
        shown += tsr_difference(TESSERA_LAYER_SHARED_DIFFERENCE, mirror, view, covered);
#endif
    shown = clamp(shown, 0.0, 1.0);
#ifdef TESSERA_LAYER_OPACITY
    if (TSR_IF(TESSERA_LAYER_OPACITY)) {
#if defined(TESSERA_LAYER_DIFFERENCE) || defined(TESSERA_LAYER_SHARED_DIFFERENCE)
        light = vec3(tsr_linear(shown.x), tsr_linear(shown.y), tsr_linear(shown.z));
#endif
        shown = opacity * light;
    }
#endif
    tsr_colour = vec4(shown, opacity);
}
#endif
