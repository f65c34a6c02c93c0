// Draws textured spheres: one ray per pixel.
#include "decoder_glsl/draw/view_drawing.h"
#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/gl/gl_texture.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"

namespace tessera {
namespace {

// The uniform block of shaders/view.glsl in std140 layout.
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

constexpr std::uint32_t group_side = 8; // pixels, as in render.comp

class SphereDrawing final : public ViewDrawing {
public:
    SphereDrawing(const SampledTexture& texture, GlProgram program, GlBuffer view)
        : texture_(texture), program_(std::move(program)), view_(std::move(view)) {}

    Status draw(const ViewCamera& camera) override {
        if (picture_.shape().width != camera.width || picture_.shape().height != camera.height) {
            TESSERA_TRY_ASSIGN(picture_,
                               GlTexture::create(TexelFormat::rgba32f,
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
        block.pixels[2] = camera.inside;
        TESSERA_TRY(view_.upload(0, std::as_bytes(std::span(&block, 1))));
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, view_.id());
        texture_.bind();
        TESSERA_TRY(picture_.bind_image(0, GL_WRITE_ONLY, TexelFormat::rgba32f));
        program_.use();
        glDispatchCompute((camera.width + group_side - 1) / group_side,
                          (camera.height + group_side - 1) / group_side, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
        return take_gl_errors("drawing a view");
    }

    Result<std::vector<float>> read() const override {
        std::vector<float> pixels(std::size_t{picture_.shape().width} * picture_.shape().height *
                                  4);
        TESSERA_TRY(picture_.read(0, std::as_writable_bytes(std::span(pixels))));
        return pixels;
    }

    std::uint64_t bytes() const override { return picture_.bytes() + view_.bytes(); }

private:
    const SampledTexture& texture_;
    GlProgram program_;
    GlBuffer view_;
    GlTexture picture_;
};

} // namespace

Result<std::unique_ptr<ViewDrawing>> make_sphere_drawing(const SampledTexture& texture) {
    TESSERA_TRY_ASSIGN(auto program, compute_program("render.comp.glsl", texture.defines()));
    TESSERA_TRY_ASSIGN(auto view, GlBuffer::create(sizeof(ViewBlock), BufferUse::upload, "view"));
    return std::unique_ptr<ViewDrawing>(
        std::make_unique<SphereDrawing>(texture, std::move(program), std::move(view)));
}

} // namespace tessera
