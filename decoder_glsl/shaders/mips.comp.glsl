// The mips of a tile of the atlas (FORMAT.md 5.2): means over the texels of one chart in each square. A
// group is a texel of a mip with all its directions.
//
// A job is eight words: page of the tile (CACHE), its first texel of the atlas u, v, its extents
// u | v << 16, then s | t << 16: the first direction in its angular images, and how many; two unused.
#include "dialect.glsl"
layout(std430, binding = 1) readonly buffer TesseraJobs { uint tsr_jobs[]; };
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

// The first pixel of an angular image; u and v as the axes count the texels of all mips.
ivec3 tsr_corner(uint page, int u, int v) {
    uint across = tsr_sampler[int(tsr_sampler[tsr_p_axis_at]) + u];
    uint up = tsr_sampler[int(tsr_sampler[tsr_p_axis_at + 1]) + v];
#ifdef TESSERA_RESIDENT_CACHE
    int x = int(across >> tsr_axis_place_at) & (tsr_axis_places - 1);
    int y = int(up >> tsr_axis_place_at) & (tsr_axis_places - 1);
    return ivec3(int(page & 1023u) * int(tsr_sampler[tsr_p_slot_width]) +
                     x * int(tsr_sampler[tsr_p_stride_s]),
                 int((page >> 10) & 1023u) * int(tsr_sampler[tsr_p_slot_height]) +
                     y * int(tsr_sampler[tsr_p_stride_t]),
                 int(page >> 20));
#else
    return ivec3(int(across & 0xFFFFu), int(up & 0xFFFFu),
                 int((up >> 16) * tsr_sampler[tsr_p_folds_u] + (across >> 16)));
#endif
}

int tsr_mip_word(int mip, int field) {
    return int(tsr_sampler[int(tsr_sampler[tsr_p_mip_at]) + mip * tsr_mip_words + field]);
}
uint tsr_chart(int mip, int u, int v) {
    return tsr_sampler[tsr_mip_word(mip, 3) + v * (tsr_mip_word(mip, 2) & 0xFFFF) + u];
}

layout(local_size_x = 64) in;
void main() {
    int job = int(gl_WorkGroupID.y) * 8;
    uint page = tsr_jobs[job];
    ivec2 begin = ivec2(int(tsr_jobs[job + 1]), int(tsr_jobs[job + 2]));
    ivec2 extent = ivec2(int(tsr_jobs[job + 3] & 0xFFFFu), int(tsr_jobs[job + 3] >> 16));
    ivec2 first = ivec2(int(tsr_jobs[job + 4] & 0xFFFFu), int(tsr_jobs[job + 4] >> 16));
    ivec2 count = ivec2(int(tsr_jobs[job + 5] & 0xFFFFu), int(tsr_jobs[job + 5] >> 16));
    // Which texel of which mip.
    int left = int(gl_WorkGroupID.x);
    int mip = 1;
    ivec2 side = ivec2((extent.x + 1) >> 1, (extent.y + 1) >> 1);
    while (mip <= int(tsr_sampler[tsr_p_mips]) && left >= side.x * side.y) {
        left -= side.x * side.y;
        ++mip;
        side = ivec2((extent.x + (1 << mip) - 1) >> mip, (extent.y + (1 << mip) - 1) >> mip);
    }
    if (mip > int(tsr_sampler[tsr_p_mips]))
        return;
    ivec2 at = ivec2((begin.x >> mip) + left % side.x, (begin.y >> mip) + left / side.x);
    uint own = tsr_chart(mip, at.x, at.y);
    if (own == 0u)
        return;
    ivec2 low = ivec2(at.x << mip, at.y << mip);
    ivec2 high = ivec2(min(low.x + (1 << mip), begin.x + extent.x),
                       min(low.y + (1 << mip), begin.y + extent.y));
    ivec3 to = tsr_corner(page, tsr_mip_word(mip, 0) + at.x, tsr_mip_word(mip, 1) + at.y);
    for (int i = int(gl_LocalInvocationIndex); i < count.x * count.y; i += 64) {
        ivec3 angle = ivec3(first.x + i % count.x, first.y + i / count.x, 0);
#ifdef TSR_OUTPUT_HALF
        vec4 sum = vec4(0.0);
#else
        uvec4 sum = uvec4(0u);
#endif
        uint texels = 0u;
        for (int v = low.y; v < high.y; ++v)
            for (int u = low.x; u < high.x; ++u) {
                if (tsr_chart(0, u, v) != own)
                    continue;
                uvec4 pixel = imageLoad(tsr_from, tsr_corner(page, u, v) + angle);
#ifdef TSR_OUTPUT_HALF
                sum += vec4(unpackHalf2x16(pixel.x | (pixel.y << 16)),
                            unpackHalf2x16(pixel.z | (pixel.w << 16)));
#else
                sum += uvec4(pixel.x & 255u, (pixel.x >> 8) & 255u, (pixel.x >> 16) & 255u,
                             pixel.x >> 24);
#endif
                ++texels;
            }
#ifdef TSR_OUTPUT_HALF
        vec4 mean = sum / float(texels);
        uint low_two = packHalf2x16(mean.xy);
        uint high_two = packHalf2x16(mean.zw);
        imageStore(tsr_to, to + angle,
                   uvec4(low_two & 0xFFFFu, low_two >> 16, high_two & 0xFFFFu, high_two >> 16));
#else
        uvec4 mean = (2u * sum + texels) / (2u * texels);
        imageStore(tsr_to, to + angle,
                   uvec4(mean.x | (mean.y << 8) | (mean.z << 16) | (mean.w << 24), 0u, 0u, 0u));
#endif
    }
}
