#include "codec/reconstruct/reconstruct.h"

#include "codec/kernels/kernels.h"
#include "codec/reconstruct/copy_prediction.h"
#include "format/tile/colour_rotation.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

using Support = std::array<std::uint8_t, 4>;

// Dense coefficients of the support box, order t, s, v, u.
void dequantize_plane(std::span<const NonZero> levels, const ScanOrder& order,
                      const ScaleSet& scales, const ReconstructionOffsets& offsets,
                      const Support& support, std::vector<std::int32_t>& box) {
    const int v_step = support[0], s_step = v_step * support[1], t_step = s_step * support[2];
    // Room for every later pass, too.
    box.resize(std::max(box.size(), static_cast<std::size_t>(order.shape.texels())));
    std::fill_n(box.begin(), t_step * support[3], 0);
    for (const NonZero& nz : levels) {
        const auto& k = order.entry[nz.index].k;
        const int axes = (k[0] > 0) + (k[1] > 0) + (k[2] > 0) + (k[3] > 0);
        const std::int32_t magnitude =
            dequantize(std::abs(nz.level), scales[static_cast<std::size_t>(axes)], offsets);
        box[static_cast<std::size_t>(k[0] + k[1] * v_step + k[2] * s_step + k[3] * t_step)] =
            nz.level < 0 ? -magnitude : magnitude;
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

// The four passes, u first: the innermost axis grows while the others are still small.
void inverse_transform(const Support& support, const BlockShape& shape,
                       ReconstructScratch& scratch) {
    const auto& n = shape.n;
    const Kernels& k = kernels();
    const std::size_t texels = static_cast<std::size_t>(shape.texels());
    scratch.b.resize(std::max(scratch.b.size(), texels));
    std::int32_t* from = scratch.a.data();
    std::int32_t* to = scratch.b.data();
    if (n[0] > 1) {
        k.inverse_rows(from, to, support[1] * support[2] * support[3], support[0], n[0]);
        std::swap(from, to);
    }
    int inner = n[0];
    int outer = support[2] * support[3];
    for (int axis = 1; axis < 4; ++axis) {
        if (n[axis] > 1) {
            for (int o = 0; o < outer; ++o)
                k.inverse_planes(from + o * support[axis] * inner, to + o * n[axis] * inner,
                                 support[axis], n[axis], inner);
            std::swap(from, to);
        }
        inner *= n[axis];
        outer = axis < 3 ? outer / support[axis + 1] : 0;
    }
    if (from != scratch.a.data())
        scratch.a.swap(scratch.b);
}

// First texel of a block's rows for its (s, t), in a plane of the tile.
int row_start(const Block& block, const BlockShape& tile, int s, int t) {
    return plane_index(tile, block.origin[0], block.origin[1], block.origin[2] + s,
                       block.origin[3] + t);
}

void store_block(const Block& block, const std::int32_t* values, int shift, std::int32_t limit,
                 const BlockShape& tile, std::vector<std::int32_t>& plane) {
    const auto& n = block.shape.n;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s, values += n[0] * n[1])
            kernels().round_rows(
                values, shift,
                {plane.data() + row_start(block, tile, s, t), tile.n[0], n[1], n[0], false, limit});
}

void fill_block(const Block& block, std::int32_t value, const BlockShape& tile,
                std::vector<std::int32_t>& plane) {
    const auto& n = block.shape.n;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s)
            for (int v = 0; v < n[1]; ++v)
                std::fill_n(plane.data() + row_start(block, tile, s, t) + v * tile.n[0], n[0],
                            value);
}

// One block being reconstructed.
class BlockReconstruction {
public:
    BlockReconstruction(const TileLevels& tile, std::size_t index, const TileCoding& coding,
                        ReconstructScratch& scratch, TilePlanes& planes)
        : tile_(tile), block_(tile.blocks[index]), colour_(tile.colours[index]),
          is_of_base_(index < tile.base_blocks), coding_(coding),
          shape_(scratch.shapes.get(coding, block_.shape)), scratch_(scratch),
          picture_(is_of_base_ ? planes.base_shape : tile.shape),
          planes_(is_of_base_ ? planes.base : planes.plane),
          levels_(tile.planes.data() + index * static_cast<std::size_t>(coding.planes)),
          copies_(tile.copies(index)),
          limit_(tile.predictions.empty() || copies_ ? no_limit : value_limit(coding.type)) {}

    // Whether run() gives the plane values that are not all 0.
    bool has_levels(int plane) const {
        if (colour_ != 0 && plane < 3)
            return !levels(0).empty() || !levels(1).empty() || !levels(2).empty();
        return !levels(plane).empty();
    }

    void run() {
        int plane = 0;
        if (colour_ != 0) {
            rotated_planes();
            plane = 3;
        }
        for (; plane < coding_.planes; ++plane) {
            const auto nonzeros = levels(plane);
            if (nonzeros.empty()) {
                fill(plane, 0);
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
                fill(plane, 0);
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
            fill(plane, (scratch_.a[0] + (1 << (shift - 1))) >> shift);
            return;
        }
        inverse_transform(support, block_.shape, scratch_);
        store_block(block_, scratch_.a.data(), shift, limit_, picture_,
                    planes_[static_cast<std::size_t>(plane)]);
    }

    void fill(int plane, std::int32_t value) {
        if (copies_ && !has_levels(plane))
            return; // the copy will stand there
        fill_block(block_, std::clamp(value, -limit_, limit_ - 1), picture_,
                   planes_[static_cast<std::size_t>(plane)]);
    }

    const TileLevels& tile_;
    const Block& block_;
    const int colour_;
    const bool is_of_base_;
    const TileCoding& coding_;
    const ShapeCoding& shape_;
    ReconstructScratch& scratch_;
    const BlockShape& picture_; // that the block is a part of: the tile, or its base
    std::array<std::vector<std::int32_t>, max_planes>& planes_; // of this
    const PlaneLevels* const levels_;
    const bool copies_;
    const std::int32_t limit_; // of its values, of which differences have none
};

} // namespace

void reconstruct_block(const TileLevels& levels, std::size_t block, const TileCoding& coding,
                       ReconstructScratch& scratch, TilePlanes& planes) {
    BlockReconstruction reconstruction(levels, block, coding, scratch, planes);
    reconstruction.run();
    if (!levels.copies(block))
        return;
    for (int plane = 0; plane < coding.planes; ++plane)
        add_copies(levels.blocks[block], levels.predictions[block], coding,
                   reconstruction.has_levels(plane), planes, static_cast<std::size_t>(plane));
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
