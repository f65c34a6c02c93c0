// Draws views of a textured sphere, one ray per pixel, or of a mesh with a texture or with layers, as
// triangles.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "format/layers.h"
#include "format/surface_mesh.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// A pinhole camera, relative to the centre of the sphere or in the coordinates of the mesh. The ray
// through the point (x, y) of the picture has the direction forward + x right + y up. x and y run
// from -1 (left, bottom) to 1 (right, top). The three vectors are at right angles to each other.
struct ViewCamera {
    std::array<float, 3> eye{}, forward{}, right{}, up{};
    float radius = 1;                    // of the sphere; unused for a mesh
    bool inside = false;                 // the camera is inside the sphere
    std::array<float, 4> outside{};      // RGBA of pixels that show no surface
    std::uint32_t width = 0, height = 0; // pixels
};

// A layer (FORMAT.md 5.6) whose texels are decoded.
struct ViewLayer {
    LayerRole role = LayerRole::diffuse;
    float scale = 1; // the light, or other value, of a sample of 1
    Transfer transfer = Transfer::unspecified;
    const SampledTexture* texture = nullptr;
};

// Every call and the destructor need a current OpenGL 4.5 context.
class GlViewRenderer {
public:
    // Draws a sphere. `texture` must outlive the renderer.
    static Result<GlViewRenderer> create(const SampledTexture& texture);
    // Draws a mesh, with four samples per pixel and without back faces. `mesh` is copied to the
    // device, `texture` must outlive the renderer. Surfaces nearer to the eye than a ten-thousandth
    // of the mesh's size may be missing. In a tile cache only visible surfaces mark their tiles.
    // Errors: bad_argument (the mesh breaks a rule of format/surface_mesh.h), runtime.
    static Result<GlViewRenderer> create(const SampledTexture& texture, const SurfaceMesh& mesh);
    // The same with layers, as display values. The diffuse layer comes first, no role occurs twice,
    // and the textures fit their roles (check_layer()). They were created together, if there are
    // several, and must outlive the renderer. Errors: those above; unsupported (the device has too few buffers for them).
    static Result<GlViewRenderer> create(std::span<const ViewLayer> layers,
                                         std::span<const DistantLight> lights,
                                         const SurfaceMesh& mesh);
    GlViewRenderer(GlViewRenderer&&) noexcept;
    GlViewRenderer& operator=(GlViewRenderer&&) noexcept;
    ~GlViewRenderer();

    // Issues the work of one frame. Errors: runtime (no memory for the picture).
    Status draw(const ViewCamera& camera);
    // The last frame: RGBA floats, row 0 at the top. Waits for the device.
    Result<std::vector<float>> read() const;

    std::uint64_t bytes() const; // on the device, without those of the texture

private:
    struct State;
    explicit GlViewRenderer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera
