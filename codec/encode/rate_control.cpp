#include "codec/encode/rate_control.h"

#include "codec/encode/rate_forecast.h"
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

// Octaves of the step from where tables were learnt to where they are learnt anew.
constexpr double far_from_tables = 0.5;

class RateSearch {
public:
    RateSearch(const EncodePlan& plan, const Sample& sample, const FileBytes& file_bytes)
        : plan_(plan), sample_(sample), file_bytes_(file_bytes),
          texels_(texel_count(plan.views.texture_size())) {
        if (!plan.effort.try_smooth || plan.colour.corrections)
            smooth_ = false;
        if (!can_have_base_pictures(plan))
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
            return to_psnr(rate.value);
        case Kind::bpt:
            return to_bytes(rate.value * static_cast<double>(texels_) / 8.0);
        case Kind::bytes:
            return to_bytes(rate.value);
        }
        return Status(ErrorCode::bad_argument, "unknown kind of rate target");
    }

private:
    // A pass over the sample, to learn the tables (and, once, the filter and which copies there are).
    Status prepare(CodingParameters& parameters) {
        if (plan_.effort.fit_tables || !smooth_ || !base_ || !filter_) {
            FilterStatistics to_mend;
            EncodePlan plan = plan_;
            plan.effort = plan.effort.for_samples();
            if (needs_counts_only()) {
                TESSERA_TRY_ASSIGN(const Statistics counts,
                                   count_symbols(plan, parameters, sample_));
                parameters.parameters = fit_parameters(counts);
                if (!tables_)
                    tables_ = parameters.parameters;
                return {};
            }
            const auto train = [&] {
                to_mend = {};
                return run_pass(plan, parameters, sample_, filter_ ? nullptr : &to_mend);
            };
            // Smooth copies mostly pay, but not beside base pictures.
            parameters.base = base_.value_or(plan.parallax);
            parameters.smooth_copies = smooth_.value_or(!parameters.base.on);
            TESSERA_TRY_ASSIGN(PassResult trained, train());
            if (!base_) {
                TESSERA_TRY_ASSIGN(base_, choose_base_pictures(plan, sample_, trained));
                if (base_->on)
                    smooth_ = false;
                if (*base_ != trained.walked.base) { // which mostly are right as they are
                    parameters.base = *base_;
                    parameters.smooth_copies = smooth_.value_or(true);
                    TESSERA_TRY_ASSIGN(trained, train());
                }
            }
            if (!smooth_) {
                TESSERA_TRY_ASSIGN(const bool harm, smooth_copies_harm(plan, sample_, trained));
                smooth_ = parameters.smooth_copies = !harm;
            }
            if (!filter_)
                filter_ = parameters.filter = fit_filter(to_mend);
            if (plan_.effort.fit_tables)
                TESSERA_TRY(learn(plan, trained, parameters));
        }
        return {};
    }

    // Whether a sample has nothing to say but what tables are.
    bool needs_counts_only() const {
        return plan_.effort.fit_tables && !plan_.effort.try_dense && !plan_.colour.corrections &&
               smooth_ && base_ && filter_;
    }

    // A whole pass, recoded under tables fitted to all of it. Of one that a journal knows to be finished
    // only the totals come back.
    Result<PassResult> whole_pass(const CodingParameters& parameters) {
        return finished_or(parameters, [&] { return recoded_pass(parameters, passes_, "encode"); });
    }

    Result<PassResult> prepared_pass(CodingParameters parameters) {
        TESSERA_TRY(prepare(parameters));
        return whole_pass(parameters);
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
                return PassResult{passes_, parameters, parameters, {}, nullptr, *totals, {}};
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
    Result<RateOutcome> outcome_of(PassResult pass) {
        if (pass.payloads == nullptr) {
            TESSERA_TRY_ASSIGN(pass, recoded_pass(pass.walked, pass.number, "encode"));
        }
        return RateOutcome{std::move(pass), passes_, false, {}};
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
        TESSERA_TRY_ASSIGN(PassResult pass, prepared_pass(for_step(step)));
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
        TESSERA_TRY_ASSIGN(PassResult pass, prepared_pass(parameters));
        return outcome_of(std::move(pass));
    }

    Result<RateOutcome> to_psnr(double psnr) {
        // Another pass over a baker costs minutes, so it has to buy more. The aim is inside the tolerance,
        // so that one more pass usually ends it.
        const double tolerance = (plan_.source.cheap_to_reread() ? 0.05 : 0.15) / db_per_doubling;
        return iterate({place_of_psnr(psnr), tolerance, tolerance / 2, false});
    }

    Result<RateOutcome> to_bytes(double bytes) {
        const double tolerance = std::log2(1 / 0.98);
        return iterate({place_of_bytes(bytes), tolerance, tolerance / 3, true});
    }

    // A target on the axis of RatePoint.
    struct Goal {
        double limit;             // never passed
        double tolerance, inside; // how far from the limit is near enough, and how far passes aim
        bool bytes;               // else PSNR

        double aim() const { return limit + (bytes ? inside : -inside); }
        // Below 0: not allowed.
        double slack(double reached) const { return bytes ? reached - limit : limit - reached; }
        // Passes at nearly the same step differ, in small textures by more than the tolerance: what is
        // allowed after several of them is not worth a further one.
        double near_enough(int passes) const {
            return passes < 6 ? tolerance * (1 << std::min(passes - 1, 2))
                              : std::numeric_limits<double>::infinity();
        }
    };

    // Makes ready for passes near a step.
    Status prepare_at(double log_step) {
        if (prepared_at_ && std::fabs(*prepared_at_ - log_step) < far_from_tables)
            return {};
        prepared_at_ = log_step;
        CodingParameters parameters = at(log_step);
        TESSERA_TRY(prepare(parameters));
        if (plan_.effort.fit_tables)
            tables_ = parameters.parameters;
        return {};
    }

    // The step of the first whole pass.
    Result<double> first_log_step(RateForecast& forecast, double goal) {
        TESSERA_TRY_ASSIGN(const double log_step, forecast.step_for(goal));
        TESSERA_TRY(prepare_at(log_step));
        TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(plan_, at(log_step), sample_));
        TESSERA_TRY(forecast.learn_from_sample(log_step, pass));
        return forecast.step_for(goal);
    }

    // Passes until one is near enough; otherwise the allowed one that is nearest.
    Result<RateOutcome> iterate(const Goal& goal) {
        const int most = plan_.source.cheap_to_reread() ? 12 : 3;
        const auto [low, high] = StepRange::of(plan_.colour.desc.type);
        RateForecast forecast(plan_, sample_, goal.bytes);
        TESSERA_TRY_ASSIGN(double log_step, first_log_step(forecast, goal.aim()));
        std::vector<RatePoint> points;
        std::optional<PassResult> best;
        double best_slack = -std::numeric_limits<double>::infinity();
        double nudge = 0.02; // some 0.1 dB
        for (int passes = 1;; ++passes) {
            TESSERA_TRY(prepare_at(log_step));
            TESSERA_TRY_ASSIGN(PassResult pass, whole_pass(at(log_step)));
            const double reached =
                goal.bytes ? place_of_bytes(static_cast<double>(pass.totals.file_bytes))
                           : place_of_psnr(pass.psnr(plan_.colour.desc, plan_.texels_that_matter));
            points.push_back({log_step, reached});
            const double slack = goal.slack(reached);
            const bool is_better =
                best_slack < 0 ? slack > best_slack : slack >= 0 && slack < best_slack;
            if (is_better && (slack >= 0 || !goal.bytes)) {
                best_slack = slack;
                if (best)
                    drop(*best);
                best = std::move(pass);
            } else {
                drop(pass);
            }
            const bool is_met = best_slack >= 0;
            // Beyond the largest step no file is smaller; a PSNR that is missed there has finer steps left.
            const bool is_hopeless = goal.bytes && log_step >= high && slack < 0;
            if ((is_met && best_slack <= goal.near_enough(passes)) || is_hopeless)
                break;
            double next = std::clamp(next_step(points, goal.aim()), low, high);
            if (passes == 1) {
                TESSERA_TRY(forecast.learn(points.back()));
                TESSERA_TRY_ASSIGN(const double foretold, forecast.step_for(goal.aim()));
                // Quick passes may have a cliff where whole ones have none.
                const bool is_towards_goal = (foretold - log_step) * (goal.aim() - reached) > 0;
                if (is_towards_goal && std::fabs(foretold - log_step) > 1e-3)
                    next = foretold;
            }
            if (passes >= most || std::fabs(next - log_step) < 1e-4) {
                if (is_met)
                    break;
                // The curve jumps over the goal: on to the side that is allowed.
                next = std::clamp(log_step + (goal.bytes ? nudge : -nudge), low, high);
                nudge *= 2;
                if (next == log_step)
                    break;
            }
            log_step = next;
        }
        if (!best)
            return target_is_missed(std::llround(std::exp2(-points.back().reached)));
        RateOutcome outcome;
        TESSERA_TRY_ASSIGN(outcome, outcome_of(std::move(*best)));
        outcome.is_missed = best_slack < 0;
        if (outcome.is_missed)
            outcome.note = "the target lies above what the finest quantiser reaches";
        return outcome;
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
    std::optional<BasePictures> base_;  // likewise
    std::optional<TileFilter> filter_;  // likewise
    std::optional<Parameters> tables_;  // likewise
    std::optional<double> prepared_at_; // log2 of the step
};

} // namespace

Result<RateOutcome> control_rate(const EncodePlan& plan, const Sample& sample,
                                 const FileBytes& file_bytes) {
    return RateSearch(plan, sample, file_bytes).run();
}

} // namespace tessera
