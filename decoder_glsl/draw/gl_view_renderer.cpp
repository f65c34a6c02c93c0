#include "decoder_glsl/gl_view_renderer.h"

#include "decoder_glsl/draw/view_drawing.h"

namespace tessera {

struct GlViewRenderer::State {
    std::unique_ptr<ViewDrawing> drawing;
};

GlViewRenderer::GlViewRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlViewRenderer::GlViewRenderer(GlViewRenderer&&) noexcept = default;
GlViewRenderer& GlViewRenderer::operator=(GlViewRenderer&&) noexcept = default;
GlViewRenderer::~GlViewRenderer() = default;

Result<GlViewRenderer> GlViewRenderer::create(const SampledTexture& texture) {
    TESSERA_TRY_ASSIGN(auto drawing, make_sphere_drawing(texture));
    return GlViewRenderer(std::unique_ptr<State>(new State{std::move(drawing)}));
}

Result<GlViewRenderer> GlViewRenderer::create(const SampledTexture& texture,
                                              const SurfaceMesh& mesh) {
    TESSERA_TRY_ASSIGN(auto look, textured_look(texture));
    TESSERA_TRY_ASSIGN(auto drawing, make_mesh_drawing(std::move(look), mesh));
    return GlViewRenderer(std::unique_ptr<State>(new State{std::move(drawing)}));
}

Result<GlViewRenderer> GlViewRenderer::create(std::span<const ViewLayer> layers,
                                              std::span<const DistantLight> lights,
                                              const SurfaceMesh& mesh) {
    TESSERA_TRY_ASSIGN(auto look, layered_look(layers, lights));
    TESSERA_TRY_ASSIGN(auto drawing, make_mesh_drawing(std::move(look), mesh));
    return GlViewRenderer(std::unique_ptr<State>(new State{std::move(drawing)}));
}

Status GlViewRenderer::draw(const ViewCamera& camera) {
    return state_->drawing->draw(camera);
}

Result<std::vector<float>> GlViewRenderer::read() const {
    return state_->drawing->read();
}

std::uint64_t GlViewRenderer::bytes() const {
    return state_->drawing->bytes();
}

} // namespace tessera
