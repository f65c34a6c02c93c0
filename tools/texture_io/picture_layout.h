// Where the texels of a texture are in one picture.
#pragma once

#include "format/texture.h"
#include "tools/texture_io/view_layout.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace tessera {

// A quilt, if layout.quilt is set, or a mosaic of width U * S and height V * T.
class PictureLayout {
public:
    // `height`: of the picture in pixels.
    PictureLayout(const Extent4& size, const ViewLayout& layout, std::uint32_t height)
        : size_(size), layout_(layout), height_(height) {}

    // The rows that contain texels of `box`: the first, and the last + 1.
    std::pair<std::uint32_t, std::uint32_t> rows_of(const Box4& box) const {
        if (!layout_.quilt)
            return {box.begin[axis_v] * size_[axis_t], box.end[axis_v] * size_[axis_t]};
        return rows_of_quilt(box);
    }

    // Calls visit(texels, x) for each run of pixels in row y that belongs to `box`: the texels,
    // along s or u, that begin at pixel x.
    template <class Visit>
    void visit_row(std::uint32_t y, const Box4& box, const Visit& visit) const {
        if (layout_.quilt) {
            visit_quilt(y, box, visit);
            return;
        }
        const std::uint32_t v = y / size_[axis_t], t = y % size_[axis_t];
        for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
            const Box4 run{{u, v, 0, t}, {u + 1, v + 1, size_[axis_s], t + 1}};
            if (const Box4 texels = intersect(run, box); texels.texels() > 0)
                visit(texels, u * size_[axis_s] + texels.begin[axis_s]);
        }
    }

private:
    // Unused rows are at the end of the order, which is at the top where views go up.
    std::uint32_t unused_above() const {
        return layout_.order.bottom_up ? height_ - layout_.quilt->t * size_[axis_v] : 0;
    }

    // The rows of the cells whose cameras are in the box.
    std::pair<std::uint32_t, std::uint32_t> rows_of_quilt(const Box4& box) const {
        const ViewGrid& quilt = *layout_.quilt;
        std::uint32_t first = quilt.t, last = 0; // cells, last + 1
        for (std::uint32_t row = 0; row < quilt.t; ++row)
            for (std::uint32_t column = 0; column < quilt.s; ++column) {
                const ViewPlace at =
                    camera_in_quilt(quilt, layout_.order, size_[axis_s], {column, row});
                if (at.s < box.begin[axis_s] || at.s >= box.end[axis_s] ||
                    at.t < box.begin[axis_t] || at.t >= box.end[axis_t])
                    continue;
                first = std::min(first, row);
                last = row + 1;
            }
        const std::uint32_t above = unused_above();
        return {above + std::min(first, last) * size_[axis_v], above + last * size_[axis_v]};
    }

    template <class Visit>
    void visit_quilt(std::uint32_t y, const Box4& box, const Visit& visit) const {
        const ViewGrid& quilt = *layout_.quilt;
        const std::uint32_t used = quilt.t * size_[axis_v], above = unused_above();
        if (y < above || y - above >= used)
            return;
        const std::uint32_t row = (y - above) / size_[axis_v], v = (y - above) % size_[axis_v];
        for (std::uint32_t column = 0; column < quilt.s; ++column) {
            const auto [s, t] = camera_in_quilt(quilt, layout_.order, size_[axis_s], {column, row});
            const Box4 run{{0, v, s, t}, {size_[axis_u], v + 1, s + 1, t + 1}};
            if (const Box4 texels = intersect(run, box); texels.texels() > 0)
                visit(texels, column * size_[axis_u] + texels.begin[axis_u]);
        }
    }

    Extent4 size_;
    ViewLayout layout_;
    std::uint32_t height_;
};

} // namespace tessera
