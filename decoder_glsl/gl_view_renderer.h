// Draws views of a textured sphere, by the seven steps of the paper for every pixel, or of a textured
// mesh, as triangles.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "format/surface_mesh.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// A pinhole camera relative to the centre of the sphere, or in the coordinates of the mesh. The ray
// through a place of the picture runs along forward + x right + y up, x and y from -1 (left, bottom)
// to 1 (right, top); the three are at right angles.
struct ViewCamera {
    std::array<float, 3> eye{}, forward{}, right{}, up{};
    float radius = 1;               // of the sphere; no matter for a mesh
    bool inside = false;            // the camera is in the sphere
    std::array<float, 4> outside{}; // colour where a ray misses it
    std::uint32_t width = 0, height = 0;
};

// Needs a current OpenGL 4.5 context at every call.
class GlViewRenderer {
public:
    // Of a sphere. `texture` must outlive it.
    static Result<GlViewRenderer> create(const SampledTexture& texture);
    // Of a mesh, four samples a pixel; from behind its triangles are not there. `mesh` is copied to
    // the device. What is nearer to the eye than a ten-thousandth of the mesh's size may be missing.
    // On feedback only what is seen marks its tiles. Errors: bad_argument, where the mesh is not as
    // format/surface_mesh.h says; runtime.
    static Result<GlViewRenderer> create(const SampledTexture& texture, const SurfaceMesh& mesh);
    GlViewRenderer(GlViewRenderer&&) noexcept;
    GlViewRenderer& operator=(GlViewRenderer&&) noexcept;
    ~GlViewRenderer();

    // Issues one frame. runtime: no memory for the picture.
    Status draw(const ViewCamera& camera);
    // The last frame, RGBA floats, row 0 at the top; waits for the device.
    Result<std::vector<float>> read() const;

    std::uint64_t bytes() const; // on the device

private:
    struct State;
    explicit GlViewRenderer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

} // namespace tessera
