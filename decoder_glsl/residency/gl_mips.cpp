#include "decoder_glsl/residency/gl_mips.h"

#include <algorithm>

namespace tessera {

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
    words_.insert(words_.end(),
                  {page, tile.begin[0], tile.begin[1], extent[0] | (extent[1] << 16),
                   first[0] | (first[1] << 16), directions[0] | (directions[1] << 16), 0, 0});
}

Status GlMips::make(const GlTexture& texels, const GlBuffer& parameters) {
    const TexelFormat format = half_ ? TexelFormat::rgba16ui : TexelFormat::r32ui;
    TESSERA_TRY(texels.bind_image(0, GL_WRITE_ONLY, format));
    TESSERA_TRY(texels.bind_image(1, GL_READ_ONLY, format));
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    // Rows of 32,768 tiles at most: any device's dispatch.
    constexpr std::size_t most = 32768 * 8;
    for (std::size_t at = 0; at < words_.size(); at += most) {
        const auto words = std::span(words_).subspan(at, std::min(most, words_.size() - at));
        TESSERA_TRY(grow_buffer(jobs_, words.size_bytes(), BufferUse::upload, "mip jobs"));
        TESSERA_TRY(jobs_.upload(0, std::as_bytes(words)));
        jobs_.bind_storage(1);
        parameters.bind_storage(4);
        program_.use();
        glDispatchCompute(most_texels_, static_cast<GLuint>(words.size() / 8), 1);
    }
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    words_.clear();
    most_texels_ = 0;
    return {};
}

} // namespace tessera
