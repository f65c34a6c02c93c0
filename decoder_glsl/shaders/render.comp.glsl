// Draws a view of a textured sphere, one invocation per pixel.
#include "sample.glsl"
#include "view.glsl"

layout(rgba32f, TSR_IMAGE(0)) writeonly uniform highp image2DArray tsr_picture;

layout(local_size_x = 8, local_size_y = 8) in;
void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x < tsr_pixels.x && pixel.y < tsr_pixels.y)
        imageStore(tsr_picture, ivec3(pixel.x, pixel.y, 0), tsr_view_colour(pixel));
}
