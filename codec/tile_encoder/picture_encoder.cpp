#include "codec/tile_encoder/picture_encoder.h"

#include <algorithm>
#include <utility>

namespace tessera {
namespace {

constexpr int smallest_side = 4; // of blocks; sides of 2 save 0.3 %, and up to 2 % in dense detail
// Modes that are compared in luma only, before the best of them are compared in all planes.
constexpr std::size_t kept_of_luma = 8;
constexpr float rounding = 1e-5f; // a sum of costs is off by less than this share

// Appends the levels of one node to those of another.
void append(const TileLevels& from, TileLevels& to) {
    const auto shift = static_cast<std::uint32_t>(to.nonzeros.size());
    const auto join = [](const auto& items, auto& all) {
        all.insert(all.end(), items.begin(), items.end());
    };
    join(from.blocks, to.blocks);
    join(from.splits, to.splits);
    join(from.predictions, to.predictions);
    join(from.colours, to.colours);
    join(from.nonzeros, to.nonzeros);
    for (PlaneLevels plane : from.planes) {
        plane.first += shift;
        to.planes.push_back(plane);
    }
}

BlockPrediction from_border(BorderMode mode) {
    BlockPrediction prediction;
    prediction.mode = mode;
    return prediction;
}

} // namespace

float PictureEncoder::encode(const Block& root, TileLevels& out) {
    decoded_.resize(root.shape, coding_.planes);
    blocks_.memory = {};
    modes_ = {};
    Node node = encode_node(root, Freedom::all, unreachable_cost);
    out = std::move(node.levels);
    out.order.resize(out.blocks.size());
    for (std::size_t i = 0; i < out.order.size(); ++i)
        out.order[i] = static_cast<std::uint16_t>(i);
    if (!predicts_anything(out.predictions))
        out.forget_copies();
    return node.cost;
}

// Leaves the node in decoded_ and what it leads to in blocks_.memory and modes_. A node that costs
// `limit` or more is of no use: it is not the best one then, and nothing is left of it.
PictureEncoder::Node PictureEncoder::encode_node(const Block& block, Freedom freedom, float limit) {
    if (is_too_large(block.shape))
        return encode_parts(block, Split::spatial, freedom, limit);
    const Memory before = memory();
    decoded_.done.forget(block);
    Node best = encode_whole(block);
    const auto& n = block.shape.n;
    const auto attempt = [&](Split split, Freedom of_parts) {
        go_back(block, before);
        const float most = std::min(best.cost, limit);
        Node node = encode_parts(block, split, of_parts, most);
        if (node.cost < most)
            best = std::move(node);
    };
    const PictureSearch& options = pictures_;
    const bool can_halve_u = n[0] >= 2 * smallest_side, can_halve_v = n[1] >= 2 * smallest_side;
    if (!best.levels.nonzeros.empty() && freedom != Freedom::none) {
        const bool is_whole = freedom == Freedom::all;
        const auto attempt_halves = [&](Split split) {
            attempt(split, is_whole ? freedom_of_halves(split) : Freedom::none);
        };
        if (is_whole && can_halve_u && can_halve_v)
            attempt(Split::spatial, Freedom::all);
        if (options.halves && can_halve_u && freedom != Freedom::v)
            attempt_halves(Split::u);
        if (options.halves && can_halve_v && freedom != Freedom::u)
            attempt_halves(Split::v);
    }
    if (best.cost >= limit)
        return best;
    go_back(block, best.after);
    for (std::size_t i = 0; i < best.levels.blocks.size(); ++i)
        reconstruct_block(best.levels, i, coding_, scratch_, decoded_, search_.fineness());
    return best;
}

PictureEncoder::Freedom PictureEncoder::freedom_of_halves(Split split) const {
    if (!pictures_.quarters)
        return Freedom::none;
    if (pictures_.crossed_halves)
        return Freedom::u_or_v;
    return split == Split::u ? Freedom::u : Freedom::v;
}

PictureEncoder::Node PictureEncoder::encode_whole(const Block& block) {
    find_candidates(block);
    Node best;
    best.cost = unreachable_cost;
    const ColourMemory colours = blocks_.memory;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        BlockPrediction prediction = from_border(candidates_[i].mode);
        const bool tries_others = static_cast<int>(i) < pictures_.transform_modes &&
                                  transform_context(prediction.mode, block.shape) >= 0;
        offer(block, prediction, {&slots_[candidates_[i].slot], candidates_[i].estimate}, best);
        for (int plane = 0; tries_others && plane < coding_.planes; ++plane)
            find_difference(block, prediction.mode, plane);
        const int kinds =
            coding_.parameters.leaves_out_transforms ? transform_kinds : usual_transform_kinds;
        for (int kind = 1; tries_others && kind < kinds; ++kind) {
            prediction.transform = static_cast<BlockTransform>(kind);
            if (axis_transforms(prediction.transform, block.shape).all_cosines())
                continue;
            for (int plane = 0; plane < coding_.planes; ++plane)
                transform(block, prediction, plane, coefficients_);
            blocks_.memory = colours;
            offer(block, prediction, {&coefficients_, {}}, best);
        }
        blocks_.memory = colours;
    }
    best.cost += split_cost(block, Split::none);
    best.levels.shape = decoded_.shape;
    best.levels.blocks.assign(1, block);
    best.levels.splits.assign(1, static_cast<std::uint8_t>(Split::none));
    best.after.modes = modes_;
    best.after.modes.remember(block, best.levels.predictions[0].mode);
    return best;
}

