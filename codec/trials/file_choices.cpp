#include "codec/trials/file_choices.h"

#include "codec/fit/table_fit.h"
#include "codec/pass/steps.h"
#include "codec/pass/tile_figures.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/texels/sample_tiles.h"
#include "codec/trials/table_trial.h"
#include "codec/trials/tile_shapes.h"

#include <algorithm>

namespace tessera {
namespace {

// Tiles that trials of base pictures encode again; fewer of large tiles, but at least two.
constexpr std::uint64_t tiles_for_bases = 4;
// Base pictures, and wider margins, that gain less than this share are not worth their encoding
// time.
constexpr double least_gain = 0.01;
constexpr std::uint8_t margins[] = {4, 8};
constexpr std::uint64_t tiles_for_smoothing = 2;
// Plain copies must cost less than this share of smooth ones. Two tiles cannot tell more precisely,
// and where smoothing harms, in views that differ by whole texels, it harms much more.
constexpr double clearly_less = 0.995;

// The tiles of a sample that took most bytes, to be encoded again with other parameters.
class HeavyTiles {
public:
    // `known`: a pass over the sample. `plan` outlives this.
    HeavyTiles(const EncodePlan& plan, const Sample& sample, const PassResult& known,
               std::uint64_t most)
        : plan_(plan) {
        std::vector<std::uint64_t> bytes;
        for (const CodedTile& tile : known.tiles)
            bytes.push_back(tile.payload_bytes);
        for (const std::size_t i : largest_values(bytes, most)) {
            tiles_.boxes.push_back(sample.boxes[i]);
            tiles_.tiles.push_back(sample.tiles[i]);
            known_cost_ += lagrangian_cost(plan, known.walked, known.tiles[i]);
        }
    }

    double known_cost() const { return known_cost_; } // in the pass `known`
    Result<double> cost(const CodingParameters& parameters) const {
        TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(plan_, parameters, tiles_));
        return lagrangian_cost(plan_, pass);
    }

private:
    const EncodePlan& plan_;
    Sample tiles_;
    double known_cost_ = 0;
};

BlockShape shape_of_tiles(const EncodePlan& plan) {
    return tile_shape(Box4::whole(plan.grid.tile_extent()));
}

bool can_have_base_pictures(const EncodePlan& plan) {
    return base_shape(shape_of_tiles(plan), plan.parallax).has_value();
}

// Compares the base pictures of the pass `narrow` with none and, if they pay, with wider margins.
// Copies beside base pictures are not smoothed.
Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& narrow) {
    const std::uint64_t affordable =
        tiles_for_bases * usual_tile_texels / texel_count(plan.grid.tile_extent());
    const HeavyTiles tiles(plan, sample, narrow,
                           std::clamp<std::uint64_t>(affordable, 2, tiles_for_bases));
    const auto cost_with = [&](const BasePictures& pictures) {
        CodingParameters parameters = narrow.walked;
        parameters.base = pictures;
        parameters.smooth_copies = !pictures.on;
        return tiles.cost(parameters);
    };
    TESSERA_TRY_ASSIGN(const double plain, cost_with({}));
    if (tiles.known_cost() >= (1 - least_gain) * plain)
        return BasePictures{};
    BasePictures best = narrow.walked.base;
    double least = (1 - least_gain) * tiles.known_cost();
    for (const std::uint8_t margin : margins) {
        BasePictures wider = best;
        wider.margin = margin;
        TESSERA_TRY_ASSIGN(const double cost, cost_with(wider));
        if (cost >= least)
            break;
        least = cost;
        best = wider;
    }
    return best;
}

// `smooth`: a pass over the sample with smooth copies.
Result<bool> smooth_copies_pay(const EncodePlan& plan, const Sample& sample,
                               const PassResult& smooth) {
    const HeavyTiles tiles(plan, sample, smooth, tiles_for_smoothing);
    CodingParameters plain = smooth.walked;
    plain.smooth_copies = false;
    TESSERA_TRY_ASSIGN(const double cost, tiles.cost(plain));
    return cost >= clearly_less * tiles.known_cost();
}

} // namespace

FileChoices::FileChoices(const EncodePlan& plan, const Sample& sample)
    : plan_(plan), sample_(sample) {
    // A tile of one view has no other to copy.
    if (!plan.effort.try_smooth || plan.colour.corrections || is_picture(shape_of_tiles(plan)))
        smooth_ = false;
    if (!can_have_base_pictures(plan))
        base_ = BasePictures{};
    if (!plan.effort.filter || plan.colour.corrections)
        filter_ = TileFilter{};
}

CodingParameters FileChoices::for_step(double step) const {
    CodingParameters parameters = coding_parameters(step, plan_);
    parameters.smooth_copies = smooth_.value_or(false);
    parameters.base = base_.value_or(BasePictures{});
    parameters.filter = filter_.value_or(TileFilter{});
    if (tables_)
        parameters.parameters = *tables_;
    return parameters;
}

Result<CodingParameters> FileChoices::prepare(CodingParameters parameters) {
    const bool fits_tables = plan_.effort.fit_tables;
    if (is_decided() && !fits_tables)
        return parameters;
    EncodePlan plan = plan_;
    plan.effort = plan.effort.for_samples();
    if (can_have_base_pictures(plan)) { // one quick round tells enough, and a second takes as long
        plan.effort.copy_rounds = 1;
        plan.effort.quick_bases = true;
    }
    if (is_decided() && !plan.effort.try_dense && !plan.colour.corrections) {
        TESSERA_TRY_ASSIGN(const Statistics counts, count_symbols(plan, parameters, sample_));
        tables_ = parameters.parameters = fit_parameters(counts, parameters.defaults);
        return parameters;
    }
    FilterStatistics statistics;
    const auto train = [&] {
        statistics = {};
        return run_pass(plan, parameters, sample_, filter_ ? nullptr : &statistics);
    };
    // What mostly pays comes first: base pictures, or smooth copies if there are none.
    parameters.base = base_.value_or(plan.parallax);
    parameters.smooth_copies = smooth_.value_or(!parameters.base.on);
    TESSERA_TRY_ASSIGN(PassResult trained, train());
    if (!base_) {
        TESSERA_TRY_ASSIGN(base_, choose_base_pictures(plan, sample_, trained));
        if (base_->on)
            smooth_ = false;
        if (*base_ != trained.walked.base) {
            parameters.base = *base_;
            parameters.smooth_copies = smooth_.value_or(true);
            if (!base_->on) { // a wider margin changes tables and filter too little
                TESSERA_TRY_ASSIGN(trained, train());
            }
        }
    }
    if (!smooth_) {
        TESSERA_TRY_ASSIGN(smooth_, smooth_copies_pay(plan, sample_, trained));
        parameters.smooth_copies = *smooth_;
    }
    if (!filter_)
        filter_ = parameters.filter = fit_filter(statistics);
    if (!fits_tables)
        return parameters;
    if (tables_) {
        parameters.parameters = fit_parameters(trained.totals.statistics, parameters.defaults);
    } else {
        CodingParameters as_trained = parameters;
        as_trained.base = trained.walked.base; // that of its trees
        TESSERA_TRY_ASSIGN(parameters.parameters, learn_tables(plan, sample_, trained, as_trained));
    }
    tables_ = parameters.parameters;
    return parameters;
}

} // namespace tessera
