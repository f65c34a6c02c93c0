// OpenGL's rasteriser state while a mesh is drawn.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstddef>

namespace tessera {

// Sets all state that decides which fragments of a mesh are drawn: depths from 1 (near) to 0
// (infinitely far), rows from the top, back faces culled, no blending, no conversion to sRGB and no
// clipping by scissors or stencils. The destructor restores the previous state, except for the program, which may no
// longer exist.
class GlRasterState {
public:
    GlRasterState(GLuint framebuffer, GLsizei width, GLsizei height);
    GlRasterState(const GlRasterState&) = delete;
    GlRasterState& operator=(const GlRasterState&) = delete;
    ~GlRasterState();

    // Select what is drawn next: depths only, or the colours of fragments that these depths do not
    // hide.
    void write_depths();
    void write_colours();
    // Mixes the colours of such fragments, which are multiplied by alpha, with those below.
    void blend_colours();
    // Whether pictures of sRGB samples take linear colours.
    void write_linear(bool on);

private:
    static constexpr std::size_t switches = 16;
    std::array<GLboolean, switches> on_{};
    GLint framebuffer_ = 0, vertices_ = 0;
    GLint clip_origin_ = 0, clip_depth_ = 0, cull_ = 0, front_ = 0, depth_func_ = 0;
    GLint polygons_[2] = {};
    GLint blend_[6] = {}; // factors of source and destination, equations; for RGB and alpha
    GLboolean depth_mask_ = GL_TRUE, colour_mask_[4] = {};
    GLint viewport_[4] = {};
    GLdouble depth_range_[2] = {};
};

} // namespace tessera
