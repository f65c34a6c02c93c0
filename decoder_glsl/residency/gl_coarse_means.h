// Computes the coarse texels of decoded tiles on the device (shaders/coarse.comp.glsl).
#pragma once

#include "decoder_glsl/residency/gl_residency.h"

namespace tessera {

// Every call and the destructor need a current OpenGL 4.5 context.
class GlCoarseMeans {
public:
    // Errors: those of the program.
    static Result<GlCoarseMeans> create(const TextureFile& file);

    // Adds a tile. `page` is that of its slot, `word` that of its coarse texels in the sampler's
    // buffer.
    void add(std::uint32_t page, std::uint32_t word, const Extent4& extent);
    // Computes the coarse texels of all tiles that were added. `parameters`: the sampler's buffer.
    Status compute(const GlTexture& texels, const GlBuffer& parameters);

private:
    GlProgram program_;
    GlBuffer jobs_;
    std::vector<std::uint32_t> words_;
};

} // namespace tessera
