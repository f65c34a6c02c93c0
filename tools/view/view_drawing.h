// Draws rows of pixels in parallel. Each pixel is the mean of its rays.
#pragma once

#include "format/work.h"
#include "tools/support/interrupt.h"
#include "tools/view/view_renderer.h"

#include <cmath>
#include <vector>

namespace tessera {

// The mean of ray(direction), which returns Result<glm::dvec3>, over options.rays rays through pixel
// (i, j), distributed as options.filter weighs them. The rays follow the additive recurrence of the
// golden ratio and of the root of 3, which spreads any number of rays evenly. They are symmetric about
// the pixel's centre: rays that lie to one side on average would draw the whole picture shifted to the
// other side.
template <class Ray>
Result<glm::dvec3> mean_of_rays(const Camera& camera, std::uint32_t i, std::uint32_t j,
                                const RenderOptions& options, const Ray& ray) {
    constexpr double step_x = 0.618033988749895, step_y = 0.732050807568877;
    const double middle = 0.5 * (options.rays - 1.0);
    const auto place = [&](std::uint32_t pixel, double x) {
        return pixel + options.filter.place(x - std::floor(x));
    };
    glm::dvec3 sum{0.0};
    for (unsigned k = 0; k < options.rays; ++k) {
        const double x = 0.5 + (k - middle) * step_x, y = 0.5 + (k - middle) * step_y;
        TESSERA_TRY_ASSIGN(const glm::dvec3 colour,
                           ray(camera.direction(place(i, x), place(j, y))));
        sum += colour;
    }
    return sum / static_cast<double>(options.rays);
}

// Draws a picture with ray(worker, direction), which returns Result<glm::dvec3>. Each thread uses
// one worker.
template <class Worker, class Ray>
Result<View> draw_rays(const Camera& camera, std::vector<Worker>& workers,
                       const RenderOptions& options, const Ray& ray) {
    View view{camera.width, camera.height, {}};
    view.rgb.resize(std::size_t{camera.width} * camera.height * 3);
    TESSERA_TRY(parallel_for(
        workers, camera.height,
        [&](Worker& worker, std::size_t row) -> Status {
            TESSERA_TRY(check_interrupt());
            float* out = view.rgb.data() + row * camera.width * 3;
            const auto j = static_cast<std::uint32_t>(row);
            for (std::uint32_t i = 0; i < camera.width; ++i) {
                TESSERA_TRY_ASSIGN(
                    const glm::dvec3 colour,
                    mean_of_rays(camera, i, j, options, [&](const glm::dvec3& direction) {
                        return ray(worker, direction);
                    }));
                for (int c = 0; c < 3; ++c)
                    *out++ = static_cast<float>(colour[c]);
            }
            return {};
        },
        [&](std::size_t row) {
            if (options.progress)
                options.progress("rendering", static_cast<double>(row), camera.height);
        }));
    return view;
}

} // namespace tessera
