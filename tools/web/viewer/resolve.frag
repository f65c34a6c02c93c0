// Writes the mean of the rays of each pixel, converted for the display.
uniform highp sampler2DArray rays;
uniform int count;
uniform bool toneMapped; // for half floats: sRGB of x / (1 + x)
layout(location = 0) out vec4 result;

float shown(float x) {
    float y = x > 0.0 ? x / (1.0 + x) : 0.0;
    return y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1.0 / 2.4) - 0.055;
}

void main() {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i)
        sum += texelFetch(rays, ivec3(gl_FragCoord.xy, i), 0).rgb;
    vec3 colour = sum / float(count);
    result = vec4(toneMapped ? vec3(shown(colour.r), shown(colour.g), shown(colour.b)) : colour, 1.0);
}
