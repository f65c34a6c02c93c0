// A pinhole camera that looks at a textured sphere, from outside or from inside.
layout(std140, TSR_UNIFORMS(0)) uniform TesseraView {
    vec4 tsr_eye;     // xyz relative to the sphere's centre; w the sphere's radius
    vec4 tsr_right;   // half the picture's width, at distance 1
    vec4 tsr_up;      // half its height
    vec4 tsr_forward; // unit length
    vec4 tsr_outside; // colour of rays that miss the sphere
    ivec4 tsr_pixels; // width, height; z is 1 if the camera is in the sphere
};

// The picture's colour at a pixel, row 0 at the top.
vec4 tsr_view_colour(ivec2 pixel) {
    vec2 at = (vec2(float(pixel.x), float(pixel.y)) + vec2(0.5)) /
                  vec2(float(tsr_pixels.x), float(tsr_pixels.y)) * 2.0 -
              vec2(1.0);
    vec3 ray = normalize(tsr_forward.xyz + at.x * tsr_right.xyz - at.y * tsr_up.xyz);
    // Starts at the ray's point nearest to the centre, because the usual quadratic formula is
    // inexact from far away.
    float along = -dot(tsr_eye.xyz, ray);
    vec3 nearest = tsr_eye.xyz + along * ray;
    float rest = tsr_eye.w * tsr_eye.w - dot(nearest, nearest);
    bool inside = tsr_pixels.z != 0;
    if (rest < 0.0 || (along <= 0.0 && !inside))
        return tsr_outside;
    return tessera_sample(nearest + (inside ? sqrt(rest) : -sqrt(rest)) * ray, -ray);
}
