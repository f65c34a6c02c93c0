// Computes the coarse texels of decoded tiles, which are drawn while the tiles are missing: the
// mean of each of 64 parts of a tile. A group per tile, an invocation per part.
#include "dialect.glsl"
layout(std430, binding = 1) readonly buffer TesseraJobs { uint tsr_jobs[]; };
layout(std430, binding = 4) buffer TesseraSampler { uint tsr_sampler[]; };
#include "sampler_layout.glsl"
layout(TSR_TEXTURE(0)) uniform highp TSR_TEXTURE_TYPE tsr_texels;

// Sums the texels in `count` from `begin` on, in the slot whose first pixel is `corner`.
vec4 tsr_sum_of(ivec3 corner, ivec4 begin, ivec4 count) {
    vec4 sum = vec4(0.0);
    for (int i = 0; i < count.x * count.y * count.z * count.w; ++i) {
        ivec4 at = begin + ivec4(i % count.x, i / count.x % count.y,
                                 i / (count.x * count.y) % count.z,
                                 i / (count.x * count.y * count.z));
        sum += texelFetch(tsr_texels,
                          corner + ivec3(at.x * int(tsr_sampler[tsr_p_stride_s]) + at.z,
                                         at.y * int(tsr_sampler[tsr_p_stride_t]) + at.w, 0),
                          0);
    }
    return sum;
}

layout(local_size_x = 64) in;
void main() {
    int job = int(gl_WorkGroupID.x) * tsr_job_words;
    uint page = tsr_jobs[job + tsr_coarse_job_page];
    int extent_at = job + tsr_coarse_job_extent;
    ivec4 extent = ivec4(int(tsr_jobs[extent_at]), int(tsr_jobs[extent_at + 1]),
                         int(tsr_jobs[extent_at + 2]), int(tsr_jobs[extent_at + 3]));
    int cell = int(gl_LocalInvocationIndex);
    ivec4 part = ivec4(cell % tsr_coarse_uv, cell / tsr_coarse_uv % tsr_coarse_uv,
                       cell / (tsr_coarse_uv * tsr_coarse_uv) % tsr_coarse_st,
                       cell / (tsr_coarse_uv * tsr_coarse_uv * tsr_coarse_st));
    ivec4 parts = ivec4(tsr_coarse_uv, tsr_coarse_uv, tsr_coarse_st, tsr_coarse_st);
    // The texels x with x * parts / extent = part. Where a short side has none, the nearest one.
    ivec4 begin = (part * extent + parts - 1) / parts;
    ivec4 end = max(((part + 1) * extent + parts - 1) / parts, begin + 1);
    end = min(end, extent);
    begin = min(begin, end - 1);
    ivec4 count = end - begin;
    ivec3 corner = ivec3(
        int(page & (tsr_page_side - 1u)) * int(tsr_sampler[tsr_p_slot_width]),
        int((page >> tsr_page_row_at) & (tsr_page_side - 1u)) * int(tsr_sampler[tsr_p_slot_height]),
        int(page >> tsr_page_layer_at));
    vec4 mean =
        tsr_sum_of(corner, begin, count) / float(count.x * count.y * count.z * count.w);
    uint word = tsr_jobs[job + tsr_coarse_job_word] + uint(cell) * 2u;
#ifdef TSR_OUTPUT_HALF
    tsr_sampler[word] = packHalf2x16(mean.xy);
    tsr_sampler[word + 1u] = packHalf2x16(mean.zw);
#else
    tsr_sampler[word] = packUnorm4x8(mean);
#endif
}
