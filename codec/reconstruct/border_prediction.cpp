#include "codec/reconstruct/border_prediction.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

constexpr int most_side = max_block_side;

// The texels along one side of a block, from its upper left corner on.
class Side {
public:
    void begin(int length) { length_ = length; }
    void push(std::int32_t value) { texel_[static_cast<std::size_t>(count_++)] = value; }
    // Repeats the last texel to the end.
    void extend() {
        std::fill(texel_.begin() + count_, texel_.begin() + length_,
                  texel_[static_cast<std::size_t>(count_ - 1)]);
    }
    void fill(std::int32_t value) { std::fill_n(texel_.begin(), length_, value); }
    std::int32_t operator[](int i) const { return texel_[static_cast<std::size_t>(i)]; }

private:
    int count_ = 0, length_ = 0;
    std::array<std::int32_t, 2 * most_side> texel_;
};

class BorderPrediction {
public:
    BorderPrediction(const Block& block, const BlockShape& picture,
                     std::span<const std::int32_t> plane, const DecodedRegion& done)
        : nu_(block.shape.n[0]), nv_(block.shape.n[1]), length_(nu_ + nv_) {
        const int u = block.origin[0], v = block.origin[1];
        const auto at = [&](int x, int y) {
            return plane[static_cast<std::size_t>(y * picture.n[0] + x)];
        };
        has_top_ = v > 0;
        has_left_ = u > 0;
        top_.begin(length_);
        left_.begin(length_);
        for (int i = 0; has_top_ && i < length_ && u + i < picture.n[0] && done.height(u + i) >= v;
             ++i)
            top_.push(at(u + i, v - 1));
        for (int i = 0; has_left_ && i < length_ && v + i < picture.n[1] && done.width(v + i) >= u;
             ++i)
            left_.push(at(u - 1, v + i));
        complete(has_top_ && has_left_ ? at(u - 1, v - 1) : 0);
    }

    void run(BorderMode mode, std::int32_t* out) const {
        if (mode == mode_mean)
            std::fill_n(out, nu_ * nv_, mean());
        else if (mode == mode_planar)
            planar(out);
        else if (mode < mode_first_direction + first_upper_direction)
            directional(mode, left_, top_, nv_, nu_, nu_, 1, out);
        else
            directional(mode, top_, left_, nu_, nv_, 1, nu_, out);
    }

private:
    // Where a side or the corner lies outside the picture, the other side takes its place.
    void complete(std::int32_t corner) {
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

    std::int32_t mean() const {
        std::int32_t sum = 0, count = 0;
        if (has_top_)
            for (int i = 0; i < nu_; ++i, ++count)
                sum += top_[i];
        if (has_left_)
            for (int i = 0; i < nv_; ++i, ++count)
                sum += left_[i];
        return count == 0 ? 0 : floor_of(sum, count);
    }
    static std::int32_t floor_of(std::int32_t a, std::int32_t b) {
        return a >= 0 ? a / b : -((b - 1 - a) / b);
    }

    // The mean of two ramps: from the left side to the texel right of the upper one, and from the
    // upper side to the texel below the left one.
    void planar(std::int32_t* out) const {
        const std::int32_t right = top_[nu_], below = left_[nv_];
        std::array<std::int32_t, most_side> weight_u;
        for (int x = 0; x < nu_; ++x)
            weight_u[static_cast<std::size_t>(x)] = 64 * (x + 1) / nu_;
        for (int y = 0; y < nv_; ++y) {
            const std::int32_t weight_v = 64 * (y + 1) / nv_, left = left_[y];
            for (int x = 0; x < nu_; ++x) {
                const std::int32_t across = weight_u[static_cast<std::size_t>(x)];
                *out++ = ((64 - across) * left + across * right + (64 - weight_v) * top_[x] +
                          weight_v * below + 64) >>
                         7;
            }
        }
    }

    // Continues the texels of side `along`, n of which touch the block, for `depth` texels away from
    // it. Where a direction leaves that side beyond the corner, it goes on along the other side.
    void directional(BorderMode mode, const Side& along, const Side& other, int n, int depth,
                     int step_along, int step_away, std::int32_t* out) const {
        const int slope = direction_slope(mode - mode_first_direction);
        // The border as one line: reference[i] for i > 0 is texel i - 1 of the side.
        std::array<std::int32_t, 4 * most_side + 2> line;
        std::int32_t* const reference = line.data() + most_side + 1;
        reference[0] = corner_;
        for (int i = 0; i < length_; ++i)
            reference[i + 1] = along[i];
        reference[length_ + 1] = along[length_ - 1];
        if (slope < 0) {
            const int inverse = direction_inverse(mode - mode_first_direction);
            for (int i = 1; i <= (-slope * depth + 31) >> 5; ++i)
                reference[-i] = other[std::min(((i * inverse + 128) >> 8) - 1, length_ - 1)];
        }
        for (int y = 0; y < depth; ++y) {
            const int at = (y + 1) * slope, part = at & 31;
            const std::int32_t* from = reference + (at >> 5) + 1;
            std::int32_t* to = out + y * step_away;
            for (int x = 0; x < n; ++x)
                to[x * step_along] = ((32 - part) * from[x] + part * from[x + 1] + 16) >> 5;
        }
    }

    const int nu_, nv_, length_;
    bool has_top_, has_left_;
    std::int32_t corner_ = 0;
    Side top_, left_;
};

} // namespace

void predict_from_border(const Block& block, BorderMode mode, const BlockShape& picture,
                         std::span<const std::int32_t> plane, const DecodedRegion& done,
                         std::int32_t* out) {
    BorderPrediction(block, picture, plane, done).run(mode, out);
}

} // namespace tessera
