// Draws the same view as render.comp, as an engine would in a fragment shader.
#include "sample.glsl"
#include "view.glsl"

layout(location = 0) out vec4 tsr_colour;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    // Row 0 of a framebuffer is at the bottom.
    tsr_colour = tsr_view_colour(ivec2(pixel.x, tsr_pixels.y - 1 - pixel.y));
}
