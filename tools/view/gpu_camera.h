// Converts a camera for the GPU renderer.
#pragma once

#include "decoder_glsl/gl_view_renderer.h"
#include "tools/view/camera.h"
#include "tools/view/view_renderer.h"

namespace tessera {

// Positions become single-precision floats relative to the centre of the sphere. `outside` is the
// colour for rays that miss the sphere. Precondition: !camera.lens.
inline ViewCamera gpu_camera(const Camera& camera, const SphereWindow& window,
                             const glm::dvec3& outside) {
    const auto single = [](const glm::dvec3& v) -> std::array<float, 3> {
        return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    ViewCamera v;
    v.eye = single(camera.eye - window.centre);
    v.forward = single(camera.forward);
    v.right = single(camera.right);
    v.up = single(camera.up);
    v.radius = static_cast<float>(window.radius);
    v.inside = window.inside;
    const auto colour = single(outside);
    v.outside = {colour[0], colour[1], colour[2], 1};
    v.width = camera.width;
    v.height = camera.height;
    return v;
}

} // namespace tessera
