#include "codec/encode/rate_control.h"

#include "codec/encode/rate_forecast.h"
#include "codec/fit/table_fit.h"
#include "codec/pass/sample_pass.h"
#include "codec/pass/steps.h"
#include "codec/trials/file_choices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace tessera {
namespace {

// Tables are learnt again if the step moved by this much since, in octaves.
constexpr double far_from_tables = 0.5;
constexpr double first_nudge = 0.02; // octaves of the step, about 0.1 dB
constexpr double infinite = std::numeric_limits<double>::infinity();

// A target on the axis of RatePoint.
struct Goal {
    double limit;     // must be kept to
    double tolerance; // how far from the limit a first pass may end
    double inside;    // how far from the limit passes aim, so that few miss it
    bool bytes;       // else PSNR

    double aim() const { return limit + (bytes ? inside : -inside); }
    // Distance from the limit; below 0 the limit is not kept to.
    double slack(double reached) const { return bytes ? reached - limit : limit - reached; }
    // Passes at nearly the same step differ, in small textures by more than the tolerance, so later
    // passes are accepted farther off.
    double near_enough(std::size_t passes) const {
        return passes < 6 ? tolerance * (1 << std::min<std::size_t>(passes - 1, 2)) : infinite;
    }
};

// The whole passes towards a goal.
struct Search {
    std::vector<RatePoint> points = {};
    std::optional<PassResult> best = std::nullopt;
    double best_slack = -infinite;
    double nudge = first_nudge;

    bool is_met() const { return best_slack >= 0; }
};

class RateControl {
public:
    RateControl(const EncodePlan& plan, const Sample& sample, const FileBytes& file_bytes)
        : plan_(plan), sample_(sample), file_bytes_(file_bytes), choices_(plan, sample),
          range_(StepRange::of(plan.colour.desc.type)) {}

    Result<RateOutcome> run() {
        using Kind = RateTarget::Kind;
        const RateTarget& rate = plan_.options.rate;
        const auto texels = static_cast<double>(texel_count(plan_.views.texture_size()));
        switch (rate.kind) {
        case Kind::quality:
            return single(choices_.for_step(step_of_quality(rate.value, plan_.colour.desc.type)));
        case Kind::max_error:
            return guaranteed(rate.value);
        case Kind::psnr:
            return to_psnr(rate.value);
        case Kind::bpt:
            return to_bytes(rate.value * texels / 8.0);
        case Kind::bytes:
            return to_bytes(rate.value);
        }
        return Status(ErrorCode::bad_argument, "unknown kind of rate target");
    }

private:
    Result<RateOutcome> single(CodingParameters parameters) {
        TESSERA_TRY_ASSIGN(parameters, choices_.prepare(parameters));
        TESSERA_TRY_ASSIGN(PassResult pass, whole_pass(parameters));
        return outcome_of(std::move(pass));
    }

    // Corrections keep to the error at any step, so the sample chooses the cheapest one.
    Result<RateOutcome> guaranteed(double error) {
        CodingParameters best;
        double best_bytes = infinite;
        for (const double factor : {0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.5}) {
            CodingParameters parameters = choices_.for_step((2 * error + 1) * factor);
            parameters.correction_error = static_cast<std::uint16_t>(error);
            const CodingParameters with_default_tables = parameters;
            Result<PassResult> pass = run_pass(plan_, parameters, sample_);
            if (pass && plan_.effort.fit_tables) {
                parameters.parameters =
                    fit_parameters(pass->totals.statistics, parameters.defaults);
                pass = run_pass(plan_, parameters, sample_);
            }
            TESSERA_TRY(pass);
            if (static_cast<double>(pass->payload_bytes()) < best_bytes) {
                best_bytes = static_cast<double>(pass->payload_bytes());
                best = with_default_tables;
            }
        }
        return single(best);
    }

    Result<RateOutcome> to_psnr(double psnr) {
        // A pass over a slow source takes minutes, so it has to gain more.
        const double tolerance = (plan_.source.cheap_to_reread() ? 0.05 : 0.15) / db_per_doubling;
        return iterate({.limit = place_of_psnr(psnr),
                        .tolerance = tolerance,
                        .inside = tolerance / 2,
                        .bytes = false});
    }

    Result<RateOutcome> to_bytes(double bytes) {
        const double tolerance = std::log2(1 / 0.98);
        return iterate({.limit = place_of_bytes(bytes),
                        .tolerance = tolerance,
                        .inside = tolerance / 3,
                        .bytes = true});
    }

    // Runs passes until one is near enough, and takes that or the nearest one that keeps to the
    // limit.
    Result<RateOutcome> iterate(const Goal& goal) {
        RateForecast forecast(plan_, sample_, goal.bytes);
        TESSERA_TRY_ASSIGN(double log_step, first_log_step(forecast, goal.aim()));
        Search search;
        for (;;) {
            TESSERA_TRY(prepare_at(log_step));
            TESSERA_TRY_ASSIGN(PassResult pass, whole_pass(at(log_step)));
            search.points.push_back({log_step, reached_by(pass, goal)});
            keep_better(std::move(pass), goal, search);
            if (search.is_met() && search.best_slack <= goal.near_enough(search.points.size()))
                break;
            TESSERA_TRY_ASSIGN(const std::optional<double> next,
                               next_log_step(goal, forecast, search));
            if (!next)
                break;
            log_step = *next;
        }
        if (!search.best)
            return target_is_missed(std::llround(std::exp2(-search.points.back().reached)));
        RateOutcome outcome;
        TESSERA_TRY_ASSIGN(outcome, outcome_of(std::move(*search.best)));
        outcome.is_missed = !search.is_met();
        if (outcome.is_missed)
            outcome.note = "the target lies above what the finest quantiser reaches";
        return outcome;
    }

