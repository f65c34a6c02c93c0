#include "codec/reconstruct/reconstruct.h"

#include "codec/kernels/kernels.h"
#include "codec/reconstruct/border_prediction.h"
#include "codec/reconstruct/copy_prediction.h"
#include "format/tile/block_colour.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

void fill_block(const BlockTarget& to, std::int32_t value) {
    for (int t = 0; t < to.n[3]; ++t)
        for (int s = 0; s < to.n[2]; ++s)
            for (int v = 0; v < to.n[1]; ++v)
                std::fill_n(to.out + t * to.t + s * to.s + v * to.row, to.n[0], value);
}

// Reconstructs one block.
class BlockReconstruction {
public:
    BlockReconstruction(const TileLevels& tile, std::size_t index, const TileCoding& coding,
                        ReconstructScratch& scratch, TilePlanes& planes, int fineness)
        : tile_(tile), block_(tile.blocks[index]), colour_(tile.colours[index]),
          is_of_base_(index < tile.base_blocks),
          fineness_(is_of_base_ ? base_fineness(tile.shape) : fineness), coding_(coding),
          shape_(scratch.shapes.get(coding, block_.shape)), scratch_(scratch), tile_planes_(planes),
          picture_(is_of_base_ ? planes.base_shape : tile.shape),
          planes_(is_of_base_ ? planes.base : planes.plane),
          range_(tile.planes_of(index, coding.planes)),
          levels_(tile.planes.data() + index * static_cast<std::size_t>(coding.planes)),
          prediction_(tile.is_predicted(index) ? &tile.predictions[index] : nullptr),
          axes_(prediction_ != nullptr ? axis_transforms(prediction_->transform, block_.shape)
                                       : AxisTransforms{}),
          limit_(tile.predictions.empty() ? no_limit : value_limit(coding.type)) {
        if (prediction_ != nullptr && !prediction_->copies())
            reach_ = border_reach(block_, picture_, is_of_base_ ? planes.base_done : planes.done);
    }

    void run() {
        int plane = range_.first;
        if (!colour_.is_plain()) {
            mixed_planes();
            plane = 3;
        }
        for (; plane < range_.end; ++plane) {
            const auto nonzeros = levels(plane);
            if (nonzeros.empty()) {
                finish_constant(plane, 0);
                continue;
            }
            scratch_.box.begin();
            scratch_.box.add(nonzeros, shape_.order);
            dequantize(plane, scratch_.a);
            finish(plane);
        }
    }

private:
    std::span<const NonZero> levels(int plane) const { return tile_.levels(levels_[plane]); }

    void dequantize(int plane, std::vector<std::int32_t>& values) const {
        const ScaleSet& scales = coding_.scales(shape_, plane, colour_);
        scratch_.box.dequantize(
            levels(plane), shape_.order, fineness_ != 0 ? finer_scales(scales, fineness_) : scales,
            coding_.parameters.offsets[static_cast<std::size_t>(plane_class(plane))], axes_,
            values);
    }

    void mixed_planes() {
        if (levels(0).empty() && levels(1).empty() && levels(2).empty()) {
            for (int plane = 0; plane < 3; ++plane)
                finish_constant(plane, 0);
            return;
        }
        scratch_.box.begin();
        for (int plane = 0; plane < 3; ++plane)
            scratch_.box.add(levels(plane), shape_.order);
        for (int plane = 0; plane < 3; ++plane)
            dequantize(plane, scratch_.rotated[static_cast<std::size_t>(plane)]);
        auto& [a, b, c] = scratch_.rotated;
        std::int32_t* const rotated[3] = {a.data(), b.data(), c.data()};
        const RotationMatrix matrix = colour_matrix(colour_);
        if (colour_.is_rotated())
            kernels().unrotate(rotated, scratch_.box.size(), matrix);
        else
            for (std::size_t p = 1; p < 3; ++p)
                if (matrix[p][0] != 0)
                    predict_chroma(matrix[p][0], scratch_.rotated[p]);
        for (int plane = 0; plane < 3; ++plane) {
            scratch_.a.swap(scratch_.rotated[static_cast<std::size_t>(plane)]);
            finish(plane);
        }
    }

    // Adds a share of luma to the coefficients of a plane.
    void predict_chroma(std::int32_t share, std::vector<std::int32_t>& chroma) {
        const int dc = scratch_.box.dc();
        // The means of blocks without prediction are not related.
        const bool keeps_dc = prediction_ == nullptr && dc >= 0;
        const std::int32_t mean = keeps_dc ? chroma[static_cast<std::size_t>(dc)] : 0;
        kernels().add_luma(scratch_.rotated[0].data(), scratch_.box.size(), share, chroma.data());
        if (keeps_dc)
            chroma[static_cast<std::size_t>(dc)] = mean;
    }

