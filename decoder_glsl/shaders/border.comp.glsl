// Copies the first texels of a tile's angular neighbours into the border of its angular images, so
// that filtering hardware finds them next to its own last ones. A group is 64 pixels of one strip.
//
// A strip is six words: page that it goes to, page that it comes from (or background), tile extents
// u | v << 16, then three pairs s | t << 16: first texel in either image, and how many.
#include "dialect.glsl"
layout(std430, binding = 1) readonly buffer TesseraStrips { uint tsr_strips[]; };
layout(std430, binding = 4) readonly buffer TesseraSampler { uint tsr_sampler[]; };
#include "layout.glsl"
#include "sampler_layout.glsl"

#ifdef TSR_OUTPUT_HALF
layout(rgba16ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_to;
layout(rgba16ui, TSR_IMAGE(1)) readonly uniform highp uimage2DArray tsr_from;
#else
layout(r32ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_to;
layout(r32ui, TSR_IMAGE(1)) readonly uniform highp uimage2DArray tsr_from;
#endif

uvec4 tsr_background_pixel() {
    uint low = tsr_sampler[tsr_p_background];
#ifdef TSR_OUTPUT_HALF
    uint high = tsr_sampler[tsr_p_background + 1];
    return uvec4(low & 0xFFFFu, low >> 16, high & 0xFFFFu, high >> 16);
#else
    return uvec4(low, 0u, 0u, 0u);
#endif
}

ivec3 tsr_pixel(uint page, int u, int v, int s, int t) {
    return ivec3(int(page & 1023u) * int(tsr_sampler[tsr_p_slot_width]) +
                     u * int(tsr_sampler[tsr_p_stride_s]) + s,
                 int((page >> 10) & 1023u) * int(tsr_sampler[tsr_p_slot_height]) +
                     v * int(tsr_sampler[tsr_p_stride_t]) + t,
                 int(page >> 20));
}

layout(local_size_x = 64) in;
void main() {
    int record = int(gl_WorkGroupID.y) * 6;
    int u_count = int(tsr_strips[record + 2] & 0xFFFFu);
    int v_count = int(tsr_strips[record + 2] >> 16);
    int s_count = int(tsr_strips[record + 5] & 0xFFFFu);
    int t_count = int(tsr_strips[record + 5] >> 16);
    int i = int(gl_GlobalInvocationID.x);
    if (i >= u_count * v_count * s_count * t_count)
        return;
    int s = i % s_count;
    int t = i / s_count % t_count;
    int image = i / (s_count * t_count);
    int u = image % u_count;
    int v = image / u_count;
    uint from = tsr_strips[record + 1];
    uvec4 pixel = tsr_background_pixel();
    if (from != tsr_page_background)
        pixel = imageLoad(tsr_from, tsr_pixel(from, u, v, int(tsr_strips[record + 4] & 0xFFFFu) + s,
                                              int(tsr_strips[record + 4] >> 16) + t));
    imageStore(tsr_to, tsr_pixel(tsr_strips[record], u, v, int(tsr_strips[record + 3] & 0xFFFFu) + s,
                                 int(tsr_strips[record + 3] >> 16) + t),
               pixel);
}
