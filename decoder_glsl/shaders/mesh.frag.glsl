// Fragments of a textured mesh. Depths are drawn in an earlier pass, so that hidden fragments mark
// no tiles.
#include "sample.glsl"

layout(early_fragment_tests) in;

layout(location = 0) in vec3 tsr_to_eye;
layout(location = 1) in vec3 tsr_surface_normal;
layout(location = 2) in vec3 tsr_surface_tangent;
layout(location = 3) in vec2 tsr_place;

layout(location = 0) out vec4 tsr_colour;

void main() {
    ivec4 size = tsr_four(tsr_p_size);
    vec2 texels = vec2(float(size.x), float(size.y));
    vec2 across = dFdx(tsr_place) * texels;
    vec2 up = dFdy(tsr_place) * texels;
    tsr_colour = tessera_sample_surface(tsr_place, tsr_surface_normal, tsr_surface_tangent,
                                        normalize(tsr_to_eye), sqrt(across * across + up * up));
}
