// What a GlViewRenderer draws, behind one interface.
#pragma once

#include "decoder_glsl/gl_view_renderer.h"

namespace tessera {

class ViewDrawing {
public:
    virtual ~ViewDrawing() = default;
    virtual Status draw(const ViewCamera& camera) = 0;
    virtual Result<std::vector<float>> read() const = 0;
    virtual std::uint64_t bytes() const = 0;
};

// `texture` must outlive them.
Result<std::unique_ptr<ViewDrawing>> make_sphere_drawing(const SampledTexture& texture);
Result<std::unique_ptr<ViewDrawing>> make_mesh_drawing(const SampledTexture& texture,
                                                       const SurfaceMesh& mesh);

} // namespace tessera
