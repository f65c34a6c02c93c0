#include "codec/pass/steps.h"

#include <array>
#include <cmath>

namespace tessera {
namespace {

// The step of quality 100, in codes.
double smallest_step(SampleType type) {
    switch (type) { // without default, so that the compiler names a type that is missing
    case SampleType::unorm8:
        break;
    case SampleType::half16:
        return 12;
    }
    return 0.75;
}

} // namespace

CodingParameters parameters_for_step(double step, const TextureDesc& desc,
                                     const EffortSettings& effort) {
    CodingParameters parameters;
    if (desc.size[axis_s] == 1 && desc.size[axis_t] == 1)
        parameters.use_defaults(DefaultSet::pictures);
    parameters.dependent = effort.dependent;
    if (effort.dependent)
        step *= 1.045; // for the PSNR of independent levels
    // Summed over R, G and B, an error e of Y gives 3 e^2, of Co e^2 / 2, of Cg 3 e^2 / 4. So steps in
    // the ratio 1 : sqrt 6 : 2 give equal distortion. Measured: 15 % more or less costs 0.2 %.
    const std::array<double, max_planes> ratio = {1.0, std::sqrt(6.0), 2.0, 1.7};
    const double rgb_ratio = std::sqrt(3.0); // one sample instead of three
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
    // Corrections are computed from the decoded tile, so no block could copy corrected texels.
    parameters.prediction = plan.effort.search.copies.along > 0 && !plan.colour.corrections;
    // Base pictures would gain less than the further symbols cost.
    const Extent4& tile = plan.grid.tile_extent();
    parameters.leaves_out_transforms = parameters.prediction && plan.effort.pictures.no_transform &&
                                       tile[axis_s] == 1 && tile[axis_t] == 1;
    // Two channels weigh the same, so the first one is often empty where the second is not.
    parameters.transforms_any_plane =
        parameters.leaves_out_transforms && plan.colour.desc.channels == 2;
    // They need not have edges at the same places either. In atlases, which have masks, one tree takes
    // 1 % fewer bits (tests/regression/rd_pictures.md).
    parameters.plane_trees = parameters.prediction && plan.effort.pictures.plane_trees &&
                             plan.options.mask == nullptr && plan.colour.desc.channels == 2 &&
                             tile[axis_s] == 1 && tile[axis_t] == 1;
    return parameters;
}

double step_of_quality(double quality, SampleType type) {
    return smallest_step(type) * std::exp2((100.0 - quality) / 8.0);
}

} // namespace tessera
