#include "codec/tile_encoder/block_quantizer.h"

#include "codec/entropy/context_grid.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/search_kernels/search_kernels.h"
#include "codec/tile_encoder/plane_sums.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace tessera {
namespace {

// With dependent quantisation, a coefficient below this is not worth a longer coded length.
constexpr float smallest_last = 0.66f;

} // namespace

int length_limit(int planes, int scan_length) {
    const int share = (max_segment_work - max_planes) / planes;
    const int codable = share >= max_coded_length ? max_coded_length : 7 * (max_coded_length / 8);
    return std::min(codable, scan_length);
}
static_assert(7 * (max_coded_length / 8) * max_planes + max_planes <= max_segment_work);

BlockQuantizer::BlockQuantizer(const TileCoding& coding, const BitCosts& costs,
                               const QuantizerOptions& options)
    : coding_(coding), costs_(costs), options_(options) {
    for (int plane = 0; plane < coding.planes; ++plane)
        inverse_step_[plane] = static_cast<float>(1.0 / coding.parameters.step[plane].value());
    inverse_rotated_step_ = static_cast<float>(1.0 / coding.parameters.rotated_step.value());
    for (std::size_t c = 0; c < offset_.size(); ++c)
        for (std::size_t i = 0; i < 2; ++i)
            offset_[c][i] = static_cast<float>(coding.parameters.offsets[c][i]) / 64.0f;
}

float LumaFit::gain(const BlockColour& shares) const {
    float gain = 0;
    for (std::size_t c = 0; c < 2; ++c) {
        const float share = shares.share_of_luma(c);
        gain += share * (2 * product[c] - share * energy) * squared_inverse_step[c];
    }
    return gain;
}

BlockQuantizer::Cost BlockQuantizer::quantize(const BlockCoefficients& block, TileLevels& out) {
    const std::size_t luma = out.planes.size();
    const float cost = quantize_luma(block, out);
    return quantize_others(block, luma, cost, out);
}

float BlockQuantizer::quantize_luma(const BlockCoefficients& block, TileLevels& out) {
    return quantize_plane(block, 0, 0, out.planes.size(), out);
}

BlockQuantizer::Cost BlockQuantizer::quantize_chroma(const BlockCoefficients& block,
                                                     std::size_t luma, float luma_cost,
                                                     TileLevels& out) {
    const std::size_t first_plane = out.planes.size();
    PlaneLevels plane = out.planes[luma];
    const std::size_t from = plane.first;
    plane.first = static_cast<std::uint32_t>(out.nonzeros.size());
    for (std::size_t i = 0; i < plane.count; ++i)
        out.nonzeros.push_back(NonZero(out.nonzeros[from + i]));
    out.planes.push_back(plane);
    return quantize_others(block, first_plane, luma_cost, out);
}

BlockQuantizer::Cost BlockQuantizer::quantize_others(const BlockCoefficients& block,
                                                     std::size_t luma, float luma_cost,
                                                     TileLevels& out) {
    out.colours.push_back(block.colour);
    const int token = length_token(out.planes[luma].coded_length);
    Cost cost{.luma = luma_cost, .all = luma_cost};
    for (int plane = 1; plane < coding_.planes; ++plane)
        cost.all += quantize_plane(block, plane, token, luma, out);
    return cost;
}

// Copies a block without what its arrays hold beyond it, which may be a large block's.
void BlockQuantizer::take_block(const BlockCoefficients& from, BlockCoefficients& to) const {
    to.shape = from.shape;
    to.is_blank = from.is_blank;
    to.copies = from.copies;
    to.is_predicted = from.is_predicted;
    to.fineness = from.fineness;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        const auto first = from.plane[plane].begin();
        to.plane[plane].assign(first, first + from.shape.texels());
    }
}

void BlockQuantizer::decode_luma(const BlockCoefficients& block, const TileLevels& tile,
                                 std::size_t first_plane) {
    const std::vector<std::uint32_t>& places = shapes_.get(coding_, block.shape).places();
    const float per_level = (coding_.parameters.dependent ? 0.5f : 1.0f) / inverse_step(block, 0);
    luma_.clear();
    for (const NonZero& nz : tile.levels(tile.planes[first_plane])) {
        if (nz.index == 0 && !block.is_predicted)
            continue; // FORMAT.md 4.4
        const auto magnitude = static_cast<float>(std::abs(nz.level));
        const float value = (magnitude - offset_[0][std::abs(nz.level) > 1 ? 1 : 0]) * per_level;
        luma_.emplace_back(places[nz.index], nz.level < 0 ? -value : value);
    }
}

