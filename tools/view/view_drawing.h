// Pixels in parallel, row by row, and the rays through one of them.
#pragma once

#include "format/work.h"
#include "tools/support/interrupt.h"
#include "tools/view/view_renderer.h"

#include <cmath>
#include <vector>

namespace tessera {

// Calls pixel(worker, i, j), which returns a Result<glm::dvec3>, for every pixel.
template <class Worker, class Pixel>
Result<View> draw_pixels(const Camera& camera, std::vector<Worker>& workers,
                         const ProgressFunction& progress, const Pixel& pixel) {
    View view{camera.width, camera.height, {}};
    view.rgb.resize(std::size_t{camera.width} * camera.height * 3);
    TESSERA_TRY(parallel_for(
        workers, camera.height,
        [&](Worker& worker, std::size_t j) -> Status {
            TESSERA_TRY(check_interrupt());
            float* out = view.rgb.data() + j * camera.width * 3;
            for (std::uint32_t i = 0; i < camera.width; ++i) {
                TESSERA_TRY_ASSIGN(const glm::dvec3 colour,
                                   pixel(worker, i, static_cast<std::uint32_t>(j)));
                for (int c = 0; c < 3; ++c)
                    *out++ = static_cast<float>(colour[c]);
            }
            return {};
        },
        [&](std::size_t j) {
            if (progress)
                progress("rendering", static_cast<double>(j), camera.height);
        }));
    return view;
}

// The mean of ray(direction), a Result<glm::dvec3>, over `samples` rays through pixel (i, j). They
// follow the additive recurrence of the plastic number (Roberts, "The unreasonable effectiveness of
// quasirandom sequences", 2018), which is even for any count; the first is the pixel's centre.
template <class Ray>
Result<glm::dvec3> mean_of_rays(const Camera& camera, std::uint32_t i, std::uint32_t j,
                                unsigned samples, const Ray& ray) {
    constexpr double step_x = 0.7548776662466927, step_y = 0.5698402909980532;
    glm::dvec3 sum{0.0};
    for (unsigned k = 0; k < samples; ++k) {
        const double x = 0.5 + k * step_x, y = 0.5 + k * step_y;
        TESSERA_TRY_ASSIGN(const glm::dvec3 colour,
                           ray(camera.direction(i + x - std::floor(x), j + y - std::floor(y))));
        sum += colour;
    }
    return sum / static_cast<double>(samples);
}

} // namespace tessera
