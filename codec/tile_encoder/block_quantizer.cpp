#include "codec/tile_encoder/block_quantizer.h"

#include "codec/entropy/context_grid.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/search_kernels/search_kernels.h"

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

float BlockQuantizer::quantize(const BlockCoefficients& block, TileLevels& out) {
    const std::size_t first_plane = out.planes.size();
    out.colours.push_back(static_cast<std::uint8_t>(block.colour));
    float cost = 0;
    int first_token = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        cost += quantize_plane(block, plane, first_token, first_plane, out);
        if (plane == 0)
            first_token = length_token(out.planes[first_plane].coded_length);
    }
    return cost;
}

float BlockQuantizer::energy(const BlockCoefficients& block) const {
    float total = 0;
    for (int plane = 0; plane < coding_.planes; ++plane) {
        if (block.is_blank[plane])
            continue;
        float sum = 0;
        for (const float x : std::span(block.plane[plane]).first(block.shape.texels()))
            sum += x * x;
        total += sum * inverse_step(block, plane) * inverse_step(block, plane);
    }
    return total;
}

float BlockQuantizer::quantize_plane(const BlockCoefficients& block, int plane, int first_token,
                                     std::size_t first_plane, TileLevels& out) {
    const ShapeCoding& shape = shapes_.get(coding_, block.shape);
    const ScanOrder& order = shape.order;
    const std::vector<float>& x = block.plane[plane];
    const float per_step = inverse_step(block, plane);
    const int p_class = plane_class(plane);
    const auto& length_costs = plane == 0
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
                              .plane_class = p_class,
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
