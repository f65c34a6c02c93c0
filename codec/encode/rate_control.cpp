#include "codec/encode/rate_control.h"

#include "codec/fit/table_fit.h"
#include "codec/pass/steps.h"
#include "codec/trials/base_trial.h"
#include "codec/trials/copy_trial.h"
#include "codec/trials/table_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr double smallest_step = 0.5;

double largest_step(SampleType type) {
    return type == SampleType::unorm8 ? 512.0 : 32768.0;
}

// What a pass reached, on an axis where more is a larger step: -PSNR in dB / 6.02, or -log2(bytes).
struct Point {
    double log_step = 0, reached = 0;
};

// Next step to try so that `reached` meets `goal`: inside the bracket if there is one, by the secant
// of the two nearest points, else by the slope typical of these textures.
double next_step(std::vector<Point> points, double goal) {
    std::sort(points.begin(), points.end(), [goal](const Point& a, const Point& b) {
        return std::fabs(a.reached - goal) < std::fabs(b.reached - goal);
    });
    const Point& near = points.front();
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
    for (const Point& p : points)
        (p.reached < goal ? low : high) =
            p.reached < goal ? std::max(low, p.log_step) : std::min(high, p.log_step);
    if (low < high && high - low < 20) {
        // Where the curve has a cliff the secant creeps; every third step halves the bracket.
        if (points.size() % 3 == 0)
            return (low + high) / 2;
        next = std::clamp(next, low + 0.02 * (high - low), high - 0.02 * (high - low));
    }
    return next;
}

class RateSearch {
public:
    RateSearch(const EncodePlan& plan, const Sample& sample, const FileBytes& file_bytes)
        : plan_(plan), sample_(sample), file_bytes_(file_bytes),
          texels_(texel_count(plan.grid.size())) {
        if (!plan.effort.try_smooth || plan.colour.corrections)
            smooth_ = false;
        // A surface's directions are no views that are alike but for parallax.
        if (!plan.effort.try_base || plan.colour.corrections ||
            plan.options.description.proxy == Proxy::mesh)
            base_ = BasePictures{};
        if (!plan.effort.filter || plan.colour.corrections)
            filter_ = TileFilter{};
    }

    Result<RateOutcome> run() {
        using Kind = RateTarget::Kind;
        const RateTarget& rate = plan_.options.rate;
        switch (rate.kind) {
        case Kind::quality:
            return single(step_of_quality(rate.value, plan_.colour.desc.type));
        case Kind::max_error:
            return guaranteed(rate.value);
        case Kind::psnr:
            return to_goal(-rate.value / 6.0206);
        case Kind::bpt:
            return to_bytes(rate.value * static_cast<double>(texels_) / 8.0);
        case Kind::bytes:
            return to_bytes(rate.value);
        }
        return Status(ErrorCode::bad_argument, "unknown kind of rate target");
    }

private:
    // A whole pass, preceded by one over the sample to learn the tables (and, once, the filter and
    // which copies there are), and recoded under tables fitted to all of it. Of one that a journal
    // knows to be finished only the totals come back.
    Result<PassResult> full_pass(CodingParameters parameters, const char* stage) {
        if (plan_.effort.fit_tables || !smooth_ || !base_ || !filter_) {
            FilterStatistics to_mend;
            EncodePlan plan = plan_;
            plan.effort = plan.effort.for_samples();
            const auto train = [&] {
                return run_pass(plan, parameters, sample_, filter_ ? nullptr : &to_mend);
            };
            TESSERA_TRY_ASSIGN(PassResult trained, train());
            if (!base_) {
                TESSERA_TRY_ASSIGN(base_, choose_base_pictures(plan, sample_, trained));
                parameters.base = *base_;
                if (base_->on) {
                    TESSERA_TRY_ASSIGN(trained, train());
                }
            }
            if (!smooth_) {
                TESSERA_TRY_ASSIGN(const bool pays, smooth_copies_pay(plan, sample_, trained));
                smooth_ = parameters.smooth_copies = pays;
            }
            if (!filter_)
                filter_ = parameters.filter = fit_filter(to_mend);
            if (plan_.effort.fit_tables)
                TESSERA_TRY(learn(plan, trained, parameters));
        }
        return finished_or(parameters, [&] { return recoded_pass(parameters, passes_, stage); });
    }

