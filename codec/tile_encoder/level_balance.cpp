#include "codec/tile_encoder/level_balance.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "format/tile/colour_rotation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tessera {
namespace {

constexpr double paid_mean = 0.003; // codes; the error of a channel's mean that may be left
// A move may overshoot what is left of the debt by this factor.
constexpr double most_overpaid = 1.4;

std::int32_t first_level(const TileLevels& tile, const PlaneLevels& plane) {
    const auto levels = tile.levels(plane);
    return !levels.empty() && levels.front().index == 0 ? levels.front().level : 0;
}

double product(const Means& a, const std::array<float, max_planes>& b) {
    double sum = 0;
    for (std::size_t c = 0; c < max_planes; ++c)
        sum += a[c] * static_cast<double>(b[c]);
    return sum;
}

double square(const std::array<float, max_planes>& a) {
    double sum = 0;
    for (const float x : a)
        sum += static_cast<double>(x) * static_cast<double>(x);
    return sum;
}

// The number of a block's texels that matter.
int count_that_matter(const Block& block, const BlockShape& tile, const TileTexels& texels) {
    if (texels.matters.empty())
        return block.shape.texels();
    const auto& n = block.shape.n;
    const auto& o = block.origin;
    int count = 0;
    for (int v = o[1]; v < o[1] + n[1]; ++v) // box order
        for (int u = o[0]; u < o[0] + n[0]; ++u)
            for (int t = o[3]; t < o[3] + n[3]; ++t)
                for (int s = o[2]; s < o[2] + n[2]; ++s)
                    count += !texels.is_free(((v * tile.n[0] + u) * tile.n[3] + t) * tile.n[2] + s);
    return count;
}

} // namespace

LevelBalance::LevelBalance(const TileCoding& coding, const BitCosts& costs,
                           const ColourCoding& colour, float lambda)
    : coding_(&coding), costs_(&costs), colour_(&colour), lambda_(lambda),
      rotated_step_(coding.parameters.rotated_step.value()) {
    for (std::size_t plane = 0; plane < max_planes; ++plane)
        step_[plane] = coding.parameters.step[plane].value();
}

// A total order, so that the result does not depend on how the heap is built.
bool LevelBalance::is_dearer(const Offer& a, const Offer& b) {
    return a.price != b.price ? a.price > b.price : a.move > b.move;
}

void LevelBalance::add(const BlockCoefficients& block) {
    auto& first = firsts_.emplace_back();
    for (int plane = 0; plane < coding_->planes; ++plane)
        first[plane] = block.plane[plane][0];
}

const std::vector<std::size_t>& LevelBalance::pay(const Means& error, const TileTexels& texels,
                                                  TileLevels& tile) {
    const double count = tile.shape.texels() - static_cast<double>(free_count(texels.matters));
    Means debt{};
    for (std::size_t c = 0; c < max_planes; ++c)
        debt[c] = -error[c] * count;
    find_moves(debt, texels, tile);
    by_.assign(tile.planes.size(), 0);
    changed_.clear();
    while (!offers_.empty() && largest_of(debt) > paid_mean * count) {
        std::pop_heap(offers_.begin(), offers_.end(), is_dearer); // few of many are taken
        const Move& move = moves_[offers_.back().move];
        offers_.pop_back();
        if (most_overpaid * product(debt, move.change) < square(move.change))
            continue;
        by_[move.plane] = static_cast<std::int8_t>(move.by);
        changed_.push_back(move.plane / coding_->planes);
        for (std::size_t c = 0; c < max_planes; ++c)
            debt[c] -= static_cast<double>(move.change[c]);
    }
    std::ranges::sort(changed_);
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    if (!changed_.empty())
        apply(tile);
    return changed_;
}

// What one more of a block's first level in a plane adds to the sums of the channels.
std::array<float, max_planes> LevelBalance::change_by_one(const BlockColour& colour,
                                                          std::size_t plane, float texels) const {
    const bool rotated = colour.is_rotated() && plane < 3;
    const double step = step_of(rotated, plane);
    Means planes{};
    if (rotated) {
        const RotationMatrix& axes = rotation_matrix(colour.rotation - 1);
        for (std::size_t i = 0; i < 3; ++i)
            planes[i] = step * axes[i][plane] / (1 << rotation_bits);
    } else {
        planes[plane] = step;
    }
    const Means channels = channels_of(planes, colour_->transform);
    std::array<float, max_planes> change{};
    for (std::size_t c = 0; c < max_planes; ++c)
        change[c] = static_cast<float>(channels[c]) * texels;
    return change;
}

