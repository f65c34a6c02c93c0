// The interface of the drawings behind GlViewRenderer.
#pragma once

#include "decoder_glsl/gl_view_renderer.h"

namespace tessera {

// The functions of the same names in GlViewRenderer, for one kind of surface.
class ViewDrawing {
public:
    virtual ~ViewDrawing() = default;
    virtual Status draw(const ViewCamera& camera) = 0;
    virtual Result<std::vector<float>> read() const = 0;
    virtual std::uint64_t bytes() const = 0;
};

// `texture` must outlive the drawing.
Result<std::unique_ptr<ViewDrawing>> make_sphere_drawing(const SampledTexture& texture);
Result<std::unique_ptr<ViewDrawing>> make_mesh_drawing(const SampledTexture& texture,
                                                       const SurfaceMesh& mesh);

} // namespace tessera
