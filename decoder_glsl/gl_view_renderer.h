// Draws views of a textured sphere: the seven steps of the paper, for every pixel.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// A pinhole camera relative to the centre of the sphere. The ray through a place of the picture runs
// along forward + x right + y up, x and y from -1 (left, bottom) to 1 (right, top).
struct ViewCamera {
    std::array<float, 3> eye{}, forward{}, right{}, up{};
    float radius = 1;               // of the sphere
    std::array<float, 4> outside{}; // colour where a ray misses it
    std::uint32_t width = 0, height = 0;
};

// Needs a current OpenGL 4.5 context at every call.
class GlViewRenderer {
public:
    // `texture` must outlive it.
    static Result<GlViewRenderer> create(const SampledTexture& texture);
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
