// Computes the mips of a tile of the atlas (FORMAT.md 5.2): each texel of a mip is the mean of the
// texels of its chart in a square of the atlas. A group computes one texel of a mip for all its
// directions.
#include "dialect.glsl"
layout(std430, binding = 1) readonly buffer TesseraJobs { uint tsr_jobs[]; };
layout(std430, binding = 4) readonly buffer TesseraSampler { uint tsr_sampler[]; };
#include "sampler_layout.glsl"

#ifdef TSR_TRANSLATED
// WebGPU cannot read and write one texture in a pass. The host copies the texels of the atlas to a
// second texture, to which this pass writes.
#ifdef TSR_OUTPUT_HALF
layout(rgba16f, TSR_IMAGE(0)) writeonly uniform highp image2DArray tsr_to;
#else
layout(rgba8, TSR_IMAGE(0)) writeonly uniform highp image2DArray tsr_to;
#endif
layout(TSR_TEXTURE(1)) uniform highp texture2DArray tsr_from;
#elif defined(TSR_OUTPUT_HALF)
layout(rgba16ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_to;
layout(rgba16ui, TSR_IMAGE(1)) readonly uniform highp uimage2DArray tsr_from;
#else
layout(r32ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_to;
layout(r32ui, TSR_IMAGE(1)) readonly uniform highp uimage2DArray tsr_from;
#endif

// Samples of halves are added as floats, those of bytes as integers.
#ifdef TSR_OUTPUT_HALF
#define TSR_SUM_TYPE vec4
#else
#define TSR_SUM_TYPE uvec4
#endif

TSR_SUM_TYPE tsr_load(ivec3 at) {
#ifdef TSR_TRANSLATED
    vec4 texel = texelFetch(tsr_from, at, 0);
#ifdef TSR_OUTPUT_HALF
    return texel;
#else
    return uvec4(texel * 255.0 + 0.5);
#endif
#else
    uvec4 pixel = imageLoad(tsr_from, at);
#ifdef TSR_OUTPUT_HALF
    return vec4(unpackHalf2x16(pixel.x | (pixel.y << 16)),
                unpackHalf2x16(pixel.z | (pixel.w << 16)));
#else
    return uvec4(pixel.x & 255u, (pixel.x >> 8) & 255u, (pixel.x >> 16) & 255u, pixel.x >> 24);
#endif
#endif
}

void tsr_store(ivec3 at, TSR_SUM_TYPE mean) {
#ifdef TSR_TRANSLATED
#ifdef TSR_OUTPUT_HALF
    imageStore(tsr_to, at, mean);
#else
    imageStore(tsr_to, at, vec4(mean) / 255.0);
#endif
#elif defined(TSR_OUTPUT_HALF)
    uint low = packHalf2x16(mean.xy);
    uint high = packHalf2x16(mean.zw);
    imageStore(tsr_to, at, uvec4(low & 0xFFFFu, low >> 16, high & 0xFFFFu, high >> 16));
#else
    uint word = mean.x | (mean.y << 8) | (mean.z << 16) | (mean.w << 24);
    imageStore(tsr_to, at, uvec4(word, 0u, 0u, 0u));
#endif
}

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
    int at = v * (tsr_mip_word(mip, tsr_mip_size) & 0xFFFF) + u;
    int halves = tsr_mip_word(mip, tsr_mip_halves);
    uint word = tsr_sampler[tsr_mip_word(mip, tsr_mip_charts) + (at >> halves)];
    return halves == 0 ? word : (word >> ((at & 1) * 16)) & 0xFFFFu;
}

// Two 16-bit numbers of a job.
ivec2 tsr_job_pair(int word) {
    return ivec2(int(tsr_jobs[word] & 0xFFFFu), int(tsr_jobs[word] >> 16));
}

// The mean of the texels of one chart from `low` to `high` in one direction.
TSR_SUM_TYPE tsr_mean_of(uint page, uint chart, ivec2 low, ivec2 high, ivec3 angle) {
    TSR_SUM_TYPE sum = TSR_SUM_TYPE(0);
    uint texels = 0u;
    for (int v = low.y; v < high.y; ++v)
        for (int u = low.x; u < high.x; ++u) {
            if (tsr_chart(0, u, v) != chart)
                continue;
            sum += tsr_load(tsr_corner(page, u, v) + angle);
            ++texels;
        }
#ifdef TSR_OUTPUT_HALF
    return sum / float(texels);
#else
    return (2u * sum + texels) / (2u * texels);
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
        tsr_store(to + angle, tsr_mean_of(page, chart, low, high, angle));
    }
}
