// OpenGL's state while a mesh is drawn.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstddef>

namespace tessera {

// Sets whatever decides which fragments of a mesh are drawn, and puts back what was there, but for the
// program, which may be gone: depth from 1
// (near) to 0 (infinitely far), rows from the top, backs culled, nothing blended or cut.
class GlRasterState {
public:
    GlRasterState(GLuint framebuffer, GLsizei width, GLsizei height);
    GlRasterState(const GlRasterState&) = delete;
    GlRasterState& operator=(const GlRasterState&) = delete;
    ~GlRasterState();

    // What is drawn next: depths alone, or colours of what is not behind them.
    void write_depths();
    void write_colours();

private:
    static constexpr std::size_t switches = 15;
    std::array<GLboolean, switches> on_{};
    GLint framebuffer_ = 0, vertices_ = 0;
    GLint clip_origin_ = 0, clip_depth_ = 0, cull_ = 0, front_ = 0, depth_func_ = 0;
    GLint polygons_[2] = {};
    GLboolean depth_mask_ = GL_TRUE, colour_mask_[4] = {};
    GLint viewport_[4] = {};
    GLdouble depth_range_[2] = {};
};

} // namespace tessera