// Codes the block with this prediction, and keeps that if it costs less than `best`.
void PictureEncoder::offer(const Block& block, const BlockPrediction& prediction,
                           const BlockEncoder::KnownBlock& known, Node& best) {
    trial_.clear();
    float cost = blocks_.encode(search_, block, prediction, known, trial_, best.cost) +
                 mode_cost(block, prediction.mode);
    if (cost >= best.cost)
        return;
    const auto kind = static_cast<std::size_t>(prediction.transform);
    const int context = transform_context(prediction.mode, block.shape);
    const bool has_symbol = context >= 0 && blocks_.has_transform_symbol(trial_);
    if (has_symbol)
        cost += bits_cost(costs_.transform[static_cast<std::size_t>(context)][kind]);
    else if (prediction.transform != BlockTransform::cosine)
        return; // a decoder would take cosines
    if (cost >= best.cost)
        return;
    best.cost = cost;
    best.after.colours = blocks_.memory;
    std::swap(best.levels, trial_);
    best.levels.predictions.assign(1, prediction);
}

// Stops early above `limit`.
PictureEncoder::Node PictureEncoder::encode_parts(const Block& block, Split split, Freedom freedom,
                                                  float limit) {
    Node node;
    node.levels.shape = decoded_.shape;
    node.levels.splits.push_back(static_cast<std::uint8_t>(split));
    if (!is_too_large(block.shape))
        node.cost = split_cost(block, split);
    const Children children = children_of(block, split);
    for (int i = 0; i < children.count && node.cost < limit; ++i) {
        const float left = limit - node.cost + rounding * limit;
        const Node part = encode_node(children.block[static_cast<std::size_t>(i)], freedom, left);
        node.cost += part.cost;
        append(part.levels, node.levels);
    }
    node.after = memory();
    return node;
}

// Writes one plane of the block, less its prediction, to difference_.
void PictureEncoder::find_difference(const Block& block, BorderMode mode, int plane) {
    const auto texels = static_cast<std::size_t>(block.shape.texels());
    std::vector<float>& difference = difference_[static_cast<std::size_t>(plane)];
    difference.resize(std::max(difference.size(), texels));
    predicted_.resize(std::max(predicted_.size(), texels));
    if (mode != mode_none)
        borders_[static_cast<std::size_t>(plane)].predict(mode, predicted_.data());
    search_.source().subtract(block, plane, mode != mode_none ? predicted_.data() : nullptr,
                              difference.data());
}