LumaFit BlockQuantizer::fit_chroma(const BlockCoefficients& block, const TileLevels& tile,
                                   std::size_t first_plane) {
    decode_luma(block, tile, first_plane);
    LumaFit fit;
    for (const auto& [place, luma] : luma_) {
        fit.energy += luma * luma;
        for (std::size_t c = 0; c < 2; ++c)
            fit.product[c] += luma * block.plane[c + 1][place];
    }
    for (std::size_t c = 0; c < 2 && fit.energy > 0; ++c) {
        const float step = inverse_step(block, static_cast<int>(c) + 1);
        fit.squared_inverse_step[c] = step * step;
        fit.colour.set_share(c, fit.product[c] / fit.energy);
    }
    return fit;
}

void BlockQuantizer::predict_chroma(const BlockCoefficients& block, const BlockColour& colour,
                                    const TileLevels& tile, std::size_t first_plane,
                                    BlockCoefficients& out) {
    decode_luma(block, tile, first_plane);
    take_block(block, out);
    out.colour = colour;
    for (std::size_t c = 0; c < 2; ++c) {
        const float share = colour.share_of_luma(c);
        if (share == 0)
            continue;
        out.is_blank[c + 1] = false;
        for (const auto& [place, luma] : luma_)
            out.plane[c + 1][place] -= share * luma;
    }
}

float BlockQuantizer::energy(const BlockCoefficients& block) const {
    const auto squares = sums_of_squares(block.plane, block.is_blank, coding_.planes,
                                         static_cast<std::size_t>(block.shape.texels()));
    float total = 0;
    for (int plane = 0; plane < coding_.planes; ++plane)
        total += squares[plane] * inverse_step(block, plane) * inverse_step(block, plane);
    return total;
}

float BlockQuantizer::quantize_plane(const BlockCoefficients& block, int plane, int first_token,
                                     std::size_t first_plane, TileLevels& out) {
    const ShapeCoding& shape = shapes_.get(coding_, block.shape);
    const ScanOrder& order = shape.order;
    const std::vector<float>& x = block.plane[plane];
    const float per_step = inverse_step(block, plane);
    const int p_class = plane_class(plane), t_class = coding_.table_class(plane);
    const auto& length_costs = t_class == 0
                                   ? costs_.first_length[length_context(block.shape, block.copies)]
                                   : costs_.other_length[first_token];
    const int limit = length_limit(coding_.planes, order.length());
    const bool dependent = coding_.parameters.dependent;
    const float smallest = !options_.optimise ? dead_zone
                           : dependent        ? smallest_last
                                              : smallest_candidate;
    const std::vector<std::uint32_t>& places = shape.places();
    const auto amplitude_at = [&](int i) { return x[places[i]] * per_step; };
    int last = -1;
    if (!block.is_blank[plane] &&
        search_kernels().largest_magnitude(x.data(), block.shape.texels()) * per_step >= smallest) {
        last = limit - 1;
        while (last >= 0 && !(std::fabs(amplitude_at(last)) >= smallest))
            --last;
    }
    PlaneLevels levels;
    levels.first = static_cast<std::uint32_t>(out.nonzeros.size());
    float cost = options_.lambda * length_costs[0]; // of zeros
    levels_.clear();
    if (last >= 0) {
        const int end = round_up_coded_length(last + 1, order.length());
        find_crosses(out, first_plane, end);
        amplitude_.resize(end);
        for (int i = 0; i < end; ++i)
            amplitude_[i] = amplitude_at(i);
        cost = choose_levels({.shape = shape,
                              .costs = costs_,
                              .options = options_,
                              .copies = block.copies,
                              .plane_class = t_class,
                              .length_costs = length_costs,
                              .offsets = offset_[p_class],
                              .amplitude = amplitude_,
                              .crosses = cross_},
                             dependent, paths_, levels_);
    }
    out.nonzeros.insert(out.nonzeros.end(), levels_.rbegin(), levels_.rend());
    levels.count = static_cast<std::uint16_t>(levels_.size());
    if (!levels_.empty())
        levels.coded_length = static_cast<std::uint16_t>(
            round_up_coded_length(levels_.front().index + 1, order.length()));
    out.planes.push_back(levels);
    return cost;
}

// Sums the amplitudes of the block's earlier planes, as codes for contexts.
void BlockQuantizer::find_crosses(const TileLevels& out, std::size_t first_plane, int end) {
    cross_.assign(end, 0);
    for (std::size_t plane = first_plane; plane < out.planes.size(); ++plane)
        for (const NonZero& nz : out.levels(out.planes[plane]))
            if (nz.index < end)
                cross_[nz.index] = static_cast<std::uint8_t>(ContextGrid::add_cross(
                    cross_[nz.index], amplitude_of_level(nz.level, coding_.parameters.dependent)));
}

} // namespace tessera
