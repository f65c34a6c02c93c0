#include "codec/encode/rate_forecast.h"

#include "codec/pass/steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera {
namespace {

constexpr int quick_effort = 1;
constexpr int most_quick_passes = 6; // for one goal
// On the axis of RatePoint. 0.01 is 0.06 dB or 0.7 % of bytes. Before the pass over the whole
// texture, which moves the goal, less precision is enough.
constexpr double near_enough = 0.01, near_enough_to_look = 0.1;
constexpr double most_shift = 1.5;  // a larger one comes from a cliff, such as stored tiles
constexpr double head_bytes = 1000; // of a file, about

EncodePlan quick_plan(const EncodePlan& plan) {
    EncodePlan quick = plan;
    quick.effort = EffortSettings::of(std::min(quick_effort, plan.options.effort), plan.tools);
    quick.effort.dependent = plan.effort.dependent; // otherwise steps would not be comparable
    quick.journal = nullptr;
    quick.keeps_payloads = false;
    return quick;
}

} // namespace

StepRange StepRange::of(SampleType type) {
    switch (type) { // without default, so that the compiler names a type that is missing
    case SampleType::unorm8:
        break;
    case SampleType::half16:
        return {-1, 15};
    }
    return {-1, 9};
}

double next_step(std::vector<RatePoint> points, double goal) {
    std::sort(points.begin(), points.end(), [goal](const RatePoint& a, const RatePoint& b) {
        return std::fabs(a.reached - goal) < std::fabs(b.reached - goal);
    });
    const RatePoint& near = points.front();
    double slope = 0.7; // of -PSNR / 6.02 and of -log2(bytes), per doubling of the step
    for (std::size_t i = 1; i < points.size(); ++i) {
        const double run = points[i].log_step - near.log_step;
        const double rise = points[i].reached - near.reached;
        if (std::fabs(run) > 1e-4 && rise / run > 0.05) {
            slope = rise / run;
            break;
        }
    }
    double next = near.log_step + std::clamp((goal - near.reached) / slope, -4.0, 4.0);
    double low = -1e9, high = 1e9;
    for (const RatePoint& p : points)
        (p.reached < goal ? low : high) =
            p.reached < goal ? std::max(low, p.log_step) : std::min(high, p.log_step);
    if (low < high && high - low < 20) {
        // Near a cliff of the curve the secant hardly moves, so every fifth step halves the
        // bracket.
        if (points.size() % 5 == 0)
            return (low + high) / 2;
        next = std::clamp(next, low + 0.02 * (high - low), high - 0.02 * (high - low));
    }
    return next;
}

RateForecast::RateForecast(const EncodePlan& plan, const Sample& sample, bool bytes)
    : quick_(quick_plan(plan)), sample_(sample), bytes_(bytes),
      range_(StepRange::of(plan.colour.desc.type)),
      share_(static_cast<double>(sample.texel_count()) /
             static_cast<double>(texel_count(plan.grid.size()))) {}

double RateForecast::reached_by(const PassResult& pass, double share, std::uint64_t texels) const {
    return bytes_
               ? place_of_bytes(static_cast<double>(pass.payload_bytes() + 1) / share + head_bytes)
               : place_of_psnr(pass.psnr(quick_.colour.desc, texels));
}

double RateForecast::reached_by_sample(const PassResult& pass) const {
    return reached_by(pass, share_, sample_.texels_that_matter());
}

Result<double> RateForecast::quick(double log_step) {
    for (const RatePoint& point : points_)
        if (point.log_step == log_step)
            return point.reached;
    TESSERA_TRY_ASSIGN(const PassResult pass,
                       run_pass(quick_, coding_parameters(std::exp2(log_step), quick_), sample_));
    points_.push_back({log_step, reached_by_sample(pass)});
    return points_.back().reached;
}

Status RateForecast::look_at_all(double log_step) {
    looked_at_all_ = true;
    if (share_ == 1 || !quick_.source.cheap_to_reread())
        return {};
    TESSERA_TRY_ASSIGN(const double of_sample, quick(log_step));
    TESSERA_TRY_ASSIGN(
        const PassResult pass,
        run_pass(quick_, coding_parameters(std::exp2(log_step), quick_), 0, "search"));
    shift_ = std::clamp(reached_by(pass, 1, quick_.texels_that_matter) - of_sample, -most_shift,
                        most_shift);
    return {};
}

Result<double> RateForecast::quick_step_for(double goal, double tolerance) {
    double log_step =
        points_.empty() ? (range_.low + range_.high) / 2 - 1 : next_step(points_, goal);
    for (int i = 0;; ++i) {
        log_step = std::clamp(log_step, range_.low, range_.high);
        TESSERA_TRY_ASSIGN(const double reached, quick(log_step));
        if (std::fabs(reached - goal) < tolerance || i + 1 == most_quick_passes)
            break;
        const double next = std::clamp(next_step(points_, goal), range_.low, range_.high);
        if (std::fabs(next - log_step) < 1e-3)
            break;
        log_step = next;
    }
    // Within the tolerance, the secant is more precise than another quick pass.
    return std::clamp(next_step(points_, goal), range_.low, range_.high);
}

Result<double> RateForecast::step_for(double goal) {
    if (!looked_at_all_) {
        TESSERA_TRY_ASSIGN(const double first, quick_step_for(goal, near_enough_to_look));
        TESSERA_TRY(look_at_all(first));
    }
    return quick_step_for(goal - shift_, near_enough);
}

Status RateForecast::learn_from_sample(double log_step, const PassResult& pass) {
    TESSERA_TRY_ASSIGN(const double reached, quick(log_step));
    shift_ = std::clamp(shift_ + reached_by_sample(pass) - reached, -most_shift, most_shift);
    return {};
}

Status RateForecast::learn(RatePoint whole) {
    TESSERA_TRY_ASSIGN(const double reached, quick(whole.log_step));
    shift_ = std::clamp(whole.reached - reached, -most_shift, most_shift);
    return {};
}

} // namespace tessera
