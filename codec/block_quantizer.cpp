#include "codec/block_quantizer.h"

#include "codec/tile_entropy.h"
#include "codec/tile_syntax.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// A coefficient below this can only become 0, in steps.
constexpr float smallest_candidate = 0.55f;

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
        inverse_step_[static_cast<std::size_t>(plane)] = static_cast<float>(
            1.0 / coding.parameters.step[static_cast<std::size_t>(plane)].value());
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

float BlockQuantizer::quantize_plane(const BlockCoefficients& block, int plane, int first_token,
                                     std::size_t first_plane, TileLevels& out) {
    const ShapeCoding& shape = coding_.shape(block.shape);
    const ScanOrder& order = shape.order;
    const std::vector<float>& x = block.plane[static_cast<std::size_t>(plane)];
    const float inverse_step = block.colour != 0 && plane < 3
                                   ? inverse_rotated_step_
                                   : inverse_step_[static_cast<std::size_t>(plane)];
    const auto& n = block.shape.n;
    const int p_class = plane_class(plane);
    const auto& offsets = offset_[static_cast<std::size_t>(p_class)];
    const auto& length_costs =
        plane == 0 ? costs_.first_length[static_cast<std::size_t>(length_context(block.shape, block.copies))]
                   : costs_.other_length[static_cast<std::size_t>(first_token)];
    const int limit = length_limit(coding_.planes, order.length());

    amplitude_.resize(static_cast<std::size_t>(limit));
    int last = -1;
    for (int i = 0; i < limit; ++i) {
        const auto& k = order.entry[static_cast<std::size_t>(i)].k;
        const float a =
            x[static_cast<std::size_t>(((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] *
            inverse_step;
        amplitude_[static_cast<std::size_t>(i)] = a;
        if (std::fabs(a) >= smallest_candidate)
            last = i;
    }
    PlaneLevels levels;
    levels.first = static_cast<std::uint32_t>(out.nonzeros.size());
    out.planes.push_back(levels);
    const float lambda = options_.lambda;
    float best_cost = lambda * length_costs[0]; // relative to "all of it is zero"
    if (last < 0)
        return best_cost;

    grid_.begin(order.support[static_cast<std::size_t>(
        round_up_coded_length(last + 1, order.length()) - 1)]);
    for (std::size_t earlier = first_plane; earlier + 1 < out.planes.size(); ++earlier)
        for (const NonZero& nz : out.levels(out.planes[earlier]))
            if (nz.index <= last)
                grid_.mark_cross(grid_.place(order.entry[nz.index]), std::abs(nz.level));

    levels_.clear();
    std::size_t best_count = 0;
    float cost = 0; // of the coefficients so far, against their energy
    for (int i = 0; i <= last; ++i) {
        const ScanEntry& entry = order.entry[static_cast<std::size_t>(i)];
        const int place = grid_.place(entry);
        const int neighbours = grid_.neighbours(place);
        const auto& flag = costs_.zero[static_cast<std::size_t>(
            zero_parameter(p_class, order.position_class[static_cast<std::size_t>(i)], neighbours,
                           grid_.cross(place)))];
        const float signed_a = amplitude_[static_cast<std::size_t>(i)];
        const float a = std::fabs(signed_a);
        float choice_cost = lambda * flag[0];
        std::int32_t choice = 0;
        if (a >= smallest_candidate) {
            const auto& tokens =
                costs_.magnitude[static_cast<std::size_t>(p_class)]
                                [static_cast<std::size_t>(i == 0 ? neighbour_classes : neighbours)];
            const auto nearest =
                static_cast<std::int32_t>(std::min(a + 0.5f, static_cast<float>(max_level)));
            for (std::int32_t m = nearest; m > 0 && m + 2 > nearest; --m) {
                const float error = a - (static_cast<float>(m) - offsets[m > 1 ? 1 : 0]);
                const float candidate =
                    error * error - a * a +
                    lambda * (flag[1] + tokens[static_cast<std::size_t>(magnitude_token(m).token)]);
                if (candidate < choice_cost) {
                    choice_cost = candidate;
                    choice = m;
                }
            }
        }
        cost += choice_cost;
        if (choice == 0)
            continue;
        levels_.push_back({static_cast<std::uint16_t>(i), signed_a < 0 ? -choice : choice});
        grid_.mark(place, choice);
        const int length = round_up_coded_length(i + 1, order.length());
        const float stop =
            cost + lambda * length_costs[static_cast<std::size_t>(length_token(length))];
        if (stop < best_cost) {
            best_cost = stop;
            best_count = levels_.size();
        }
    }
    out.nonzeros.insert(out.nonzeros.end(), levels_.begin(),
                        levels_.begin() + static_cast<std::ptrdiff_t>(best_count));
    PlaneLevels& written = out.planes.back();
    written.count = static_cast<std::uint16_t>(best_count);
    if (best_count > 0)
        written.coded_length = static_cast<std::uint16_t>(
            round_up_coded_length(levels_[best_count - 1].index + 1, order.length()));
    return best_cost;
}

} // namespace tessera
