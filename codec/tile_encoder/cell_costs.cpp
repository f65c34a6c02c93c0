#include "codec/tile_encoder/cell_costs.h"

#include "codec/tile_encoder/colour_choice.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace tessera {
namespace {

// The bits of a coefficient that is not zeroed, fitted to what coded files spend: its significance,
// with the zero flags around it, by position class, and its magnitude by octaves of its energy.
constexpr float bits_at_dc = 5.0f;
constexpr float bits_at_first_class = 4.0f;
constexpr float bits_per_class = 0.30f;
constexpr float bits_per_octave_of_energy = 0.85f;
// In dense blocks, zero flags cost the entropy of how many coefficients are coded, whatever their
// positions, because contexts see the neighbours. Each coded one adds a sign and sometimes more.
constexpr float bits_per_dense = 1.2f;
constexpr float rounding_error = 1.0f / 12.0f;
// Added to blocks with many coefficients. Noise can be cut in many ways, most of them into small
// blocks, and the search would pick the luckiest estimate. 3 bits for all blocks lose 1 to 3 % at
// low rates.
constexpr float most_lucky_bits = 3.0f;
constexpr float coefficients_for_luck = 16.0f;
// Blocks of single views cost this many times what the model says. It does not know that the views
// from which they copy get worse once these copy, too, nor that short trellises gain less.
constexpr float views_cost_more = 1.1f;
constexpr float rotation_symbol_bits = 3.0f; // a repeated colour costs less
constexpr float rotation_may_pay = 0.98f;    // a block that costs more of its energy is noise

// log2 of x >= 1 to within 0.0004. The same on every CPU, as std::log2 need not be, and quicker.
float quick_log2(float x) {
    const auto bits = std::bit_cast<std::int32_t>(x);
    const float t = std::bit_cast<float>((bits & 0x7FFFFF) | 0x3F800000) - 1;
    return static_cast<float>((bits >> 23) - 127) +
           t * (1.44148f + t * (-0.69629f + t * (0.35488f - 0.10007f * t)));
}

// The number of coefficients that forward_image computes.
int kept_count(const BlockShape& shape) {
    return forward_kept(shape.n[0]) * forward_kept(shape.n[1]) * shape.n[2] * shape.n[3];
}

} // namespace

void CellCosts::set_fineness(int k) {
    fineness_ = k;
    const auto inverse = [k](StepCode step) {
        return times_finer(k) * static_cast<float>(1.0 / step.value());
    };
    for (int plane = 0; plane < coding_->planes; ++plane)
        inverse_step_[plane] = inverse(coding_->parameters.step[plane]);
    inverse_rotated_step_ = inverse(coding_->parameters.rotated_step);
}

float CellCosts::mean_cost(float energy) const {
    const float octaves = energy > 1.0f ? quick_log2(energy) : 0.0f;
    return std::min(energy,
                    rounding_error +
                        options_.lambda * (bits_at_dc + bits_per_octave_of_energy * octaves));
}

// Cost of coefficients whose positions cost `base`. The cheaper of two models: bits by position,
// and bits by density. Without the latter, white noise would be cut into the smallest blocks, whose
// frequencies are all low.
float CellCosts::cost_of(const float* x, const float* base, int count, float inverse_step,
                         CostSum* sum) const {
    const CostSum own = search_kernels().coding_cost(x, base, count, inverse_step,
                                                     options_.lambda * bits_per_octave_of_energy);
    if (sum != nullptr)
        *sum = own;
    if (own.coded < 1)
        return own.cost;
    const float n = static_cast<float>(count), k = std::min(own.coded, n - 0.5f);
    const float flags = k * quick_log2(n / k) + (n - k) * quick_log2(n / (n - k));
    const float magnitudes = own.cost - own.zeroed - own.bases;
    return std::min(own.cost, own.zeroed + magnitudes + rounding_error * k +
                                  options_.lambda * (flags + bits_per_dense * k));
}

float CellCosts::plane_cost(const Coefficients& block, const BlockShape& shape, int plane) {
    return cost_of(block[plane].data(), kept_costs(shape).data(), kept_count(shape),
                   inverse_step_[plane]);
}