    // Transforms the coefficients in scratch_.a to the block's texels.
    void finish(int plane) {
        const int shift = fraction_bits(coding_.type) - value_bits(coding_.type);
        // Passes with cosines would copy a lone DC coefficient within their range to all texels.
        if (scratch_.box.is_constant() && axes_.all_cosines() &&
            std::abs(scratch_.a[0]) < coefficient_limit) {
            finish_constant(plane, (scratch_.a[0] + (1 << (shift - 1))) >> shift);
            return;
        }
        scratch_.box.transform(block_.shape, axes_, scratch_.a, scratch_.b);
        if (prediction_ != nullptr) {
            add_prediction(plane, shift);
            return;
        }
        kernels().put_block(scratch_.a.data(), shift, target(plane));
    }

    void finish_constant(int plane, std::int32_t value) {
        if (prediction_ != nullptr) {
            make_room(scratch_.a);
            if (value != 0)
                std::fill_n(scratch_.a.begin(), block_.shape.texels(), value);
            add_prediction(plane, value != 0 ? 0 : BaseCopies::nothing_there);
            return;
        }
        fill_block(target(plane), std::clamp(value, -limit_, limit_ - 1));
    }

    BlockTarget target(int plane) const {
        return block_target(block_, picture_, planes_[static_cast<std::size_t>(plane)], limit_);
    }

    // Adds the prediction to scratch_.a; `shift` is as in BaseCopies::add_shift.
    void add_prediction(int plane, int shift) {
        if (prediction_->copies())
            copy_block(block_, *prediction_, coding_, shift, scratch_.a.data(), tile_planes_,
                       static_cast<std::size_t>(plane));
        else
            add_border(plane, shift);
    }

    void add_border(int plane, int shift) {
        const auto& n = block_.shape.n;
        std::vector<std::int32_t>& predicted = scratch_.predicted;
        const auto read = static_cast<std::size_t>((n[1] + 1) * n[0] + 1); // by copy_rows()
        predicted.resize(std::max(predicted.size(), read));
        BlockBorder(block_, picture_, reach_, planes_[static_cast<std::size_t>(plane)])
            .predict(prediction_->mode, predicted.data());
        const bool has_difference = shift != BaseCopies::nothing_there;
        const BlockTarget to = target(plane);
        constexpr int whole_texels = copy_filter(false, 0, 0);
        kernels().copy_rows(predicted.data(), n[0], whole_texels,
                            {.out = to.out,
                             .stride = to.row,
                             .rows = n[1],
                             .n = n[0],
                             .limit = to.limit,
                             .add = has_difference ? scratch_.a.data() : nullptr,
                             .add_stride = n[0],
                             .add_shift = has_difference ? shift : 0});
    }

    void make_room(std::vector<std::int32_t>& values) const {
        values.resize(std::max(values.size(), static_cast<std::size_t>(block_.shape.texels())));
    }

    const TileLevels& tile_;
    const Block& block_;
    const BlockColour colour_;
    const bool is_of_base_;
    const int fineness_;
    const TileCoding& coding_;
    const ShapeCoding& shape_;
    ReconstructScratch& scratch_;
    TilePlanes& tile_planes_;
    const BlockShape& picture_; // the tile or base picture that contains the block
    std::array<std::vector<std::int32_t>, max_planes>& planes_; // of picture_
    const PlaneRange range_;
    const PlaneLevels* const levels_;
    const BlockPrediction* const prediction_; // null if the block is not predicted
    const AxisTransforms axes_;
    const std::int32_t limit_; // for blocks without prediction
    BorderReach reach_;        // of a block that is predicted from its border
};

} // namespace

void reconstruct_block(const TileLevels& levels, std::size_t block, const TileCoding& coding,
                       ReconstructScratch& scratch, TilePlanes& planes, int fineness) {
    BlockReconstruction(levels, block, coding, scratch, planes, fineness).run();
    DecodedRegion& done = block < levels.base_blocks ? planes.base_done : planes.done;
    done.add(levels.blocks[block]);
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
    for (const std::uint16_t block : levels.order) {
        if (levels.second_tree > 0 && block == levels.second_tree)
            planes.done.reset();
        reconstruct_block(levels, block, coding, scratch, planes);
    }
}

} // namespace tessera
