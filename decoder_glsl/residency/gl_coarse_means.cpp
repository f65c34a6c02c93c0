#include "decoder_glsl/residency/gl_coarse_means.h"

#include "decoder_glsl/shaders/shader_layout.h"

namespace tessera {

using namespace layout;

Result<GlCoarseMeans> GlCoarseMeans::create(const TextureFile& file) {
    GlCoarseMeans means;
    TESSERA_TRY_ASSIGN(means.program_, compute_program("coarse.comp.glsl", file.output_defines()));
    return means;
}

void GlCoarseMeans::add(std::uint32_t page, std::uint32_t word, const Extent4& extent) {
    std::array<std::uint32_t, tsr_job_words> job{};
    job[tsr_coarse_job_page] = page;
    job[tsr_coarse_job_word] = word;
    for (std::size_t axis = 0; axis < 4; ++axis)
        job[tsr_coarse_job_extent + axis] = extent[axis];
    words_.insert(words_.end(), job.begin(), job.end());
}

Status GlCoarseMeans::compute(const GlTexture& texels, const GlBuffer& parameters) {
    TESSERA_TRY(grow_buffer(jobs_, words_.size() * 4, BufferUse::upload, "coarse jobs"));
    TESSERA_TRY(jobs_.upload(0, std::as_bytes(std::span(words_))));
    jobs_.bind_storage(jobs_binding);
    parameters.bind_storage(sampler_binding);
    texels.bind_texture(texels_unit);
    program_.use();
    glDispatchCompute(static_cast<GLuint>(words_.size() / tsr_job_words), 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    words_.clear();
    return {};
}

} // namespace tessera
