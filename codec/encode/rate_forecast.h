// Predicts the step of a rate target by quick passes over the sample.
#pragma once

#include "codec/pass/sample_pass.h"

#include <cmath>
#include <vector>

namespace tessera {

// What a pass reached, on an axis that grows with the step: -PSNR in dB / 6.02, or -log2(bytes).
struct RatePoint {
    double log_step = 0, reached = 0;
};
constexpr double db_per_doubling = 6.0206; // of an error
inline double place_of_psnr(double db) {
    return -db / db_per_doubling;
}
inline double place_of_bytes(double bytes) {
    return -std::log2(bytes);
}

// The steps among which a target is searched.
struct StepRange {
    double low = 0, high = 0; // log2
    static StepRange of(SampleType type);
};

// The next step (log2) to try so that `reached` meets `goal`: along the secant of the two nearest
// points, or a typical slope if there is only one, and inside the bracket if there is one. `points`
// must not be empty.
double next_step(std::vector<RatePoint> points, double goal);

// Quick passes over the sample follow the same curve as whole passes at a nearly constant distance.
// The forecast measures that distance, and corrects it after every slower pass. A quick pass takes
// a twentieth of the time of one at the usual effort.
class RateForecast {
public:
    // Both outlive this. bytes: the target is a size, not a PSNR.
    RateForecast(const EncodePlan& plan, const Sample& sample, bool bytes);

    // The step (log2) at which a whole pass should reach `goal`. The first call also runs a quick
    // pass over the whole texture if that is quick to read. Errors: those of run_pass.
    Result<double> step_for(double goal);
    // Corrects the distance by a pass over the sample with all tools.
    Status learn_from_sample(double log_step, const PassResult& pass);
    // Corrects it by what a whole pass reached.
    Status learn(RatePoint whole);

private:
    double reached_by(const PassResult& pass, double share, std::uint64_t texels) const;
    double reached_by_sample(const PassResult& pass) const;
    Result<double> quick(double log_step);
    // Measures the distance from the sample to the whole texture.
    Status look_at_all(double log_step);
    // The step at which a quick pass over the sample reaches `goal`, predicted from quick passes of
    // which one came within `tolerance`.
    Result<double> quick_step_for(double goal, double tolerance);

    const EncodePlan quick_;
    const Sample& sample_;
    const bool bytes_;
    const StepRange range_;
    const double share_; // of the texture's texels in the sample
    double shift_ = 0;   // distance from quick passes over the sample to whole passes
    bool looked_at_all_ = false;
    std::vector<RatePoint> points_; // of quick passes over the sample
};

} // namespace tessera
