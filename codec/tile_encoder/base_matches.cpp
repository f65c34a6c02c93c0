#include "codec/tile_encoder/base_matches.h"

#include "codec/reconstruct/copy_prediction.h"
#include "codec/search_kernels/search_kernels.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::size_t displacements = 2 * farthest_base_copy + 1;

// Merges cells in pairs along `axis` and the next one.
void merge(std::vector<float>& errors, std::array<std::size_t, 4>& count, std::size_t axis) {
    std::array<std::size_t, 4> coarse = count;
    for (const std::size_t a : {axis, axis + 1})
        coarse[a] = (count[a] + 1) / 2;
    std::vector<float> merged(coarse[0] * coarse[1] * coarse[2] * coarse[3] * displacements);
    const float* from = errors.data();
    std::array<std::size_t, 4> c;
    for (c[3] = 0; c[3] < count[3]; ++c[3])
        for (c[2] = 0; c[2] < count[2]; ++c[2])
            for (c[1] = 0; c[1] < count[1]; ++c[1])
                for (c[0] = 0; c[0] < count[0]; ++c[0], from += displacements) {
                    std::array<std::size_t, 4> to = c;
                    for (const std::size_t a : {axis, axis + 1})
                        to[a] = c[a] / 2;
                    float* sum =
                        merged.data() +
                        (((to[3] * coarse[2] + to[2]) * coarse[1] + to[1]) * coarse[0] + to[0]) *
                            displacements;
                    for (std::size_t i = 0; i < displacements; ++i)
                        sum[i] += from[i];
                }
    errors.swap(merged);
    count = coarse;
}

} // namespace

void BaseMatches::begin(const BlockShape& tile, const std::vector<float>& source, float codes,
                        const TileCoding& coding, const TilePlanes& decoded) {
    tile_ = tile;
    source_ = &source;
    codes_ = codes;
    coding_ = &coding;
    decoded_ = &decoded;
    finest_.clear();
}

void BaseMatches::enter(const Axes& cells) {
    std::array<std::size_t, 4> wanted;
    for (std::size_t axis = 0; axis < 4; ++axis)
        wanted[axis] = cells[axis].size();
    if (finest_.empty()) {
        finest_count_ = wanted;
        measure(cells);
        errors_ = finest_;
        count_ = wanted;
        return;
    }
    if (wanted[2] != finest_count_[2] || wanted[3] != finest_count_[3]) {
        merge(finest_, finest_count_, 2);
        errors_ = finest_;
        count_ = finest_count_;
        return;
    }
    merge(errors_, count_, 0);
}

// Measures every displacement in the finest cells.
void BaseMatches::measure(const Axes& cells) {
    const auto& n = tile_.n;
    const Block whole{{0, 0, 0, 0}, tile_, 0, 0};
    finest_.assign(finest_count_[0] * finest_count_[1] * finest_count_[2] * finest_count_[3] *
                       displacements,
                   0.0f);
    // The cell of each coordinate along an axis.
    const auto cells_of = [&](std::size_t axis) {
        std::vector<std::size_t> cell(n[axis]);
        for (std::size_t i = 0; i < cells[axis].size(); ++i)
            std::fill_n(cell.begin() + cells[axis][i].begin, cells[axis][i].size, i);
        return cell;
    };
    const auto of_v = cells_of(1), of_s = cells_of(2), of_t = cells_of(3);
    const std::size_t width = cells[0].size();
    const bool are_quads =
        std::ranges::all_of(cells[0], [](const Segment& cell) { return cell.size == 4; });
    for (std::size_t i = 0; i < displacements; ++i) {
        const int d = static_cast<int>(i) - farthest_base_copy;
        predict_plane(whole, {CopyFrom::base, base_displacement(coding_->parameters.base, d)},
                      *coding_, *decoded_, 0, predicted_);
        of_displacement_.assign(finest_.size() / displacements, 0.0f);
        std::size_t at = 0;
        for (std::size_t t = 0; t < n[3]; ++t)
            for (std::size_t s = 0; s < n[2]; ++s)
                for (std::size_t v = 0; v < n[1]; ++v) {
                    float* const row =
                        of_displacement_.data() +
                        ((of_t[t] * finest_count_[2] + of_s[s]) * finest_count_[1] + of_v[v]) *
                            width;
                    if (are_quads) {
                        search_kernels().add_quad_errors(source_->data() + at,
                                                         predicted_.data() + at, codes_,
                                                         static_cast<int>(width), row);
                        at += 4 * width;
                        continue;
                    }
                    for (std::size_t cell = 0; cell < width; ++cell) {
                        float sum = 0;
                        for (int u = 0; u < cells[0][cell].size; ++u, ++at) {
                            const float e =
                                (*source_)[at] - static_cast<float>(predicted_[at]) * codes_;
                            sum += e * e;
                        }
                        row[cell] += sum;
                    }
                }
        for (std::size_t cell = 0; cell < of_displacement_.size(); ++cell)
            finest_[cell * displacements + i] = of_displacement_[cell];
    }
}

BaseMatch BaseMatches::best(std::size_t cell) const {
    const float* errors = errors_.data() + cell * displacements;
    const auto least = std::min_element(errors, errors + displacements);
    return {static_cast<int>(least - errors) - farthest_base_copy, *least};
}

} // namespace tessera
