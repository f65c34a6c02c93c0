#include "codec/tile_encoder/level_balance.h"

#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "format/tile/colour_rotation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tessera {
namespace {

constexpr double paid_mean = 0.003; // codes that may be left of a channel's error
// A move that would go further than what is left of the debt may be larger than that by this.
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

// How many of a block's texels matter.
int mattering(const Block& block, const BlockShape& tile, const TileTexels& texels) {
    if (texels.matters.empty())
        return block.shape.texels();
    const auto& n = block.shape.n;
    const auto& o = block.origin;
    int count = 0;
    for (int v = o[1]; v < o[1] + n[1]; ++v) // dense box order
        for (int u = o[0]; u < o[0] + n[0]; ++u)
            for (int t = o[3]; t < o[3] + n[3]; ++t)
                for (int s = o[2]; s < o[2] + n[2]; ++s)
                    count += !texels.is_free(static_cast<std::size_t>(
                        ((v * tile.n[0] + u) * tile.n[3] + t) * tile.n[2] + s));
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

// One order whatever the heap looks like.
bool LevelBalance::is_dearer(const Offer& a, const Offer& b) {
    return a.price != b.price ? a.price > b.price : a.move > b.move;
}

void LevelBalance::add(const BlockCoefficients& block) {
    auto& first = firsts_.emplace_back();
    for (int plane = 0; plane < coding_->planes; ++plane)
        first[static_cast<std::size_t>(plane)] = block.plane[static_cast<std::size_t>(plane)][0];
}

const std::vector<std::size_t>& LevelBalance::pay(const Means& error, const TileTexels& texels,
                                                  TileLevels& tile) {
    const double count = static_cast<double>(static_cast<std::size_t>(tile.shape.texels()) -
                                             free_count(texels.matters));
    Means debt{};
    for (std::size_t c = 0; c < max_planes; ++c)
        debt[c] = -error[c] * count;
    find_moves(debt, texels, tile);
    by_.assign(tile.planes.size(), 0);
    changed_.clear();
    while (!offers_.empty() && largest_of(debt) > paid_mean * count) {
        std::pop_heap(offers_.begin(), offers_.end(), is_dearer); // few of many are wanted
        const Move& move = moves_[offers_.back().move];
        offers_.pop_back();
        if (most_overpaid * product(debt, move.change) < square(move.change))
            continue;
        by_[move.plane] = static_cast<std::int8_t>(move.by);
        changed_.push_back(move.plane / static_cast<std::size_t>(coding_->planes));
        for (std::size_t c = 0; c < max_planes; ++c)
            debt[c] -= static_cast<double>(move.change[c]);
    }
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    if (!changed_.empty())
        apply(tile);
    return changed_;
}

// All that would pay.
void LevelBalance::find_moves(const Means& debt, const TileTexels& texels, const TileLevels& tile) {
    moves_.clear();
    offers_.clear();
    const auto planes = static_cast<std::size_t>(coding_->planes);
    for (std::size_t block = 0; block < tile.blocks.size(); ++block) {
        const BlockShape& shape = tile.blocks[block].shape;
        const float matter = static_cast<float>(mattering(tile.blocks[block], tile.shape, texels));
        const float per_level = matter / std::sqrt(static_cast<float>(shape.texels()));
        for (std::size_t p = 0; p < planes; ++p) {
            const std::size_t at = block * planes + p;
            const int plane = static_cast<int>(p);
            const bool rotated = tile.colours[block] != 0 && p < 3;
            const double step = step_of(rotated, p);
            Means of_planes{};
            if (rotated) {
                const RotationMatrix& axes = rotation_matrix(tile.colours[block] - 1);
                for (std::size_t i = 0; i < 3; ++i)
                    of_planes[i] = step * axes[i][p] / (1 << rotation_bits);
            } else {
                of_planes[p] = step;
            }
            const Means channels = channels_of(of_planes, colour_->transform);
            Move move;
            move.plane = static_cast<std::uint32_t>(at);
            for (std::size_t c = 0; c < max_planes; ++c)
                move.change[c] = static_cast<float>(channels[c]) * per_level;
            const double along = product(debt, move.change);
            if (along == 0)
                continue;
            move.by = along > 0 ? 1 : -1;
            for (float& change : move.change)
                change *= static_cast<float>(move.by);
            const PlaneLevels& levels = tile.planes[at];
            const std::int32_t level = first_level(tile, levels);
            // A rotated block has a coded first plane.
            if (level + move.by == 0 && rotated && p == 0 && levels.count == 1)
                continue;
            const double gain = std::fabs(along) - square(move.change) / 2;
            if (gain <= 0 || std::abs(level + move.by) > max_level)
                continue;
            const double price = static_cast<double>(cost_of(tile, block, plane, level + move.by) -
                                                     cost_of(tile, block, plane, level)) /
                                 gain;
            offers_.push_back({price, static_cast<std::uint32_t>(moves_.size())});
            moves_.push_back(move);
        }
    }
    std::make_heap(offers_.begin(), offers_.end(), is_dearer);
}

// Of a first level, in squared steps. What comes after it is taken to cost the same.
float LevelBalance::cost_of(const TileLevels& tile, std::size_t block, int plane,
                            std::int32_t level) const {
    const auto planes = static_cast<std::size_t>(coding_->planes);
    const auto p = static_cast<std::size_t>(plane);
    const BlockShape& shape = tile.blocks[block].shape;
    const PlaneLevels* const own = &tile.planes[block * planes];
    const bool rotated = tile.colours[block] != 0 && plane < 3;
    const auto p_class = plane_class(plane);
    const std::int32_t magnitude = std::abs(level);
    const auto& offsets = coding_->parameters.offsets[static_cast<std::size_t>(p_class)];
    float decoded = 0;
    if (level != 0)
        decoded = static_cast<float>(magnitude) -
                  static_cast<float>(offsets[magnitude > 1 ? 1 : 0]) / 64.0f;
    const float error = firsts_[block][p] / static_cast<float>(step_of(rotated, p)) -
                        (level < 0 ? -decoded : decoded);
    const auto& lengths =
        plane == 0
            ? costs_->first_length[static_cast<std::size_t>(length_context(shape, false))]
            : costs_->other_length[static_cast<std::size_t>(length_token(own[0].coded_length))];
    const bool others = own[p].coded_length > 1; // levels that are coded anyway
    if (level == 0 && !others)
        return error * error + lambda_ * lengths[0];
    int cross = 0;
    for (std::size_t before = 0; before < p; ++before)
        cross = ContextGrid::add_cross(cross,
                                       amplitude_of_level(first_level(tile, own[before]), false));
    const int neighbours = size_class(shape);
    const auto zero = static_cast<std::size_t>(
        zero_parameter(false, 0, p_class, 0, neighbours, cross_class(cross)));
    float bits = costs_->zero[zero][level != 0 ? 1 : 0] + (others ? 0.0f : lengths[1]);
    if (level != 0)
        bits += costs_->magnitude[static_cast<std::size_t>(
            magnitude_table(false, 0, p_class, true, neighbours, cross_class(cross)))]
                                 [static_cast<std::size_t>(magnitude_token(magnitude).token)];
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
