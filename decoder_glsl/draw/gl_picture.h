// The picture that meshes are drawn into: four samples per pixel, and their means.
#pragma once

#include "decoder_glsl/gl/gl_handle.h"
#include "decoder_glsl/gl/gl_texture.h"

#include <array>
#include <vector>

namespace tessera {

// Colours are half floats, which are exact to 1/16 of a step of 8-bit colours, or, to blend linear
// light, 8-bit sRGB. Every call and the
// destructor need a current OpenGL 4.5 context.
class GlPicture {
public:
    // Errors: runtime (no memory), unsupported (larger than the device draws).
    static Result<GlPicture> create(std::uint32_t width, std::uint32_t height, bool is_srgb);

    std::uint32_t width() const { return mean_.shape().width; }
    std::uint32_t height() const { return mean_.shape().height; }
    GLuint framebuffer() const { return samples_.get(); }
    // Clears to `colour` and the farthest depth. OpenGL's masks and scissors apply.
    void clear(const std::array<float, 4>& colour);
    // Computes the means of the samples. GL_FRAMEBUFFER_SRGB must be off: the means are of display
    // values.
    void resolve();
    // The means, RGBA, rows in the order in which they were drawn.
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
