#include "codec/reconstruct/border_prediction.h"

#include "codec/kernels/kernels.h"

#include <algorithm>

namespace tessera {
namespace {

std::int32_t floor_of(std::int32_t a, std::int32_t b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}

} // namespace

void BlockBorder::Side::read(const std::int32_t* from, int step, int count) {
    count_ = count;
    if (step == 1)
        std::copy_n(from, count, texel_.begin());
    else
        for (int i = 0; i < count; ++i)
            texel_[static_cast<std::size_t>(i)] = from[i * step];
}

void BlockBorder::Side::extend() {
    std::fill(texel_.begin() + count_, texel_.begin() + length_,
              texel_[static_cast<std::size_t>(count_ - 1)]);
}

void BlockBorder::Side::fill(std::int32_t value) {
    std::fill_n(texel_.begin(), length_, value);
}

BorderReach border_reach(const Block& block, const BlockShape& picture, const DecodedRegion& done) {
    const int u = block.origin[0], v = block.origin[1];
    const int length = block.shape.n[0] + block.shape.n[1];
    BorderReach reach;
    if (v > 0)
        while (reach.top < std::min(length, picture.n[0] - u) && done.height(u + reach.top) >= v)
            ++reach.top;
    if (u > 0)
        while (reach.left < std::min(length, picture.n[1] - v) && done.width(v + reach.left) >= u)
            ++reach.left;
    return reach;
}

BlockBorder::BlockBorder(const Block& block, const BlockShape& picture, BorderReach reach,
                         std::span<const std::int32_t> plane)
    : nu_(block.shape.n[0]), nv_(block.shape.n[1]), length_(nu_ + nv_) {
    const int u = block.origin[0], v = block.origin[1];
    const auto at = [&](int x, int y) {
        return plane[static_cast<std::size_t>(y * picture.n[0] + x)];
    };
    has_top_ = v > 0;
    has_left_ = u > 0;
    top_.begin(length_);
    left_.begin(length_);
    if (has_top_)
        top_.read(&plane[static_cast<std::size_t>((v - 1) * picture.n[0] + u)], 1, reach.top);
    if (has_left_)
        left_.read(&plane[static_cast<std::size_t>(v * picture.n[0] + u - 1)], picture.n[0],
                   reach.left);
    complete(has_top_ && has_left_ ? at(u - 1, v - 1) : 0);
}

void BlockBorder::predict(BorderMode mode, std::int32_t* out) const {
    if (mode == mode_mean)
        std::fill_n(out, nu_ * nv_, mean());
    else if (mode == mode_planar)
        kernels().continue_both(top_.data(), left_.data(), nu_, nv_, out);
    else if (mode < mode_first_direction + first_upper_direction)
        directional(mode, left_, top_, nv_, nu_, true, out);
    else
        directional(mode, top_, left_, nu_, nv_, false, out);
}

// Where a side or the corner lies outside the picture, the other side takes its place.
void BlockBorder::complete(std::int32_t corner) {
    if (!has_top_ && !has_left_) {
        top_.fill(0);
        left_.fill(0);
        corner_ = 0;
        return;
    }
    if (has_top_)
        top_.extend();
    else
        top_.fill(left_[0]);
    if (has_left_)
        left_.extend();
    else
        left_.fill(top_[0]);
    corner_ = !has_top_ ? left_[0] : !has_left_ ? top_[0] : corner;
}

std::int32_t BlockBorder::mean() const {
    std::int32_t sum = 0, count = 0;
    if (has_top_)
        for (int i = 0; i < nu_; ++i, ++count)
            sum += top_[i];
    if (has_left_)
        for (int i = 0; i < nv_; ++i, ++count)
            sum += left_[i];
    return count == 0 ? 0 : floor_of(sum, count);
}

// Continues the texels of side `along`, n of which touch the block, for `depth` texels away from it.
// Where a direction leaves that side beyond the corner, it goes on along the other side.
void BlockBorder::directional(BorderMode mode, const Side& along, const Side& other, int n,
                              int depth, bool sideways, std::int32_t* out) const {
    const int slope = direction_slope(mode - mode_first_direction);
    // The border as one line: line[i] for i > 0 is texel i - 1 of the side.
    std::array<std::int32_t, 4 * max_block_side + 2 + read_behind_border> memory;
    std::int32_t* const line = memory.data() + max_block_side + 1;
    line[0] = corner_;
    std::copy_n(along.data(), length_, line + 1);
    std::fill_n(line + length_ + 1, 1 + read_behind_border, along[length_ - 1]);
    if (slope < 0) {
        const int inverse = direction_inverse(mode - mode_first_direction);
        for (int i = 1; i <= (-slope * depth + 31) >> 5; ++i)
            line[-i] = other[std::min(((i * inverse + 128) >> 8) - 1, length_ - 1)];
    }
    const BorderLine from{.line = line, .slope = slope, .n = n, .depth = depth};
    (sideways ? kernels().continue_left : kernels().continue_top)(from, out);
}

} // namespace tessera
