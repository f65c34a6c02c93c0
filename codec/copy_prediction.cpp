#include "codec/copy_prediction.h"

#include "codec/kernels.h"

#include <algorithm>
#include <array>

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

} // namespace

void predict_plane(const Block& block, const BlockPrediction& prediction, const BlockShape& tile,
                   const std::vector<std::int32_t>& plane, std::vector<std::int32_t>& out) {
    const auto& n = block.shape.n;
    const int texels = block.shape.texels(), page = tile.n[0] * tile.n[1];
    const bool both = prediction.from == CopyFrom::both;
    out.assign(static_cast<std::size_t>(texels), both ? 4 : 2);
    for (int direction = 0; direction < copy_directions; ++direction) {
        if (!prediction.copies_along(direction))
            continue;
        const Displacement& d = prediction.displacement[static_cast<std::size_t>(direction)];
        std::int32_t* sums = out.data();
        for (int t = 0; t < n[3]; ++t)
            for (int s = 0; s < n[2]; ++s) {
                const int from_s = direction == 0 ? block.origin[2] - 1 : block.origin[2] + s;
                const int from_t = direction == 0 ? block.origin[3] + t : block.origin[3] - 1;
                const int steps = 1 + (direction == 0 ? s : t);
                MovedView view(plane.data() + (from_t * tile.n[2] + from_s) * page, tile,
                               steps * d.u, steps * d.v);
                for (int v = 0; v < n[1]; ++v, sums += n[0])
                    view.add_row(block.origin[0], block.origin[1] + v, n[0], sums);
            }
    }
    for (std::int32_t& value : out)
        value >>= both ? 3 : 2;
}

void add_predicted(const Block& block, const std::vector<std::int32_t>& predicted, SampleType type,
                   const BlockShape& tile, std::vector<std::int32_t>& plane) {
    const auto& n = block.shape.n;
    const std::int32_t limit = limit_of(type);
    const std::int32_t* from = predicted.data();
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s)
            for (int v = 0; v < n[1]; ++v) {
                std::int32_t* row =
                    plane.data() +
                    (((block.origin[3] + t) * tile.n[2] + block.origin[2] + s) * tile.n[1] +
                     block.origin[1] + v) *
                        tile.n[0] +
                    block.origin[0];
                for (int u = 0; u < n[0]; ++u)
                    row[u] = std::clamp(row[u] + (predicted.empty() ? 0 : from[u]), -limit,
                                        limit - 1);
                if (!predicted.empty())
                    from += n[0];
            }
}

} // namespace tessera
