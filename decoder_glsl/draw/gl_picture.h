// What meshes are drawn into: four samples a pixel, and the picture of their means.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "decoder_glsl/gl/gl_texture.h"

#include <array>
#include <vector>

namespace tessera {

// Colours are halves: those of bytes lose 1/16 of a step. Needs a current OpenGL 4.5 context at every
// call, as its destructor does.
class GlPicture {
public:
    // Errors: runtime, unsupported (no memory, or larger than the device draws).
    static Result<GlPicture> create(std::uint32_t width, std::uint32_t height);

    std::uint32_t width() const { return mean_.shape().width; }
    std::uint32_t height() const { return mean_.shape().height; }
    GLuint framebuffer() const { return samples_.get(); }
    // To `colour` and the farthest depth; masks and scissors apply.
    void clear(const std::array<float, 4>& colour);
    // Makes the picture of the samples.
    void resolve();
    // RGBA, rows as they were drawn.
    Result<std::vector<float>> read() const;
    std::uint64_t bytes() const;

private:
    struct ReleaseFramebuffer {
        void operator()(GLuint id) const { glDeleteFramebuffers(1, &id); }
    };
    struct ReleaseRenderbuffer {
        void operator()(GLuint id) const { glDeleteRenderbuffers(1, &id); }
    };
    GlTexture mean_;
    GlHandle<ReleaseRenderbuffer> colours_, depths_;
    GlHandle<ReleaseFramebuffer> samples_, means_;
};

} // namespace tessera
