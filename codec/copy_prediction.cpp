#include "codec/copy_prediction.h"

#include "codec/kernels.h"

#include <algorithm>
#include <array>
#include <optional>

namespace tessera {
namespace {

// One view of a plane that is copied from, moved by whole and half texels.
class MovedView {
public:
    MovedView(const std::int32_t* view, const BlockShape& tile, int half_u, int half_v)
        : view_(view), width_(tile.n[0]), height_(tile.n[1]), u_(half_u >> 1), v_(half_v >> 1),
          between_u_((half_u & 1) != 0), between_v_((half_v & 1) != 0) {}

    // Adds four times the values at (u .. u + n - 1, v) to `sums`.
    void add_row(int u, int v, int n, std::int32_t* sums) {
        const std::int32_t* upper = row(u + u_, v + v_, n + 1, buffer_[0].data());
        const std::int32_t* lower =
            between_v_ ? row(u + u_, v + v_ + 1, n + 1, buffer_[1].data()) : upper;
        kernels().add_half_texels(upper, lower, between_u_, n, sums);
    }

private:
    // n texels from (u, v) on; texels outside the tile are those at its edge.
    const std::int32_t* row(int u, int v, int n, std::int32_t* buffer) const {
        const std::int32_t* line = view_ + std::clamp(v, 0, height_ - 1) * width_;
        if (u >= 0 && u + n <= width_)
            return line + u;
        for (int i = 0; i < n; ++i)
            buffer[i] = line[std::clamp(u + i, 0, width_ - 1)];
        return buffer;
    }

    const std::int32_t* const view_;
    const int width_, height_, u_, v_;
    const bool between_u_, between_v_;
    std::array<std::array<std::int32_t, max_tile_side + 1>, 2> buffer_;
};

// The value of a predicted tile's planes stays within what 16 (20) bits hold, copies of copies too.
std::int32_t limit_of(SampleType type) {
    return type == SampleType::unorm8 ? 1 << 15 : 1 << 18;
}

// Calls visit(sums, s, t, v) for every row of a block; sums >> shift_of(prediction) are its predicted
// values.
template <class Visit>
void for_each_row(const Block& block, const BlockPrediction& prediction, const BlockShape& tile,
                  const std::vector<std::int32_t>& plane, Visit visit) {
    const auto& n = block.shape.n;
    const int page = tile.n[0] * tile.n[1];
    const std::int32_t rounding = prediction.from == CopyFrom::both ? 4 : 2;
    std::array<std::int32_t, max_tile_side> sums;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s) {
            const int at_s = block.origin[2] + s, at_t = block.origin[3] + t;
            const auto view = [&](int from_s, int from_t, int steps, const Displacement& d) {
                return MovedView(plane.data() + (from_t * tile.n[2] + from_s) * page, tile,
                                 steps * d.u, steps * d.v);
            };
            std::optional<MovedView> along_s, along_t;
            if (prediction.copies_along(0))
                along_s.emplace(view(block.origin[2] - 1, at_t, s + 1, prediction.displacement[0]));
            if (prediction.copies_along(1))
                along_t.emplace(view(at_s, block.origin[3] - 1, t + 1, prediction.displacement[1]));
            for (int v = 0; v < n[1]; ++v) {
                sums.fill(rounding);
                if (along_s)
                    along_s->add_row(block.origin[0], block.origin[1] + v, n[0], sums.data());
                if (along_t)
                    along_t->add_row(block.origin[0], block.origin[1] + v, n[0], sums.data());
                visit(sums.data(), s, t, v);
            }
        }
}

int shift_of(const BlockPrediction& prediction) {
    return prediction.from == CopyFrom::both ? 3 : 2;
}

} // namespace

void predict_plane(const Block& block, const BlockPrediction& prediction, const BlockShape& tile,
                   const std::vector<std::int32_t>& plane, std::vector<std::int32_t>& out) {
    const int n = block.shape.n[0], shift = shift_of(prediction);
    out.resize(static_cast<std::size_t>(block.shape.texels()));
    std::int32_t* to = out.data();
    for_each_row(block, prediction, tile, plane, [&](const std::int32_t* sums, int, int, int) {
        for (int u = 0; u < n; ++u)
            *to++ = sums[u] >> shift;
    });
}

void finish_predicted(const Block& block, const BlockPrediction& prediction, SampleType type,
                      const BlockShape& tile, bool has_difference,
                      std::vector<std::int32_t>& plane) {
    const auto& n = block.shape.n;
    const std::int32_t limit = limit_of(type);
    const auto row = [&](int s, int t, int v) {
        return plane.data() +
               (((block.origin[3] + t) * tile.n[2] + block.origin[2] + s) * tile.n[1] +
                block.origin[1] + v) *
                   tile.n[0] +
               block.origin[0];
    };
    if (!prediction.copies()) {
        constexpr std::array<std::int32_t, max_tile_side> nothing{};
        for (int t = 0; has_difference && t < n[3]; ++t)
            for (int s = 0; s < n[2]; ++s)
                for (int v = 0; v < n[1]; ++v)
                    kernels().add_within(row(s, t, v), nothing.data(), 0, n[0], limit);
        return;
    }
    const int shift = shift_of(prediction);
    for_each_row(block, prediction, tile, plane,
                 [&](const std::int32_t* sums, int s, int t, int v) {
                     std::int32_t* to = row(s, t, v);
                     // Means of clamped values need no clamp.
                     if (has_difference)
                         kernels().add_within(to, sums, shift, n[0], limit);
                     else
                         for (int u = 0; u < n[0]; ++u)
                             to[u] = sums[u] >> shift;
                 });
}

} // namespace tessera
