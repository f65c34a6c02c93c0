#include "codec/pass/steps.h"

#include <array>
#include <cmath>

namespace tessera {

CodingParameters parameters_for_step(double step, const TextureDesc& desc,
                                     const EffortSettings& effort) {
    CodingParameters parameters;
    parameters.dependent = effort.dependent;
    if (effort.dependent)
        step *= 1.045; // the PSNR that independent levels have
    // An error in Co (Cg) moves the three samples together by 1/2 (3/4) of its square, one in Y by
    // 3: steps in the ratio 1 : sqrt 6 : 2 cost the same distortion. Measured: 15 % off either way
    // costs 0.2 %.
    const std::array<double, max_planes> ratio = {1.0, std::sqrt(6.0), 2.0, 1.7};
    const double rgb_ratio = std::sqrt(3.0); // of orthonormal RGB
    for (std::size_t plane = 0; plane < max_planes; ++plane)
        parameters.step[plane] =
            StepCode::nearest(step * (desc.channels < 3            ? 1.0
                                      : effort.ycocg || plane == 3 ? ratio[plane]
                                                                   : rgb_ratio));
    parameters.rotated_step = StepCode::nearest(step * rgb_ratio);
    parameters.colour_rotation = desc.channels >= 3 && effort.rotate_colours;
    return parameters;
}

CodingParameters coding_parameters(double step, const EncodePlan& plan) {
    CodingParameters parameters = parameters_for_step(step, plan.colour.desc, plan.effort);
    // Corrections are found once a tile is decoded, so nothing could copy corrected texels.
    parameters.prediction = plan.effort.search.copies.along > 0 && !plan.colour.corrections;
    return parameters;
}

double step_of_quality(double quality, SampleType type) {
    return 0.75 * std::exp2((100.0 - quality) / 8.0) * (type == SampleType::half16 ? 16.0 : 1.0);
}

} // namespace tessera
