// The same view as render.comp, drawn: how an engine would sample from a fragment shader.
#include "sample.glsl"
#include "view.glsl"

layout(location = 0) out vec4 tsr_colour;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    // Rows of a framebuffer begin at the bottom.
    tsr_colour = tsr_view_colour(ivec2(pixel.x, tsr_pixels.y - 1 - pixel.y));
}
