// Computes the mips of a tile of the atlas (FORMAT.md 5.2): each texel of a mip is the mean of the
// texels of its chart in a square of the atlas. A group computes one texel of a mip for all its
// directions.
#include "dialect.glsl"
layout(std430, binding = 1) readonly buffer TesseraJobs { uint tsr_jobs[]; };
layout(std430, binding = 4) readonly buffer TesseraSampler { uint tsr_sampler[]; };
#include "sampler_layout.glsl"

#ifdef TSR_OUTPUT_HALF
layout(rgba16ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_to;
layout(rgba16ui, TSR_IMAGE(1)) readonly uniform highp uimage2DArray tsr_from;
#else
layout(r32ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_to;
layout(r32ui, TSR_IMAGE(1)) readonly uniform highp uimage2DArray tsr_from;
#endif

// The first pixel of an angular image. u and v count the texels of all mips, as the axes do.
ivec3 tsr_corner(uint page, int u, int v) {
    uint across = tsr_sampler[int(tsr_sampler[tsr_p_axis_at]) + u];
    uint up = tsr_sampler[int(tsr_sampler[tsr_p_axis_at + 1]) + v];
#ifdef TESSERA_RESIDENT_CACHE
    int x = int(across >> tsr_axis_place_at) & (tsr_axis_places - 1);
    int y = int(up >> tsr_axis_place_at) & (tsr_axis_places - 1);
    int column = int(page & (tsr_page_side - 1u));
    int row = int((page >> tsr_page_row_at) & (tsr_page_side - 1u));
    return ivec3(
        column * int(tsr_sampler[tsr_p_slot_width]) + x * int(tsr_sampler[tsr_p_stride_s]),
        row * int(tsr_sampler[tsr_p_slot_height]) + y * int(tsr_sampler[tsr_p_stride_t]),
        int(page >> tsr_page_layer_at));
#else
    return ivec3(int(across & 0xFFFFu), int(up & 0xFFFFu),
                 int((up >> 16) * tsr_sampler[tsr_p_folds_u] + (across >> 16)));
#endif
}

int tsr_mip_word(int mip, int field) {
    return int(tsr_sampler[int(tsr_sampler[tsr_p_mip_at]) + mip * tsr_mip_words + field]);
}
uint tsr_chart(int mip, int u, int v) {
    return tsr_sampler[tsr_mip_word(mip, tsr_mip_charts) +
                       v * (tsr_mip_word(mip, tsr_mip_size) & 0xFFFF) + u];
}

// Two 16-bit numbers of a job.
ivec2 tsr_job_pair(int word) {
    return ivec2(int(tsr_jobs[word] & 0xFFFFu), int(tsr_jobs[word] >> 16));
}

// The mean of the texels of one chart from `low` to `high` in one direction, packed as texels are.
uvec4 tsr_mean_of(uint page, uint chart, ivec2 low, ivec2 high, ivec3 angle) {
#ifdef TSR_OUTPUT_HALF
    vec4 sum = vec4(0.0);
#else
    uvec4 sum = uvec4(0u);
#endif
    uint texels = 0u;
    for (int v = low.y; v < high.y; ++v)
        for (int u = low.x; u < high.x; ++u) {
            if (tsr_chart(0, u, v) != chart)
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
    return uvec4(low_two & 0xFFFFu, low_two >> 16, high_two & 0xFFFFu, high_two >> 16);
#else
    uvec4 mean = (2u * sum + texels) / (2u * texels);
    return uvec4(mean.x | (mean.y << 8) | (mean.z << 16) | (mean.w << 24), 0u, 0u, 0u);
#endif
}

layout(local_size_x = 64) in;
void main() {
    int job = int(gl_WorkGroupID.y) * tsr_job_words;
    uint page = tsr_jobs[job + tsr_mip_job_page];
    ivec2 begin = ivec2(int(tsr_jobs[job + tsr_mip_job_u]), int(tsr_jobs[job + tsr_mip_job_v]));
    ivec2 extent = tsr_job_pair(job + tsr_mip_job_extent);
    ivec2 first = tsr_job_pair(job + tsr_mip_job_first);
    ivec2 count = tsr_job_pair(job + tsr_mip_job_count);
    // The mip that the group's texel belongs to.
    int mips = int(tsr_sampler[tsr_p_mips]);
    int left = int(gl_WorkGroupID.x);
    int mip = 1;
    ivec2 side = ivec2((extent.x + 1) >> 1, (extent.y + 1) >> 1);
    while (mip <= mips && left >= side.x * side.y) {
        left -= side.x * side.y;
        ++mip;
        side = ivec2((extent.x + (1 << mip) - 1) >> mip, (extent.y + (1 << mip) - 1) >> mip);
    }
    if (mip > mips)
        return;
    ivec2 at = ivec2((begin.x >> mip) + left % side.x, (begin.y >> mip) + left / side.x);
    uint chart = tsr_chart(mip, at.x, at.y);
    if (chart == 0u)
        return;
    ivec2 low = ivec2(at.x << mip, at.y << mip);
    ivec2 high = ivec2(min(low.x + (1 << mip), begin.x + extent.x),
                       min(low.y + (1 << mip), begin.y + extent.y));
    ivec3 to = tsr_corner(page, tsr_mip_word(mip, tsr_mip_u) + at.x,
                          tsr_mip_word(mip, tsr_mip_v) + at.y);
    for (int i = int(gl_LocalInvocationIndex); i < count.x * count.y; i += 64) {
        ivec3 angle = ivec3(first.x + i % count.x, first.y + i / count.x, 0);
        imageStore(tsr_to, to + angle, tsr_mean_of(page, chart, low, high, angle));
    }
}
