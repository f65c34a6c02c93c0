#include "codec/trials/trial_plan.h"

#include "codec/pass/steps.h"
#include "codec/trials/background.h"

namespace tessera {

EncodePlan plan_of_trial(const EncodePlan& plan, const Sample& sample, int effort) {
    EncodePlan trial = plan;
    trial.colour.background = find_background(sample, plan.colour.desc);
    trial.effort = EffortSettings::of(effort, plan.tools).for_samples();
    return trial;
}

EncodePlan keep_green(const EncodePlan& plan, Sample& sample) {
    EncodePlan green = plan;
    TextureDesc& desc = green.colour.desc;
    if (desc.channels < 3)
        return green;
    const std::size_t bytes = sample_bytes(desc.type), texel_bytes = desc.texel_bytes();
    for (TileTexels& tile : sample.tiles) {
        std::vector<std::byte>& texels = tile.texels;
        std::size_t to = 0;
        for (std::size_t from = bytes; from < texels.size(); from += texel_bytes)
            for (std::size_t i = 0; i < bytes; ++i)
                texels[to++] = texels[from + i];
        texels.resize(to);
    }
    desc.channels = 1;
    green.colour.transform = ColourTransform::none;
    return green;
}

CodingParameters parameters_of_trial(const EncodePlan& trial) {
    constexpr double typical_quality = 58;
    const RateTarget& rate = trial.options.rate;
    const double quality = rate.kind == RateTarget::Kind::quality ? rate.value : typical_quality;
    return coding_parameters(step_of_quality(quality, trial.colour.desc.type), trial);
}

} // namespace tessera
