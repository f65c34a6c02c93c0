#include "decoder_glsl/residency/gl_mips.h"

#include "decoder_glsl/shaders/shader_layout.h"

#include <algorithm>

namespace tessera {

using namespace layout;

Result<GlMips> GlMips::create(const TextureFile& file, bool cached) {
    GlMips mips;
    mips.mips_ = file.mips.count();
    mips.half_ = file.half;
    auto defines = file.output_defines();
    if (cached)
        defines.emplace_back("TESSERA_RESIDENT_CACHE", "1");
    TESSERA_TRY_ASSIGN(mips.program_, compute_program("mips.comp.glsl", defines));
    return mips;
}

void GlMips::add(std::uint32_t page, const Box4& tile, std::array<std::uint32_t, 2> first,
                 std::array<std::uint32_t, 2> directions) {
    const Extent4 extent = tile.extent();
    std::uint32_t texels = 0;
    for (unsigned mip = 1; mip <= mips_; ++mip)
        texels += (((extent[0] - 1) >> mip) + 1) * (((extent[1] - 1) >> mip) + 1);
    most_texels_ = std::max(most_texels_, texels);
    std::array<std::uint32_t, tsr_job_words> job{};
    job[tsr_mip_job_page] = page;
    job[tsr_mip_job_u] = tile.begin[0];
    job[tsr_mip_job_v] = tile.begin[1];
    job[tsr_mip_job_extent] = extent[0] | (extent[1] << 16);
    job[tsr_mip_job_first] = first[0] | (first[1] << 16);
    job[tsr_mip_job_count] = directions[0] | (directions[1] << 16);
    words_.insert(words_.end(), job.begin(), job.end());
}

Status GlMips::compute(const GlTexture& texels, const GlBuffer& parameters) {
    const TexelFormat format = half_ ? TexelFormat::rgba16ui : TexelFormat::r32ui;
    TESSERA_TRY(texels.bind_image(0, GL_WRITE_ONLY, format));
    TESSERA_TRY(texels.bind_image(1, GL_READ_ONLY, format));
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    // Every device accepts dispatches of 32,768 groups along y, one per tile.
    constexpr std::size_t most = 32768 * tsr_job_words;
    for (std::size_t at = 0; at < words_.size(); at += most) {
        const auto words = std::span(words_).subspan(at, std::min(most, words_.size() - at));
        TESSERA_TRY(grow_buffer(jobs_, words.size_bytes(), BufferUse::upload, "mip jobs"));
        TESSERA_TRY(jobs_.upload(0, std::as_bytes(words)));
        jobs_.bind_storage(jobs_binding);
        parameters.bind_storage(sampler_binding);
        program_.use();
        glDispatchCompute(most_texels_, static_cast<GLuint>(words.size() / tsr_job_words), 1);
    }
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    words_.clear();
    most_texels_ = 0;
    return {};
}

} // namespace tessera
