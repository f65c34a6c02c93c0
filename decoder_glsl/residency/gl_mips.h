// Computes the mips of an atlas from its decoded texels, on the device (shaders/mips.comp.glsl).
#pragma once

#include "decoder_glsl/residency/gl_residency.h"

namespace tessera {

// Every call and the destructor need a current OpenGL 4.5 context.
class GlMips {
public:
    // `cached`: the texels are in a tile cache. Errors: those of the program.
    static Result<GlMips> create(const TextureFile& file, bool cached);

    // Adds a tile. `page`: of its slot, in a tile cache. Its angular images have `directions`
    // texels along s and t, from `first` on.
    void add(std::uint32_t page, const Box4& tile, std::array<std::uint32_t, 2> first,
             std::array<std::uint32_t, 2> directions);
    // Computes the mips of all tiles that were added. `parameters`: the sampler's buffer.
    Status compute(const GlTexture& texels, const GlBuffer& parameters);

    std::uint64_t bytes() const { return jobs_.bytes(); }

private:
    GlProgram program_;
    GlBuffer jobs_;
    std::vector<std::uint32_t> words_;
    std::uint32_t most_texels_ = 0; // in all mips of one tile
    unsigned mips_ = 0;
    bool half_ = false;
};

} // namespace tessera