// Transforms one plane of difference_.
void PictureEncoder::transform(const Block& block, const BlockPrediction& prediction, int plane,
                               BlockCoefficients& out) {
    const auto p = static_cast<std::size_t>(plane);
    out.shape = block.shape;
    out.copies = false;
    out.is_predicted = prediction.is_predicted();
    out.fineness = search_.fineness();
    out.is_blank[p] = search_.source().transform_plane(
        block.shape, axis_transforms(prediction.transform, block.shape), difference_[p].data(),
        out.plane[p]);
}

// Finds the modes that cost least in luma.
void PictureEncoder::compare_luma(const Block& block) {
    slots_.resize(kept_of_luma + 1);
    of_luma_.clear();
    std::size_t free_slot = 0;
    const PictureSearch& options = pictures_;
    const int modes = borders_.empty()     ? mode_none + 1
                      : options.directions ? border_mode_count
                                           : mode_first_direction;
    for (int mode = 0; mode < modes; ++mode) {
        if (mode == mode_planar && !options.planar)
            continue;
        Candidate candidate;
        candidate.mode = static_cast<BorderMode>(mode);
        candidate.slot = free_slot;
        BlockCoefficients& coefficients = slots_[free_slot];
        for (int plane = 0; plane < first_planes(); ++plane) {
            find_difference(block, candidate.mode, plane);
            transform(block, from_border(candidate.mode), plane, coefficients);
        }
        candidate.luma = search_.estimate(coefficients, 0, first_planes(), 0);
        candidate.cost = candidate.luma + mode_cost(block, candidate.mode);
        // Ties go to the first mode, the same on every platform.
        of_luma_.insert(std::ranges::upper_bound(of_luma_, candidate.cost, {}, &Candidate::cost),
                        candidate);
        free_slot = of_luma_.size();
        if (of_luma_.size() > kept_of_luma) {
            free_slot = of_luma_.back().slot;
            of_luma_.pop_back();
        }
    }
}

// Finds the modes in which the block is coded, by estimates.
void PictureEncoder::find_candidates(const Block& block) {
    borders_.clear();
    if (pictures_.borders && (block.origin[0] > 0 || block.origin[1] > 0)) {
        const BorderReach reach = border_reach(block, decoded_.shape, decoded_.done);
        for (int plane = 0; plane < coding_.planes; ++plane)
            borders_.emplace_back(block, decoded_.shape, reach,
                                  decoded_.plane[static_cast<std::size_t>(plane)]);
    }
    compare_luma(block);
    candidates_.clear();
    const auto wanted = static_cast<std::size_t>(pictures_.coded_modes);
    for (Candidate candidate : of_luma_) {
        // Other planes cost at least 0, and later candidates cost more in luma.
        if (candidates_.size() == wanted && candidate.cost >= candidates_.back().cost)
            break;
        BlockCoefficients& coefficients = slots_[candidate.slot];
        for (int plane = first_planes(); plane < coding_.planes; ++plane) {
            find_difference(block, candidate.mode, plane);
            transform(block, from_border(candidate.mode), plane, coefficients);
        }
        candidate.estimate =
            search_.estimate(coefficients, first_planes(), coding_.planes, candidate.luma);
        candidate.cost = candidate.estimate + mode_cost(block, candidate.mode);
        candidates_.insert(
            std::ranges::upper_bound(candidates_, candidate.cost, {}, &Candidate::cost), candidate);
        if (candidates_.size() > wanted)
            candidates_.pop_back();
    }
}

// Goes to where the block is the next one to be decoded, with this memory.
void PictureEncoder::go_back(const Block& block, const Memory& memory) {
    blocks_.memory = memory.colours;
    modes_ = memory.modes;
    decoded_.done.forget(block);
}

} // namespace tessera
