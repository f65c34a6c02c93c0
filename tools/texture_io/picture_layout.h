// Where the texels of a texture lie in one picture.
#pragma once

#include "format/texture.h"
#include "tools/texture_io/view_layout.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace tessera {

// A texel of a row of a picture, and those that follow it as pixels x + 1, x + 2 ...
struct PictureRun {
    std::uint32_t x = 0, count = 0; // pixels
    std::uint32_t u = 0, v = 0, s = 0, t = 0;
    bool along_s = false; // else along u
};

// Either a quilt, where layout.quilt is set, or a mosaic of width U * S, height V * T.
class PictureLayout {
public:
    PictureLayout(const Extent4& size, const ViewLayout& layout, std::uint32_t width,
                  std::uint32_t height)
        : size_(size), layout_(layout), width_(width), height_(height) {}

    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }

    // The rows that hold texels of `box`, first and last + 1.
    std::pair<std::uint32_t, std::uint32_t> rows_of(const Box4& box) const {
        if (!layout_.quilt)
            return {box.begin[axis_v] * size_[axis_t], box.end[axis_v] * size_[axis_t]};
        return rows_of_quilt(box);
    }

    // The runs of row y that may hold texels of `box`, from left to right. Pixels of no texel are in none.
    template <class Visit>
    void visit_row(std::uint32_t y, const Box4& box, const Visit& visit) const {
        if (layout_.quilt)
            visit_quilt(y, visit);
        else
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                visit(PictureRun{u * size_[axis_s], size_[axis_s], u, y / size_[axis_t], 0,
                                 y % size_[axis_t], true});
    }

private:
    // What is left over is at the end of the order: above where that goes up.
    std::uint32_t left_over_above() const {
        return layout_.order.bottom_up ? height_ - layout_.quilt->t * size_[axis_v] : 0;
    }

    // Those of the cells that hold cameras of the box.
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
        const std::uint32_t above = left_over_above();
        return {above + std::min(first, last) * size_[axis_v], above + last * size_[axis_v]};
    }

    template <class Visit> void visit_quilt(std::uint32_t y, const Visit& visit) const {
        const ViewGrid& quilt = *layout_.quilt;
        const std::uint32_t used = quilt.t * size_[axis_v], above = left_over_above();
        if (y < above || y - above >= used)
            return;
        const std::uint32_t row = (y - above) / size_[axis_v], v = (y - above) % size_[axis_v];
        for (std::uint32_t column = 0; column < quilt.s; ++column) {
            const ViewPlace at =
                camera_in_quilt(quilt, layout_.order, size_[axis_s], {column, row});
            if (at.t < size_[axis_t])
                visit(PictureRun{column * size_[axis_u], size_[axis_u], 0, v, at.s, at.t, false});
        }
    }

    Extent4 size_;
    ViewLayout layout_;
    std::uint32_t width_, height_;
};

} // namespace tessera