    Result<double> first_log_step(RateForecast& forecast, double aim) {
        TESSERA_TRY_ASSIGN(const double log_step, forecast.step_for(aim));
        TESSERA_TRY(prepare_at(log_step));
        TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(plan_, at(log_step), sample_));
        TESSERA_TRY(forecast.learn_from_sample(log_step, pass));
        return forecast.step_for(aim);
    }

    double reached_by(const PassResult& pass, const Goal& goal) const {
        return goal.bytes ? place_of_bytes(static_cast<double>(pass.totals.file_bytes))
                          : place_of_psnr(pass.psnr(plan_.colour.desc, plan_.texels_that_matter));
    }

    // Keeps the pass of the last point if it is better than the best so far. A PSNR may be missed,
    // a size may not.
    void keep_better(PassResult pass, const Goal& goal, Search& search) {
        const double slack = goal.slack(search.points.back().reached);
        const bool is_better =
            search.is_met() ? slack >= 0 && slack < search.best_slack : slack > search.best_slack;
        if (!is_better || (slack < 0 && goal.bytes))
            return drop(pass);
        search.best_slack = slack;
        if (search.best)
            drop(*search.best);
        search.best = std::move(pass);
    }

    // The step of the next pass; nothing if further passes bring nothing.
    Result<std::optional<double>> next_log_step(const Goal& goal, RateForecast& forecast,
                                                Search& search) const {
        const auto [log_step, reached] = search.points.back();
        // No file is smaller than at the largest step.
        if (goal.bytes && log_step >= range_.high && goal.slack(reached) < 0)
            return std::optional<double>();
        double next = std::clamp(next_step(search.points, goal.aim()), range_.low, range_.high);
        if (search.points.size() == 1) {
            TESSERA_TRY(forecast.learn(search.points.back()));
            TESSERA_TRY_ASSIGN(const double forecast_step, forecast.step_for(goal.aim()));
            // A forecast in the wrong direction comes from a cliff that whole passes do not have.
            const bool is_towards_goal = (forecast_step - log_step) * (goal.aim() - reached) > 0;
            if (is_towards_goal && std::fabs(forecast_step - log_step) > 1e-3)
                next = forecast_step;
        }
        const std::size_t most_passes = plan_.source.cheap_to_reread() ? 12 : 3;
        if (search.points.size() < most_passes && std::fabs(next - log_step) >= 1e-4)
            return std::optional(next);
        if (search.is_met())
            return std::optional<double>();
        // The curve jumps across the limit: move to the side that keeps to it.
        next = std::clamp(log_step + (goal.bytes ? search.nudge : -search.nudge), range_.low,
                          range_.high);
        search.nudge *= 2;
        return next == log_step ? std::optional<double>() : std::optional(next);
    }

    Status prepare_at(double log_step) {
        if (prepared_at_ && std::fabs(*prepared_at_ - log_step) < far_from_tables)
            return {};
        prepared_at_ = log_step;
        return choices_.prepare(at(log_step)).status();
    }
    CodingParameters at(double log_step) const { return choices_.for_step(std::exp2(log_step)); }

    // The next pass over the whole texture, coded with tables fitted to all of it. If the journal
    // has recorded it as finished, only the totals come back.
    Result<PassResult> whole_pass(const CodingParameters& parameters) {
        ++passes_;
        if (plan_.journal != nullptr)
            if (auto totals = plan_.journal->finished(passes_, parameters))
                return PassResult{.number = passes_,
                                  .walked = parameters,
                                  .parameters = parameters,
                                  .totals = *totals};
        TESSERA_TRY_ASSIGN(PassResult pass, recoded_pass(parameters, passes_));
        TESSERA_TRY_ASSIGN(pass.totals.file_bytes, file_bytes_(pass));
        if (plan_.journal != nullptr)
            TESSERA_TRY(plan_.journal->finish(passes_, parameters, pass.totals));
        return pass;
    }

    Result<PassResult> recoded_pass(const CodingParameters& parameters, unsigned number) {
        Result<PassResult> pass = run_pass(plan_, parameters, number, "encode");
        if (pass && plan_.effort.recode)
            TESSERA_TRY(recode_with_fitted_tables(plan_, *pass));
        return pass;
    }

    void drop(const PassResult& pass) {
        if (plan_.journal != nullptr)
            plan_.journal->drop(pass.number);
    }

    // The chosen pass with its payloads. If it was finished before a resume, the journal has most
    // of them.
    Result<RateOutcome> outcome_of(PassResult pass) {
        if (pass.payloads == nullptr) {
            TESSERA_TRY_ASSIGN(pass, recoded_pass(pass.walked, pass.number));
        }
        return RateOutcome{.pass = std::move(pass), .passes = passes_};
    }

    Status target_is_missed(std::int64_t smallest) const {
        const std::string& name = plan_.options.labels.rate;
        const Status missed(
            ErrorCode::bad_argument,
            "the target cannot be met: the smallest file of this texture has about " +
                std::to_string(smallest) + " bytes");
        return name.empty() ? missed : missed.with_context(name);
    }

    const EncodePlan& plan_;
    const Sample& sample_;
    const FileBytes& file_bytes_;
    FileChoices choices_;
    const StepRange range_;
    unsigned passes_ = 0;
    std::optional<double> prepared_at_; // log2 of the step
};

} // namespace

Result<RateOutcome> control_rate(const EncodePlan& plan, const Sample& sample,
                                 const FileBytes& file_bytes) {
    return RateControl(plan, sample, file_bytes).run();
}

} // namespace tessera
