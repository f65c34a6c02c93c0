#include "codec/reconstruct/copy_prediction.h"

#include "codec/kernels/kernels.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

// One view of a plane that is copied from, moved by whole and half texels.
class MovedView {
public:
    MovedView(const std::int32_t* view, const BlockShape& tile, int half_u, int half_v, bool smooth)
        : view_(view), width_(tile.n[0]), height_(tile.n[1]), u_(half_u >> 1), v_(half_v >> 1),
          filter_(copy_filter(smooth, half_u, half_v)), before_(smooth ? 1 : 0),
          first_(smooth && (half_v & 1) == 0 ? 0 : 1), last_(smooth || (half_v & 1) != 0 ? 2 : 1) {}

    // Adds the filter's sums at (u .. u + n - 1, v) to `sums`.
    void add_row(int u, int v, int n, std::int32_t* sums) {
        const std::int32_t* rows[3] = {};
        for (int i = first_; i <= last_; ++i)
            rows[i] = row(u + u_ - before_, v + v_ - 1 + i, before_ + n + 1,
                          buffer_[static_cast<std::size_t>(i)].data()) +
                      before_;
        kernels().add_copies(rows, filter_, n, sums);
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
    const int width_, height_, u_, v_, filter_;
    const int before_, first_, last_; // texels before the first, rows: what the filter reads
    std::array<std::array<std::int32_t, max_tile_side + 2>, 3> buffer_;
};

// Calls visit(sums, s, t, v) for every row of a block; sums >> copy_shift() are its predicted values.
template <class Visit>
void for_each_row(const Block& block, const BlockPrediction& prediction, bool smooth,
                  const BlockShape& tile, const std::vector<std::int32_t>& plane, Visit visit) {
    const auto& n = block.shape.n;
    const int page = tile.n[0] * tile.n[1];
    const std::int32_t rounding = 1 << (copy_shift(smooth) - 1);
    const Displacement& d = prediction.displacement;
    std::array<std::int32_t, max_tile_side> sums;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s) {
            const bool along_s = prediction.from == CopyFrom::along_s;
            const int from_s = block.origin[2] + (along_s ? -1 : s);
            const int from_t = block.origin[3] + (along_s ? t : -1);
            const int steps = (along_s ? s : t) + 1;
            MovedView view(plane.data() + (from_t * tile.n[2] + from_s) * page, tile, steps * d.u,
                           steps * d.v, smooth);
            for (int v = 0; v < n[1]; ++v) {
                sums.fill(rounding);
                view.add_row(block.origin[0], block.origin[1] + v, n[0], sums.data());
                visit(sums.data(), s, t, v);
            }
        }
}

} // namespace

void predict_plane(const Block& block, const BlockPrediction& prediction, const TileCoding& coding,
                   const BlockShape& tile, const std::vector<std::int32_t>& plane,
                   std::vector<std::int32_t>& out) {
    const bool smooth = coding.parameters.smooth_copies;
    const int n = block.shape.n[0], shift = copy_shift(smooth);
    out.resize(static_cast<std::size_t>(block.shape.texels()));
    std::int32_t* to = out.data();
    for_each_row(block, prediction, smooth, tile, plane,
                 [&](const std::int32_t* sums, int, int, int) {
                     for (int u = 0; u < n; ++u)
                         *to++ = sums[u] >> shift;
                 });
}

void finish_predicted(const Block& block, const BlockPrediction& prediction,
                      const TileCoding& coding, const BlockShape& tile, bool has_difference,
                      std::vector<std::int32_t>& plane) {
    const auto& n = block.shape.n;
    const std::int32_t limit = value_limit(coding.type);
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
    const bool smooth = coding.parameters.smooth_copies;
    const int shift = copy_shift(smooth);
    for_each_row(block, prediction, smooth, tile, plane,
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
