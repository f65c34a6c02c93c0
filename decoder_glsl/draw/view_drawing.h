// The interface of the drawings behind GlViewRenderer.
#pragma once

#include "decoder_glsl/gl_view_renderer.h"

#include <functional>
#include <span>
#include <string>

namespace tessera {

// The functions of the same names in GlViewRenderer, for one kind of surface.
class ViewDrawing {
public:
    virtual ~ViewDrawing() = default;
    virtual Status draw(const ViewCamera& camera) = 0;
    virtual Result<std::vector<float>> read() const = 0;
    virtual std::uint64_t bytes() const = 0;
};

// How a mesh looks: the source of its fragment shader, and what binds its textures and uniform blocks.
// The uniform block 0 is that of mesh.vert.glsl.
struct MeshLook {
    std::string fragment;
    std::string depth_fragment; // of the pass that draws depths; empty: it discards nothing
    // Of a pass that draws all triangles from back to front, over the others. Its colours and those of
    // `fragment` are then linear, the former multiplied by alpha. Empty: nothing blends.
    std::string blended_fragment;
    std::function<void()> bind;
    std::uint64_t bytes = 0; // on the device, without textures
};

// The textures must outlive the drawings.
Result<std::unique_ptr<ViewDrawing>> make_sphere_drawing(const SampledTexture& texture);
Result<std::unique_ptr<ViewDrawing>> make_mesh_drawing(MeshLook look, const SurfaceMesh& mesh);

// The looks of a texture and of layers.
Result<MeshLook> textured_look(const SampledTexture& texture);
Result<MeshLook> layered_look(std::span<const ViewLayer> layers,
                              std::span<const DistantLight> lights);

} // namespace tessera
