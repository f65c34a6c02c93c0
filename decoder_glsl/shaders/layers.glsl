// The light of a surface with layers: FORMAT.md 5.6 in single precision. Tests compare it with
// format/layers.h, which is the same in double precision. It keeps to the subset of surface.glsl.
#include "octahedral.glsl"

// The sample of a normal layer that stands for 0.
const float tsr_flat_sample = 128.0f;
const float tsr_least_coverage = 0.5f; // below, there is no surface
const float tsr_full_opacity = 254.0f / 255.0f; // from it on, nothing behind is seen
const float tsr_least_cosine = 0.02f; // between a normal and the direction to the observer
const float tsr_least_roughness = 0.03f;
const float tsr_spread_share = 0.75f; // of a light's spread that widens the highlight
const float tsr_first_lobe = 0.05f;   // roughness of the first lobe of the environment
const float tsr_sharp_roughness = 0.1f; // up to it, the environment replaces lights
const float tsr_rough_roughness = 0.4f;  // from it on, it does not
const float tsr_little_light = 1e-6f; // where no light is mirrored, the environment is not blocked

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

// The value of a sample of a layer of differences, without its scale: -1 to 1.
vec3 tsr_signed_value(vec3 texel) {
    return clamp((texel * 255.0f - vec3(tsr_flat_sample)) / 127.0f, -1.0f, 1.0f);
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

// The specular light of a light source that is not blocked.
vec3 tsr_light_of(TsrReflectance r, TsrLight light) {
    float nv = dot(r.normal, r.view);
    // The part of the light that is above the horizon, with the names of FORMAT.md; p is doubled.
    float k = clamp(10.0f * r.roughness - 1.5f, 0.0f, 1.0f);
    float p = 2.0f * k * light.spread;
    float z = dot(r.normal, light.direction);
    float above = min(0.6f + z / max(1.5f * p, 1e-6f), 1.0f);
    if (min(above, nv) <= 0.0f)
        return vec3(0.0f);
    float up = 0.5f * (z + sqrt(z * z + p * p));
    vec3 l = normalize(light.direction + (up - z) * r.normal);
    float nl = max(dot(r.normal, l), 0.0f);
    vec3 h = normalize(l + r.view);
    float rough = max(r.roughness, tsr_least_roughness);
    float alpha = rough * rough;
    float s2 = alpha * alpha;
    float half_cosine = clamp(dot(r.view, h), 0.0f, 1.0f);
    // Light that moves across the plane of its direction and the view turns the microfacet by more
    // than light that moves along it: aslant, a patch of light is mirrored as if it were wide.
    float along = tsr_spread_share * light.spread;
    float across = along / max(1.0f - k * (1.0f - half_cosine), 0.01f);
    float along2 = min(s2 + along * along, 1.0f);
    float across2 = min(s2 + across * across, 1.0f);
    // 1 - nh^2 would lose most of its digits in a sharp highlight.
    float nh = min(dot(r.normal, h), 1.0f);
    vec3 sine = cross(r.normal, h);
    vec3 axis = cross(l, r.view);
    float side = dot(r.normal, axis);
    float x2 = side * side / max(dot(axis, axis), 1e-12f);
    float root = nh * nh + max(dot(sine, sine) - x2, 0.0f) / along2 + x2 / across2;
    float density = 1.0f / (tsr_pi * sqrt(along2 * across2) * root * root);
    float visibility =
        0.5f / (nl * sqrt(s2 + (1.0f - s2) * nv * nv) + nv * sqrt(s2 + (1.0f - s2) * nl * nl));
    return mix(r.specular, vec3(1.0f), tsr_fifth_power(1.0f - half_cosine)) *
           (above * density * visibility * nl) * light.irradiance;
}

// The polynomial with these coefficients, in ascending order.
float tsr_cubic(vec4 ascending, float x) {
    return ascending.x + x * (ascending.y + x * (ascending.z + x * ascending.w));
}

// The factor of the light in the layer of reflections. The numbers are those of FORMAT.md 5.6.
vec3 tsr_reflection_share(TsrReflectance r) {
    float q = max(r.roughness, tsr_least_roughness);
    float c = clamp(dot(r.normal, r.view), 0.0f, 1.0f);
    vec4 scale = vec4(tsr_cubic(vec4(0.005f, 4.342f, -6.276f, 2.906f), c),
                      tsr_cubic(vec4(1.07f, -7.577f, 16.225f, -9.22f), c),
                      tsr_cubic(vec4(1.467f, -4.067f, -5.616f, 6.752f), c),
                      tsr_cubic(vec4(-1.745f, 6.274f, -3.532f, -0.735f), c));
    vec4 bias = vec4(tsr_cubic(vec4(1.048f, -4.432f, 6.109f, -2.742f), c),
                     tsr_cubic(vec4(-2.27f, 12.147f, -19.452f, 9.669f), c),
                     tsr_cubic(vec4(1.162f, -10.616f, 20.845f, -11.548f), c),
                     tsr_cubic(vec4(0.126f, 2.675f, -7.248f, 4.528f), c));
    return r.specular * clamp(tsr_cubic(scale, q), 0.0f, 1.0f) +
           vec3(clamp(tsr_cubic(bias, q), 0.0f, 1.0f));
}

// The lobe of the layer of the environment that a place mirrors, as the number of a texel along u.
float tsr_environment_lobe(TsrReflectance r, float lobes) {
    float roughness = r.roughness * sqrt(clamp(dot(r.normal, r.view), 0.0f, 1.0f));
    return clamp(log2(max(roughness, tsr_first_lobe) / tsr_first_lobe), 0.0f, lobes - 1.0f);
}

// The specular light of several lights.
struct TsrLightSum {
    vec3 points;    // of lights without spread
    vec3 patches;   // of the other lights
    vec3 unblocked; // of those, if nothing blocked them
};

// `specular`: the light of a light that is not blocked, of which the share `seen` arrives
TsrLightSum tsr_with_light(TsrLightSum sum, float spread, vec3 specular, float seen) {
    float patched = spread > 0.0f ? 1.0f : 0.0f;
    return TsrLightSum(sum.points + (1.0f - patched) * seen * specular,
                       sum.patches + patched * seen * specular,
                       sum.unblocked + patched * specular);
}

// All light, where `environment` is that of the layer, times the reflectance for it.
vec3 tsr_with_environment(TsrLightSum sum, vec3 environment, float roughness) {
    float share = clamp((roughness - tsr_sharp_roughness) /
                            (tsr_rough_roughness - tsr_sharp_roughness), 0.0f, 1.0f);
    vec3 seen = (sum.patches + vec3(tsr_little_light)) / (sum.unblocked + vec3(tsr_little_light));
    return sum.points + share * sum.patches + (1.0f - share) * seen * environment;
}
