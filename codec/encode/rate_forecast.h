// Where the step of a rate target lies, foretold by quick passes over the sample.
#pragma once

#include "codec/pass/encode_pass.h"

#include <cmath>
#include <vector>

namespace tessera {

// What a pass reached, on an axis where more is a larger step: -PSNR in dB / 6.02, or -log2(bytes).
struct RatePoint {
    double log_step = 0, reached = 0;
};
constexpr double db_per_doubling = 6.0206; // of the step
inline double place_of_psnr(double db) {
    return -db / db_per_doubling;
}
inline double place_of_bytes(double bytes) {
    return -std::log2(bytes);
}

// The steps that a target may end at.
struct StepRange {
    double low = 0, high = 0; // log2
    static StepRange of(SampleType type);
};

// Next step to try so that `reached` meets `goal`: inside the bracket if there is one, by the secant
// of the two nearest points, else by the slope typical of these textures. `points` is not empty.
double next_step(std::vector<RatePoint> points, double goal);

// Quick passes have the shape of the curve that whole passes follow, and lie a nearly constant distance
// off: one that is measured, and measured again, as better is known. A quick pass takes a twentieth of
// the time of one at the usual effort.
class RateForecast {
public:
    // Refers to both. bytes: the target is a size, not a PSNR.
    RateForecast(const EncodePlan& plan, const Sample& sample, bool bytes);

    // The step at which a whole pass should reach `goal`. The first call also goes over the whole texture
    // once, quickly, where that is cheap to read. Errors: the source's.
    Result<double> step_for(double goal);
    // A pass over the sample with all tools, at a step that step_for gave.
    Status learn_from_sample(double log_step, const PassResult& pass);
    // What a whole pass reached.
    Status learn(RatePoint whole);

private:
    double reached_by(const PassResult& pass, double share, std::uint64_t texels) const;
    double reached_by_sample(const PassResult& pass) const;
    Result<double> quick(double log_step);
    Status look_at_all(double log_step);
    // The step at which a quick pass over the sample reaches `goal`, once one came within `tolerance`.
    Result<double> quick_step_for(double goal, double tolerance);

    const EncodePlan quick_;
    const Sample& sample_;
    const bool bytes_;
    const StepRange range_;
    const double share_; // of the texture, that is in the sample
    double shift_ = 0;   // from quick passes over the sample to whole passes
    bool looked_at_all_ = false;
    std::vector<RatePoint> points_; // quick, of the sample
};

} // namespace tessera
