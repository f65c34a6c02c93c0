#include "decoder_glsl/gl_view_renderer.h"

#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/gl/gl_texture.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"

namespace tessera {
namespace {

// The uniform block of shaders/view.glsl, std140.
struct ViewBlock {
    float eye[4], right[4], up[4], forward[4], outside[4];
    std::int32_t pixels[4];
};

void put(const std::array<float, 3>& from, float last, float (&to)[4]) {
    to[0] = from[0];
    to[1] = from[1];
    to[2] = from[2];
    to[3] = last;
}

constexpr std::uint32_t group_side = 8; // pixels, as render.comp says

} // namespace

struct GlViewRenderer::State {
    const SampledTexture& texture;
    GlProgram program;
    GlBuffer view;
    GlTexture picture;
};

GlViewRenderer::GlViewRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlViewRenderer::GlViewRenderer(GlViewRenderer&&) noexcept = default;
GlViewRenderer& GlViewRenderer::operator=(GlViewRenderer&&) noexcept = default;
GlViewRenderer::~GlViewRenderer() = default;

Result<GlViewRenderer> GlViewRenderer::create(const SampledTexture& texture) {
    TESSERA_TRY_ASSIGN(auto program, compute_program("render.comp.glsl", texture.defines()));
    TESSERA_TRY_ASSIGN(auto view, GlBuffer::create(sizeof(ViewBlock), BufferUse::upload, "view"));
    return GlViewRenderer(
        std::unique_ptr<State>(new State{texture, std::move(program), std::move(view), {}}));
}

Status GlViewRenderer::draw(const ViewCamera& camera) {
    GlTexture& picture = state_->picture;
    if (picture.shape().width != camera.width || picture.shape().height != camera.height) {
        TESSERA_TRY_ASSIGN(picture, GlTexture::create(TexelFormat::rgba32f,
                                                      {camera.width, camera.height, 1}, "picture"));
    }
    ViewBlock block{};
    put(camera.eye, camera.radius, block.eye);
    put(camera.right, 0, block.right);
    put(camera.up, 0, block.up);
    put(camera.forward, 0, block.forward);
    for (std::size_t i = 0; i < 4; ++i)
        block.outside[i] = camera.outside[i];
    block.pixels[0] = static_cast<std::int32_t>(camera.width);
    block.pixels[1] = static_cast<std::int32_t>(camera.height);
    TESSERA_TRY(state_->view.upload(0, std::as_bytes(std::span(&block, 1))));
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, state_->view.id());
    state_->texture.bind();
    TESSERA_TRY(picture.bind_image(0, GL_WRITE_ONLY, TexelFormat::rgba32f));
    state_->program.use();
    glDispatchCompute((camera.width + group_side - 1) / group_side,
                      (camera.height + group_side - 1) / group_side, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
    return take_gl_errors("drawing a view");
}

Result<std::vector<float>> GlViewRenderer::read() const {
    const GlTexture& picture = state_->picture;
    std::vector<float> pixels(std::size_t{picture.shape().width} * picture.shape().height * 4);
    TESSERA_TRY(picture.read(0, std::as_writable_bytes(std::span(pixels))));
    return pixels;
}

std::uint64_t GlViewRenderer::bytes() const {
    return state_->picture.bytes() + state_->view.bytes();
}

} // namespace tessera
