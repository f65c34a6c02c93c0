#include "decoder_glsl/draw/gl_raster_state.h"

namespace tessera {
namespace {

struct Switch {
    GLenum name;
    bool on;
};
constexpr Switch switch_table[] = {
    {GL_DEPTH_TEST, true},        {GL_CULL_FACE, true},
    {GL_MULTISAMPLE, true},       {GL_BLEND, false},
    {GL_FRAMEBUFFER_SRGB, false}, {GL_SCISSOR_TEST, false},
    {GL_STENCIL_TEST, false},     {GL_RASTERIZER_DISCARD, false},
    {GL_SAMPLE_SHADING, false},   {GL_SAMPLE_MASK, false},
    {GL_SAMPLE_COVERAGE, false},  {GL_SAMPLE_ALPHA_TO_COVERAGE, false},
    {GL_DEPTH_CLAMP, false},      {GL_POLYGON_OFFSET_FILL, false},
    {GL_COLOR_LOGIC_OP, false},   {GL_PRIMITIVE_RESTART, false}};

void turn(GLenum name, bool on) {
    if (on)
        glEnable(name);
    else
        glDisable(name);
}

constexpr GLenum blend_queries[] = {GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,
                                    GL_BLEND_SRC_ALPHA,    GL_BLEND_DST_ALPHA,
                                    GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};

GLenum as_enum(GLint value) {
    return static_cast<GLenum>(value);
}

} // namespace

GlRasterState::GlRasterState(GLuint framebuffer, GLsizei width, GLsizei height) {
    static_assert(std::size(switch_table) == switches);
    for (std::size_t i = 0; i < switches; ++i) {
        on_[i] = glIsEnabled(switch_table[i].name);
        turn(switch_table[i].name, switch_table[i].on);
    }
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer_);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertices_);
    glGetIntegerv(GL_CLIP_ORIGIN, &clip_origin_);
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &clip_depth_);
    glGetIntegerv(GL_CULL_FACE_MODE, &cull_);
    glGetIntegerv(GL_FRONT_FACE, &front_);
    glGetIntegerv(GL_DEPTH_FUNC, &depth_func_);
    glGetIntegerv(GL_POLYGON_MODE, polygons_);
    for (std::size_t i = 0; i < std::size(blend_queries); ++i)
        glGetIntegerv(blend_queries[i], &blend_[i]);
    glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
    glGetBooleanv(GL_COLOR_WRITEMASK, colour_mask_);
    glGetIntegerv(GL_VIEWPORT, viewport_);
    glGetDoublev(GL_DEPTH_RANGE, depth_range_);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    glDepthRange(0, 1);
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDepthMask(GL_TRUE); // the masks apply to clears, too
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void GlRasterState::write_depths() {
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
}

void GlRasterState::write_colours() {
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_FALSE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void GlRasterState::blend_colours() {
    write_colours();
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

void GlRasterState::write_linear(bool on) {
    turn(GL_FRAMEBUFFER_SRGB, on);
}

GlRasterState::~GlRasterState() {
    for (std::size_t i = 0; i < switches; ++i)
        turn(switch_table[i].name, on_[i] != GL_FALSE);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(framebuffer_));
    glBindVertexArray(static_cast<GLuint>(vertices_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
    glDepthRange(depth_range_[0], depth_range_[1]);
    glClipControl(as_enum(clip_origin_), as_enum(clip_depth_));
    glCullFace(as_enum(cull_));
    glFrontFace(as_enum(front_));
    glPolygonMode(GL_FRONT_AND_BACK, as_enum(polygons_[0]));
    glBlendFuncSeparate(as_enum(blend_[0]), as_enum(blend_[1]), as_enum(blend_[2]),
                        as_enum(blend_[3]));
    glBlendEquationSeparate(as_enum(blend_[4]), as_enum(blend_[5]));
    glDepthFunc(as_enum(depth_func_));
    glDepthMask(depth_mask_);
    glColorMask(colour_mask_[0], colour_mask_[1], colour_mask_[2], colour_mask_[3]);
}

} // namespace tessera
