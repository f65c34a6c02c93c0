// Means over the 64 parts of decoded tiles, for frames that come before their tiles. A group a tile,
// an invocation a part.
//
// A job is eight words: page, word of the tile's coarse texels in the sampler's buffer, extents of the
// tile, and two unused.
#include "dialect.glsl"
layout(std430, binding = 1) readonly buffer TesseraJobs { uint tsr_jobs[]; };
layout(std430, binding = 4) buffer TesseraSampler { uint tsr_sampler[]; };
#include "layout.glsl"
#include "sampler_layout.glsl"
layout(TSR_TEXTURE(0)) uniform highp sampler2DArray tsr_texels;

layout(local_size_x = 64) in;
void main() {
    int job = int(gl_WorkGroupID.x) * 8;
    uint page = tsr_jobs[job];
    ivec4 extent = ivec4(int(tsr_jobs[job + 2]), int(tsr_jobs[job + 3]), int(tsr_jobs[job + 4]),
                         int(tsr_jobs[job + 5]));
    int cell = int(gl_LocalInvocationIndex);
    ivec4 part = ivec4(cell % tsr_coarse_uv, cell / tsr_coarse_uv % tsr_coarse_uv,
                       cell / (tsr_coarse_uv * tsr_coarse_uv) % tsr_coarse_st,
                       cell / (tsr_coarse_uv * tsr_coarse_uv * tsr_coarse_st));
    ivec4 parts = ivec4(tsr_coarse_uv, tsr_coarse_uv, tsr_coarse_st, tsr_coarse_st);
    // The texels x with x * parts / extent = part; a part of a short side may have none.
    ivec4 begin = (part * extent + parts - 1) / parts;
    ivec4 end = max(((part + 1) * extent + parts - 1) / parts, begin + 1);
    end = min(end, extent);
    begin = min(begin, end - 1);
    ivec4 count = end - begin;
    ivec3 corner = ivec3(int(page & 1023u) * int(tsr_sampler[tsr_p_slot_width]),
                         int((page >> 10) & 1023u) * int(tsr_sampler[tsr_p_slot_height]),
                         int(page >> 20));
    vec4 sum = vec4(0.0);
    int texels = count.x * count.y * count.z * count.w;
    // At most 4,096 texels, in the parts of a tile of 1 x 64 x 32 x 32.
    for (int i = 0; i < min(texels, 8192); ++i) {
        ivec4 at = begin + ivec4(i % count.x, i / count.x % count.y,
                                 i / (count.x * count.y) % count.z,
                                 i / (count.x * count.y * count.z));
        sum += texelFetch(tsr_texels,
                          corner + ivec3(at.x * int(tsr_sampler[tsr_p_stride_s]) + at.z,
                                         at.y * int(tsr_sampler[tsr_p_stride_t]) + at.w, 0),
                          0);
    }
    vec4 mean = sum / float(min(texels, 8192));
    uint word = tsr_jobs[job + 1] + uint(cell) * 2u;
#ifdef TSR_OUTPUT_HALF
    tsr_sampler[word] = packHalf2x16(mean.xy);
    tsr_sampler[word + 1u] = packHalf2x16(mean.zw);
#else
    tsr_sampler[word] = packUnorm4x8(mean);
#endif
}