    // Tables for a whole pass, from the sample's. The first ones are where later passes start from.
    Status learn(const EncodePlan& plan, const PassResult& trained, CodingParameters& parameters) {
        if (tables_) {
            parameters.parameters = fit_parameters(trained.totals.statistics);
            return {};
        }
        TESSERA_TRY_ASSIGN(const Parameters learnt,
                           learn_tables(plan, sample_, trained, parameters));
        tables_ = parameters.parameters = learnt;
        return {};
    }

    // The next pass: run, and put on record as finished, unless it is on record already.
    template <class Run>
    Result<PassResult> finished_or(const CodingParameters& parameters, const Run& run) {
        ++passes_;
        if (plan_.journal != nullptr)
            if (auto totals = plan_.journal->finished(passes_, parameters))
                return PassResult{passes_, parameters, parameters, {}, nullptr, *totals};
        TESSERA_TRY_ASSIGN(PassResult pass, run());
        TESSERA_TRY_ASSIGN(pass.totals.file_bytes, file_bytes_(pass));
        if (plan_.journal != nullptr)
            TESSERA_TRY(plan_.journal->finish(passes_, parameters, pass.totals));
        return pass;
    }

    Result<PassResult> recoded_pass(const CodingParameters& parameters, unsigned number,
                                    const char* stage) {
        Result<PassResult> pass = run_pass(plan_, parameters, number, stage);
        if (pass && plan_.effort.recode)
            TESSERA_TRY(recode_with_fitted_tables(plan_, *pass));
        return pass;
    }

    void drop(const PassResult& pass) {
        if (plan_.journal != nullptr)
            plan_.journal->drop(pass.number);
    }

    // The pass that was chosen, with its payloads: those of one that was finished before a resume
    // come from the journal now.
    Result<RateOutcome> outcome_of(PassResult pass, std::string note = {}) {
        if (pass.payloads == nullptr) {
            TESSERA_TRY_ASSIGN(pass, recoded_pass(pass.walked, pass.number, "encode"));
        }
        return RateOutcome{std::move(pass), passes_, std::move(note)};
    }

    CodingParameters for_step(double step) const {
        CodingParameters parameters = coding_parameters(step, plan_);
        parameters.smooth_copies = smooth_.value_or(false);
        parameters.base = base_.value_or(BasePictures{});
        parameters.filter = filter_.value_or(TileFilter{});
        if (tables_)
            parameters.parameters = *tables_;
        return parameters;
    }
    CodingParameters at(double log_step) const { return for_step(std::exp2(log_step)); }

    Result<RateOutcome> single(double step) {
        TESSERA_TRY_ASSIGN(PassResult pass, full_pass(for_step(step), "encode"));
        return outcome_of(std::move(pass));
    }

    // Corrections meet the error whatever the step, so the sample chooses the cheapest one.
    Result<RateOutcome> guaranteed(double error) {
        double best_step = 1, best_bytes = std::numeric_limits<double>::infinity();
        const auto width = static_cast<double>(2 * error + 1);
        for (const double factor : {0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.5}) {
            CodingParameters parameters = for_step(width * factor);
            parameters.correction_error = static_cast<std::uint16_t>(error);
            Result<PassResult> pass = run_pass(plan_, parameters, sample_);
            if (pass && plan_.effort.fit_tables) {
                parameters.parameters = fit_parameters(pass->totals.statistics);
                pass = run_pass(plan_, parameters, sample_);
            }
            TESSERA_TRY(pass);
            if (static_cast<double>(pass->payload_bytes()) < best_bytes) {
                best_bytes = static_cast<double>(pass->payload_bytes());
                best_step = width * factor;
            }
        }
        CodingParameters parameters = for_step(best_step);
        parameters.correction_error = static_cast<std::uint16_t>(error);
        TESSERA_TRY_ASSIGN(PassResult pass, full_pass(parameters, "encode"));
        return outcome_of(std::move(pass));
    }

