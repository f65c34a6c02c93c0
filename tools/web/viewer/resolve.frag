// Writes the mean of the rays of each pixel, converted for the display.
uniform highp sampler2DArray rays;
uniform int count;
uniform bool toneMapped; // for half floats: sRGB of x / (1 + x)
uniform bool linear; // the rays are linear light: the mean is that of their sRGB values
layout(location = 0) out vec4 result;

float srgb(float x) {
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}
float mapped(float x) {
    return srgb(x > 0.0 ? x / (1.0 + x) : 0.0);
}

void main() {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 ray = texelFetch(rays, ivec3(gl_FragCoord.xy, i), 0).rgb;
        sum += linear ? vec3(srgb(ray.r), srgb(ray.g), srgb(ray.b)) : ray;
    }
    vec3 colour = sum / float(count);
    result = vec4(toneMapped ? vec3(mapped(colour.r), mapped(colour.g), mapped(colour.b)) : colour, 1.0);
}
