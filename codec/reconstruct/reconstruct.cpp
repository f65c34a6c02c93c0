#include "codec/reconstruct/reconstruct.h"

#include "codec/kernels/kernels.h"
#include "codec/reconstruct/copy_prediction.h"
#include "format/tile/colour_rotation.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

using Support = std::array<std::uint8_t, 4>;

// Whether coefficients and the passes along u and v are in the order v, u, t, s, which fills vectors where
// blocks are narrow and have many views, instead of t, s, v, u.
bool views_run_fastest(const Support& support) {
    constexpr int fewest_views = 8; // that fill a vector
    return support[2] * support[3] >= fewest_views;
}

// Dense coefficients of the support box, order as views_run_fastest() says.
void dequantize_plane(std::span<const NonZero> levels, const ScanOrder& order,
                      const ScaleSet& scales, const ReconstructionOffsets& offsets,
                      const Support& support, std::vector<std::int32_t>& box) {
    const int images = support[0] * support[1], views = support[2] * support[3];
    const std::array<int, 4> step =
        views_run_fastest(support) ? std::array<int, 4>{views, views * support[0], 1, support[2]}
                                   : std::array<int, 4>{1, support[0], images, images * support[2]};
    // Room for every later pass, too.
    box.resize(std::max(box.size(), static_cast<std::size_t>(order.shape.texels())));
    std::fill_n(box.begin(), images * views, 0);
    for (const NonZero& nz : levels) {
        const auto& k = order.entry[nz.index].k;
        const int axes = (k[0] > 0) + (k[1] > 0) + (k[2] > 0) + (k[3] > 0);
        const std::int32_t magnitude =
            dequantize(std::abs(nz.level), scales[static_cast<std::size_t>(axes)], offsets);
        box[static_cast<std::size_t>(k[0] * step[0] + k[1] * step[1] + k[2] * step[2] +
                                     k[3] * step[3])] = nz.level < 0 ? -magnitude : magnitude;
    }
}

// From rotated axes back to Y, Co, Cg. Coefficients are split as in 4.3, so that 32 bits do.
void unrotate(std::array<std::vector<std::int32_t>, 3>& planes, std::size_t count, int rotation) {
    constexpr int low = 11;
    const RotationMatrix& m = rotation_matrix(rotation);
    for (std::size_t i = 0; i < count; ++i) {
        const std::array<std::int32_t, 3> x = {planes[0][i], planes[1][i], planes[2][i]};
        if ((x[0] | x[1] | x[2]) == 0)
            continue;
        for (std::size_t plane = 0; plane < 3; ++plane) {
            std::int32_t high_sum = 0, low_sum = 0;
            for (std::size_t j = 0; j < 3; ++j) {
                high_sum += m[plane][j] * (x[j] >> low);
                low_sum += m[plane][j] * (x[j] & ((1 << low) - 1));
            }
            planes[plane][i] = (high_sum + ((low_sum + (1 << (rotation_bits - 1))) >> low)) >>
                               (rotation_bits - low);
        }
    }
}

void transpose(const std::int32_t* from, int rows, int columns, std::int32_t* to) {
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j)
            *to++ = from[j * columns + i];
}

// The four passes, u first: the innermost axis grows while the others are still small.
void inverse_transform(const Support& support, const BlockShape& shape,
                       ReconstructScratch& scratch) {
    const auto& n = shape.n;
    const Kernels& k = kernels();
    const std::size_t texels = static_cast<std::size_t>(shape.texels());
    scratch.b.resize(std::max(scratch.b.size(), texels));
    std::int32_t* from = scratch.a.data();
    std::int32_t* to = scratch.b.data();
    const int views = support[2] * support[3], page = n[0] * n[1];
    const auto pass = [&](std::size_t axis, int outer, int inner) {
        if (n[axis] == 1)
            return;
        for (int o = 0; o < outer; ++o)
            k.inverse_planes(from + o * support[axis] * inner, to + o * n[axis] * inner,
                             support[axis], n[axis], inner);
        std::swap(from, to);
    };
    if (views_run_fastest(support)) {
        pass(0, support[1], views);
        pass(1, 1, n[0] * views);
        transpose(from, page, views, to);
        std::swap(from, to);
    } else {
        if (n[0] > 1) {
            k.inverse_rows(from, to, support[1] * views, support[0], n[0]);
            std::swap(from, to);
        }
        pass(1, views, n[0]);
    }
    pass(2, support[3], page);
    pass(3, 1, page * n[2]);
    if (from != scratch.a.data())
        scratch.a.swap(scratch.b);
}

void fill_block(const BlockTarget& to, std::int32_t value) {
    for (int t = 0; t < to.n[3]; ++t)
        for (int s = 0; s < to.n[2]; ++s)
            for (int v = 0; v < to.n[1]; ++v)
                std::fill_n(to.out + t * to.t + s * to.s + v * to.row, to.n[0], value);
}

// One block being reconstructed.
class BlockReconstruction {
public:
    BlockReconstruction(const TileLevels& tile, std::size_t index, const TileCoding& coding,
                        ReconstructScratch& scratch, TilePlanes& planes)
        : tile_(tile), block_(tile.blocks[index]), colour_(tile.colours[index]),
          is_of_base_(index < tile.base_blocks), coding_(coding),
          shape_(scratch.shapes.get(coding, block_.shape)), scratch_(scratch), tile_planes_(planes),
          picture_(is_of_base_ ? planes.base_shape : tile.shape),
          planes_(is_of_base_ ? planes.base : planes.plane),
          levels_(tile.planes.data() + index * static_cast<std::size_t>(coding.planes)),
          prediction_(tile.copies(index) ? &tile.predictions[index] : nullptr),
          limit_(tile.predictions.empty() ? no_limit : value_limit(coding.type)) {}