// Finds all moves that bring the mean closer.
void LevelBalance::find_moves(const Means& debt, const TileTexels& texels, const TileLevels& tile) {
    moves_.clear();
    offers_.clear();
    const int planes = coding_->planes;
    for (std::size_t block = 0; block < tile.blocks.size(); ++block) {
        const BlockShape& shape = tile.blocks[block].shape;
        const auto matter =
            static_cast<float>(count_that_matter(tile.blocks[block], tile.shape, texels));
        const float per_level = matter / std::sqrt(static_cast<float>(shape.texels()));
        for (int plane = 0; plane < planes; ++plane) {
            const BlockColour colour = tile.colours[block];
            Move move{.plane = static_cast<std::uint32_t>(block * planes + plane),
                      .by = 0,
                      .change = change_by_one(colour, plane, per_level)};
            const double along = product(debt, move.change);
            if (along == 0)
                continue;
            move.by = along > 0 ? 1 : -1;
            for (float& change : move.change)
                change *= static_cast<float>(move.by);
            const PlaneLevels& levels = tile.planes[move.plane];
            const std::int32_t before = first_level(tile, levels), after = before + move.by;
            // The first plane of a rotated block must not become empty.
            if (after == 0 && !colour.is_plain() && plane == 0 && levels.count == 1)
                continue;
            const double gain = std::fabs(along) - square(move.change) / 2;
            if (gain <= 0 || std::abs(after) > max_level)
                continue;
            const float cost =
                cost_of(tile, block, plane, after) - cost_of(tile, block, plane, before);
            offers_.push_back(
                {static_cast<double>(cost) / gain, static_cast<std::uint32_t>(moves_.size())});
            moves_.push_back(move);
        }
    }
    std::make_heap(offers_.begin(), offers_.end(), is_dearer);
}

// The cost of a first level in squared steps, assuming that it does not change what follows.
float LevelBalance::cost_of(const TileLevels& tile, std::size_t block, int plane,
                            std::int32_t level) const {
    const BlockShape& shape = tile.blocks[block].shape;
    const PlaneLevels* const own = &tile.planes[block * coding_->planes];
    const bool rotated = tile.colours[block].is_rotated() && plane < 3;
    const int p_class = plane_class(plane);
    const std::int32_t magnitude = std::abs(level);
    const auto& offsets = coding_->parameters.offsets[p_class];
    float decoded = 0;
    if (level != 0)
        decoded = static_cast<float>(magnitude) -
                  static_cast<float>(offsets[magnitude > 1 ? 1 : 0]) / 64.0f;
    const float error = firsts_[block][plane] / static_cast<float>(step_of(rotated, plane)) -
                        (level < 0 ? -decoded : decoded);
    const auto& lengths = plane == 0 ? costs_->first_length[length_context(shape, false)]
                                     : costs_->other_length[length_token(own[0].coded_length)];
    const bool has_others = own[plane].coded_length > 1; // levels that are coded anyway
    if (level == 0 && !has_others)
        return error * error + lambda_ * lengths[0];
    int cross = 0;
    for (int before = 0; before < plane; ++before)
        cross = ContextGrid::add_cross(cross,
                                       amplitude_of_level(first_level(tile, own[before]), false));
    const int neighbours = size_class(shape);
    const int zero = zero_parameter(false, 0, p_class, 0, neighbours, cross_class(cross));
    float bits = costs_->zero[zero][level != 0 ? 1 : 0] + (has_others ? 0.0f : lengths[1]);
    if (level != 0)
        bits +=
            costs_
                ->magnitude[magnitude_table(false, 0, p_class, true, neighbours,
                                            cross_class(cross))][magnitude_token(magnitude).token];
    return error * error + lambda_ * bits;
}

void LevelBalance::apply(TileLevels& tile) {
    std::vector<NonZero> nonzeros;
    nonzeros.reserve(tile.nonzeros.size() + changed_.size() * max_planes);
    for (std::size_t at = 0; at < tile.planes.size(); ++at) {
        PlaneLevels& plane = tile.planes[at];
        const auto levels = tile.levels(plane);
        const std::int32_t before = first_level(tile, plane), first = before + by_[at];
        plane.first = static_cast<std::uint32_t>(nonzeros.size());
        if (first != 0)
            nonzeros.push_back({0, first});
        nonzeros.insert(nonzeros.end(), levels.begin() + (before != 0), levels.end());
        plane.count = static_cast<std::uint16_t>(nonzeros.size() - plane.first);
        if (plane.count == 0)
            plane.coded_length = 0;
        else if (plane.coded_length == 0)
            plane.coded_length = 1;
    }
    tile.nonzeros.swap(nonzeros);
}

} // namespace tessera
