// The light of a surface with layers: FORMAT.md 5.6 in single precision. Tests compare it with
// format/layers.h, which is the same in double precision. It keeps to the subset of surface.glsl.
#include "octahedral.glsl"

// The sample of a normal layer that stands for 0.
const float tsr_flat_sample = 128.0f;
const float tsr_least_cosine = 0.02f; // between a normal and the direction to the observer
const float tsr_least_roughness = 0.03f;
const float tsr_spread_share = 0.75f; // of a light's spread that widens the highlight

// How a place reflects light towards an observer. All vectors have unit length and point away from
// the surface.
struct TsrReflectance {
    vec3 normal;
    vec3 view;
    vec3 specular; // at normal incidence
    float roughness;
};

// Distant light from a patch of directions.
struct TsrLight {
    vec3 direction; // unit vector towards the light
    float spread;   // radians
    vec3 irradiance;
};

float tsr_fifth_power(float x) {
    float square = x * x;
    return square * square * x;
}

// Light of a value with transfer sRGB.
float tsr_linear(float x) {
    return x <= 0.04045f ? x / 12.92f : pow((x + 0.055f) / 1.055f, 2.4f);
}

// The display value of light, 0..1.
float tsr_displayed(float light) {
    float x = clamp(light, 0.0f, 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * pow(x, 1.0f / 2.4f) - 0.055f;
}

// The bumped normal of unit length. `value`: both channels of the normal layer, 0..1.
vec3 tsr_bumped_normal(TsrMeshFrame frame, vec2 value) {
    vec2 xy = (value * 255.0f - vec2(tsr_flat_sample)) / 127.0f;
    float square = dot(xy, xy);
    if (square > 1.0f)
        xy = xy / sqrt(square);
    float z = sqrt(max(0.0f, 1.0f - square));
    return normalize(frame.x * xy.x + cross(frame.z, frame.x) * xy.y + frame.z * z);
}

// The normal bent towards the observer, in direction `view`, where it would face away.
vec3 tsr_facing_normal(vec3 normal, vec3 view) {
    float cosine = dot(normal, view);
    return cosine < tsr_least_cosine ? normalize(normal + (tsr_least_cosine - cosine) * view)
                                     : normal;
}

// The factor of diffuse light.
float tsr_diffuse_share(TsrReflectance r) {
    return 1.0f - tsr_fifth_power(1.0f - 0.5f * clamp(dot(r.normal, r.view), 0.0f, 1.0f));
}

// The specular light of a light source that is not blocked.
vec3 tsr_light_of(TsrReflectance r, TsrLight light) {
    float nl = dot(r.normal, light.direction);
    float nv = dot(r.normal, r.view);
    if (nl <= 0.0f || nv <= 0.0f)
        return vec3(0.0f);
    vec3 h = normalize(light.direction + r.view);
    float rough = max(r.roughness, tsr_least_roughness);
    float alpha = rough * rough;
    float wide = tsr_spread_share * light.spread;
    float a2 = min(alpha * alpha + wide * wide, 1.0f);
    // nh^2 (a2 - 1) + 1, where 1 - nh^2 is the square of a sine: the difference would lose most of
    // its digits in a sharp highlight.
    float nh = min(dot(r.normal, h), 1.0f);
    vec3 sine = cross(r.normal, h);
    float root = nh * nh * a2 + dot(sine, sine);
    float density = a2 / (tsr_pi * root * root);
    float s2 = alpha * alpha;
    float visibility =
        0.5f / (nl * sqrt(s2 + (1.0f - s2) * nv * nv) + nv * sqrt(s2 + (1.0f - s2) * nl * nl));
    float fresnel = tsr_fifth_power(1.0f - clamp(dot(r.view, h), 0.0f, 1.0f));
    return (r.specular + (vec3(1.0f) - r.specular) * fresnel) * (density * visibility * nl) *
           light.irradiance;
}

// The factor of the light in the layer of reflections.
vec3 tsr_reflection_share(TsrReflectance r) {
    float rough = max(r.roughness, tsr_least_roughness);
    float nv = clamp(dot(r.normal, r.view), 0.0f, 1.0f);
    float x = 1.0f - rough;
    float a = min(x * x, exp2(-9.28f * nv)) * x + 0.0425f - 0.0275f * rough;
    float scale = 1.04f - 0.572f * rough - 1.04f * a;
    float bias = 0.022f * rough - 0.04f + 1.04f * a;
    return r.specular * scale + vec3(bias);
}