    void run() {
        int plane = 0;
        if (colour_ != 0) {
            rotated_planes();
            plane = 3;
        }
        for (; plane < coding_.planes; ++plane) {
            const auto nonzeros = levels(plane);
            if (nonzeros.empty()) {
                finish_constant(plane, 0);
                continue;
            }
            const Support& support = shape_.order.support[nonzeros.back().index];
            dequantize(plane, support, scratch_.a);
            finish(plane, support);
        }
    }

private:
    std::span<const NonZero> levels(int plane) const { return tile_.levels(levels_[plane]); }

    void dequantize(int plane, const Support& support, std::vector<std::int32_t>& box) const {
        const ScaleSet& scales = coding_.scales(shape_, plane, colour_);
        dequantize_plane(levels(plane), shape_.order,
                         is_of_base_ ? finer_scales(scales, base_fineness(tile_.shape)) : scales,
                         coding_.parameters.offsets[static_cast<std::size_t>(plane_class(plane))],
                         support, box);
    }

    void rotated_planes() {
        int last = -1;
        for (int plane = 0; plane < 3; ++plane)
            if (!levels(plane).empty())
                last = std::max<int>(last, levels(plane).back().index);
        if (last < 0) {
            for (int plane = 0; plane < 3; ++plane)
                finish_constant(plane, 0);
            return;
        }
        const Support& support = shape_.order.support[static_cast<std::size_t>(last)];
        for (int plane = 0; plane < 3; ++plane)
            dequantize(plane, support, scratch_.rotated[static_cast<std::size_t>(plane)]);
        unrotate(scratch_.rotated,
                 static_cast<std::size_t>(support[0] * support[1] * support[2] * support[3]),
                 colour_ - 1);
        for (int plane = 0; plane < 3; ++plane) {
            scratch_.a.swap(scratch_.rotated[static_cast<std::size_t>(plane)]);
            finish(plane, support);
        }
    }

    // Coefficients in scratch_.a -> the block's texels.
    void finish(int plane, const Support& support) {
        const int shift = fraction_bits(coding_.type) - value_bits(coding_.type);
        // A constant within the range of the passes goes through them as it is.
        if (support == Support{1, 1, 1, 1} && std::abs(scratch_.a[0]) < coefficient_limit) {
            finish_constant(plane, (scratch_.a[0] + (1 << (shift - 1))) >> shift);
            return;
        }
        inverse_transform(support, block_.shape, scratch_);
        if (prediction_ != nullptr) {
            const int texels = block_.shape.texels();
            std::int32_t* const values = scratch_.a.data();
            kernels().put_block(values, shift, {values, {texels, 1, 1, 1}, 0, 0, 0, no_limit});
            add_copies(plane, true);
            return;
        }
        kernels().put_block(scratch_.a.data(), shift, target(plane));
    }

    void finish_constant(int plane, std::int32_t value) {
        if (prediction_ != nullptr) {
            make_room(scratch_.a);
            if (value != 0)
                std::fill_n(scratch_.a.begin(), block_.shape.texels(), value);
            add_copies(plane, value != 0);
            return;
        }
        fill_block(target(plane), std::clamp(value, -limit_, limit_ - 1));
    }

    BlockTarget target(int plane) const {
        return block_target(block_, picture_, planes_[static_cast<std::size_t>(plane)], limit_);
    }

    void add_copies(int plane, bool has_difference) {
        copy_block(block_, *prediction_, coding_, has_difference, scratch_.a.data(), tile_planes_,
                   static_cast<std::size_t>(plane));
    }

    void make_room(std::vector<std::int32_t>& values) const {
        values.resize(std::max(values.size(), static_cast<std::size_t>(block_.shape.texels())));
    }

    const TileLevels& tile_;
    const Block& block_;
    const int colour_;
    const bool is_of_base_;
    const TileCoding& coding_;
    const ShapeCoding& shape_;
    ReconstructScratch& scratch_;
    TilePlanes& tile_planes_;
    const BlockShape& picture_; // that the block is a part of: the tile, or its base
    std::array<std::vector<std::int32_t>, max_planes>& planes_; // of this
    const PlaneLevels* const levels_;
    const BlockPrediction* const prediction_; // none where it copies nothing
    const std::int32_t limit_;                // of values that copy nothing
};

} // namespace

void reconstruct_block(const TileLevels& levels, std::size_t block, const TileCoding& coding,
                       ReconstructScratch& scratch, TilePlanes& planes) {
    BlockReconstruction(levels, block, coding, scratch, planes).run();
}

void reconstruct(const TileLevels& levels, const TileCoding& coding, ReconstructScratch& scratch,
                 TilePlanes& planes) {
    planes.resize(levels.shape, coding.planes);
    if (levels.base_blocks > 0)
        planes.resize_base(*base_shape(levels.shape, coding.parameters.base), coding.planes);
    if (levels.predictions.empty()) {
        for (std::size_t block = 0; block < levels.blocks.size(); ++block)
            reconstruct_block(levels, block, coding, scratch, planes);
        return;
    }
    for (const std::uint16_t block : levels.order)
        reconstruct_block(levels, block, coding, scratch, planes);
}

} // namespace tessera
