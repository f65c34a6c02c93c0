// Makes the mips of an atlas beside the texels that have been decoded, on the device.
#pragma once

#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_program.h"
#include "decoder_glsl/gl/gl_texture.h"
#include "decoder_glsl/residency/gl_residency.h"

namespace tessera {

class GlMips {
public:
    // `cached`: texels lie in the slots of a tile cache. Errors: those of the program.
    static Result<GlMips> create(const TextureFile& file, bool cached);

    // Of a tile. `page`: of its slot. `directions`: along s and t in its angular images there, from `first`.
    void add(std::uint32_t page, const Box4& tile, std::array<std::uint32_t, 2> first,
             std::array<std::uint32_t, 2> directions);
    // Makes those of all tiles that were added. `parameters`: the sampler's words.
    Status make(const GlTexture& texels, const GlBuffer& parameters);

    std::uint64_t bytes() const { return jobs_.bytes(); }

private:
    GlProgram program_;
    GlBuffer jobs_;
    std::vector<std::uint32_t> words_;
    std::uint32_t most_texels_ = 0; // of mips, in one tile
    unsigned mips_ = 0;
    bool half_ = false;
};

} // namespace tessera