float CellCosts::block_cost(const Coefficients& block, const BlockShape& shape, float energy) {
    const bool costs_more = is_picture(shape) && copies_views(options_, coding_->parameters);
    return (costs_more ? views_cost_more : 1.0f) * modelled_cost(block, shape, energy);
}

float CellCosts::modelled_cost(const Coefficients& block, const BlockShape& shape, float energy) {
    const int count = kept_count(shape);
    const float* base = kept_costs(shape).data();
    float cost = 0, seen = 0, others = 0, coded = 0;
    for (int p = 0; p < coding_->planes; ++p) {
        CostSum sum;
        const float own = cost_of(block[p].data(), base, count, inverse_step_[p], &sum);
        cost += own;
        seen += sum.energy;
        coded += sum.coded;
        others += p < 3 ? 0.0f : own;
    }
    const float luck =
        options_.lambda * most_lucky_bits * std::min(1.0f, coded / coefficients_for_luck);
    // Frequencies that were left out are zeroed, which costs their energy.
    const bool is_complete = count == shape.texels();
    const float unseen = is_complete ? 0.0f : std::max(0.0f, energy - seen);
    if (!options_.rotated_colours || !coding_->rotates || cost > rotation_may_pay * (seen + unseen))
        return cost + unseen + luck;
    const ColourCoefficients colours{{block[0].data(), block[1].data(), block[2].data()},
                                     static_cast<std::size_t>(count)};
    const int rotation = choose_rotation(kept_moments(colours, coding_->parameters), -1);
    if (rotation < 0)
        return cost + unseen + luck;
    rotated_.resize(std::max(rotated_.size(), static_cast<std::size_t>(count)));
    float rotated = others + options_.lambda * rotation_symbol_bits;
    for (std::size_t axis = 0; axis < 3 && rotated < cost; ++axis) {
        project_colours(colours, rotation, axis, rotated_.data());
        rotated += cost_of(rotated_.data(), base, count, inverse_rotated_step_);
    }
    return std::min(cost, rotated) + unseen + luck;
}

float CellCosts::estimate(const BlockCoefficients& block, int first, int end, float cost) {
    const float* base = dense_costs(block.shape).data();
    for (int p = first; p < end; ++p)
        if (!block.is_blank[p])
            cost += cost_of(block.plane[p].data(), base, block.shape.texels(),
                            block.colour.is_rotated() && p < 3 ? inverse_rotated_step_
                                                               : inverse_step_[p]);
    return cost;
}

const std::vector<float>& CellCosts::dense_costs(const BlockShape& shape) {
    if (recent_ != nullptr && recent_shape_ == shape)
        return *recent_;
    auto [found, is_new] = dense_.try_emplace(shape);
    std::vector<float>& dense = found->second;
    recent_shape_ = shape;
    recent_ = &dense;
    if (!is_new)
        return dense;
    const ScanOrder& order = coding_->shape(shape).order;
    const auto& n = shape.n;
    // Infinite where the scan does not reach.
    dense.assign(shape.texels(), std::numeric_limits<float>::infinity());
    const auto codable = static_cast<std::size_t>(length_limit(coding_->planes, order.length()));
    for (std::size_t i = 0; i < codable; ++i) {
        const auto& k = order.entry[i].k;
        const int position = order.position_class[i];
        const float bits =
            position == 0 ? bits_at_dc
                          : bits_at_first_class + bits_per_class * static_cast<float>(position - 1);
        dense[((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0]] =
            rounding_error + options_.lambda * bits;
    }
    return dense;
}

const std::vector<float>& CellCosts::kept_costs(const BlockShape& shape) {
    auto [found, is_new] = kept_.try_emplace(shape);
    if (is_new) {
        const std::vector<float>& dense = dense_costs(shape);
        const auto& n = shape.n;
        for (int image = 0; image < n[2] * n[3]; ++image)
            for (int v = 0; v < forward_kept(n[1]); ++v)
                for (int i = 0; i < forward_kept(n[0]); ++i)
                    found->second.push_back(
                        dense[(image * n[1] + v) * n[0] + forward_order(n[0], i)]);
    }
    return found->second;
}

} // namespace tessera