    // Sample PSNR or bytes predict a first step; whole passes correct it.
    Result<double> first_log_step(double goal, bool bytes) {
        std::vector<Point> points{};
        double log_step = 3 + (plan_.colour.desc.type == SampleType::half16 ? 4 : 0);
        const double share =
            static_cast<double>(sample_.texel_count()) / static_cast<double>(texels_);
        const std::uint64_t texels_that_matter = sample_.texels_that_matter();
        for (int i = 0; i < 6; ++i) {
            TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(plan_, at(log_step), sample_));
            const double reached =
                bytes ? -std::log2(static_cast<double>(pass.payload_bytes() + 1) / share + 1000)
                      : -pass.psnr(plan_.colour.desc, texels_that_matter) / 6.0206;
            points.push_back({log_step, reached});
            if (std::fabs(reached - goal) < 0.02)
                break;
            log_step = std::clamp(next_step(points, goal), std::log2(smallest_step),
                                  std::log2(largest_step(plan_.colour.desc.type)));
        }
        return log_step;
    }

    Result<RateOutcome> to_goal(double goal) {
        // Another pass over a baker costs minutes, so it has to buy more.
        const double tolerance = (plan_.source.cheap_to_reread() ? 0.05 : 0.15) / 6.0206;
        // Aim inside the tolerance, so that one more pass usually ends it.
        return iterate(
            goal - tolerance / 2, false,
            [=](double reached) { return reached <= goal && reached >= goal - tolerance; },
            [=](double reached) { return reached <= goal; });
    }

    Result<RateOutcome> to_bytes(double bytes) {
        const double goal = -std::log2(bytes);
        const double tolerance = std::log2(1 / 0.98);
        return iterate(
            goal + tolerance / 3, true,
            [=](double reached) { return reached >= goal && reached <= goal + tolerance; },
            [=](double reached) { return reached >= goal; });
    }

    // Passes until `good`; otherwise the admissible pass nearest to the goal.
    template <class Good, class Admissible>
    Result<RateOutcome> iterate(double goal, bool bytes, Good good, Admissible admissible) {
        const int most = plan_.source.cheap_to_reread() ? 12 : 3;
        const double low = std::log2(smallest_step);
        const double high = std::log2(largest_step(plan_.colour.desc.type));
        TESSERA_TRY_ASSIGN(double log_step, first_log_step(goal, bytes));
        std::vector<Point> points;
        std::optional<PassResult> best;
        double best_distance = std::numeric_limits<double>::infinity();
        double last_reached = 0;
        double nudge = 0.02; // some 0.1 dB
        for (int i = 0;; ++i) {
            TESSERA_TRY_ASSIGN(PassResult pass, full_pass(at(log_step), "encode"));
            double reached = -pass.psnr(plan_.colour.desc, plan_.texels_that_matter) / 6.0206;
            if (bytes)
                reached = -std::log2(static_cast<double>(pass.totals.file_bytes));
            last_reached = reached;
            points.push_back({log_step, reached});
            const double distance = std::fabs(reached - goal) + (admissible(reached) ? 0 : 1e6);
            if (distance < best_distance && (admissible(reached) || !bytes)) {
                best_distance = distance;
                if (best)
                    drop(*best);
                best = std::move(pass);
            } else {
                drop(pass);
            }
            if (good(reached) || (log_step >= high && !admissible(reached)))
                break;
            double next = std::clamp(next_step(points, goal), low, high);
            if (i + 1 >= most || std::fabs(next - log_step) < 1e-4) {
                if (best && best_distance < 1e6)
                    break;
                // The curve jumps over the goal: on to the side that is allowed.
                next = std::clamp(log_step + (bytes ? nudge : -nudge), low, high);
                nudge *= 2;
                if (next == log_step)
                    break;
            }
            log_step = next;
        }
        if (!best)
            return target_is_missed(std::llround(std::exp2(-last_reached)));
        return outcome_of(
            std::move(*best),
            best_distance >= 1e6 ? "the target lies above what the finest quantiser reaches" : "");
    }

    Status target_is_missed(std::int64_t smallest) const {
        const std::string& name = plan_.options.rate_name;
        const Status missed(
            ErrorCode::bad_argument,
            "the target cannot be met: the smallest file of this texture has about " +
                std::to_string(smallest) + " bytes");
        return name.empty() ? missed : missed.with_context(name);
    }

    const EncodePlan& plan_;
    const Sample& sample_;
    const FileBytes& file_bytes_;
    const std::uint64_t texels_;
    unsigned passes_ = 0;
    // Empty until a trial at the step of the first whole pass has told; the same for all passes, so
    // that a search for a step sees no jumps.
    std::optional<bool> smooth_;
    std::optional<BasePictures> base_; // likewise
    std::optional<TileFilter> filter_; // likewise
    std::optional<Parameters> tables_; // likewise
};

} // namespace

Result<RateOutcome> control_rate(const EncodePlan& plan, const Sample& sample,
                                 const FileBytes& file_bytes) {
    return RateSearch(plan, sample, file_bytes).run();
}

} // namespace tessera
