#include "codec/tile_encoder/source_tile.h"

#include "codec/reconstruct/copy_prediction.h"
#include "codec/search_kernels/forward_dct.h"

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

// Whether all values are +0.
bool is_blank(const float* x, std::size_t count) {
    std::uint32_t bits = 0; // without branches
    for (std::size_t i = 0; i < count; ++i)
        bits |= std::bit_cast<std::uint32_t>(x[i]);
    return bits == 0;
}

} // namespace

void SourceTile::set(const TilePlanes& planes) {
    shape_ = planes.shape;
    zero_shape_ = {};
    for (int p = 0; p < coding_->planes; ++p) {
        planes_[p].resize(shape_.texels());
        std::ranges::transform(planes.plane[p], planes_[p].begin(), [this](std::int32_t value) {
            return static_cast<float>(value) * codes_;
        });
    }
}

bool SourceTile::set_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                            const BlockShape& shape) {
    if (!is_ycocg8(colour))
        return false;
    shape_ = shape;
    const auto& [nu, nv, ns, nt] = shape.n;
    if (!(zero_shape_ == shape)) {
        zero_shape_ = shape;
        zero_squares_.assign(static_cast<std::size_t>(nu) * nv / 8 * (std::size_t{ns} * nt / 8), 0);
    }
    const TexelCodes background = background_planes(colour);
    Ycocg8Planes to{.plane = {},
                    .background = {background[0], background[1], background[2]},
                    .texels = nu * nv,
                    .images = ns * nt,
                    .is_zero = zero_squares_.data()};
    for (std::size_t plane = 0; plane < 3; ++plane) {
        planes_[plane].resize(shape.texels());
        to.plane[plane] = planes_[plane].data();
    }
    search_kernels().load_ycocg8(to, reinterpret_cast<const unsigned char*>(texels.data()));
    return true;
}

void SourceTile::difference(const Block& block, const BlockPrediction& prediction, int plane,
                            const TilePlanes& reconstructed, float* to) {
    const auto& n = block.shape.n;
    const bool is_predicted = prediction.is_predicted();
    if (is_predicted)
        predict_plane(block, prediction, *coding_, reconstructed, plane, predicted_);
    const int image = n[0] * n[1];
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s, to += image) {
            const float* from =
                planes_[plane].data() + plane_index(shape_, block.origin[0], block.origin[1],
                                                    block.origin[2] + s, block.origin[3] + t);
            if (is_predicted)
                search_kernels().subtract_predicted(from, shape_.n[0],
                                                    predicted_.data() + (t * n[2] + s) * image,
                                                    codes_, n[1], n[0], to);
            else
                for (int v = 0; v < n[1]; ++v)
                    std::copy_n(from + v * shape_.n[0], n[0], to + v * n[0]);
        }
}

void SourceTile::subtract(const Block& block, int plane, const std::int32_t* predicted,
                          float* to) const {
    const int nu = block.shape.n[0], nv = block.shape.n[1];
    const float* from =
        planes_[plane].data() + plane_index(shape_, block.origin[0], block.origin[1], 0, 0);
    if (predicted != nullptr)
        search_kernels().subtract_predicted(from, shape_.n[0], predicted, codes_, nv, nu, to);
    else
        for (int v = 0; v < nv; ++v)
            std::copy_n(from + v * shape_.n[0], nu, to + v * nu);
}

void SourceTile::transform(const Block& block, const BlockPrediction& prediction,
                           const TilePlanes& reconstructed, BlockCoefficients& out, int planes) {
    out.shape = block.shape;
    out.copies = prediction.copies();
    out.is_predicted = prediction.is_predicted();
    const auto texels = static_cast<std::size_t>(block.shape.texels());
    const AxisTransforms axes = axis_transforms(prediction.transform, block.shape);
    difference_.resize(std::max(difference_.size(), texels));
    for (int p = 0; p < planes; ++p) {
        difference(block, prediction, p, reconstructed, difference_.data());
        out.is_blank[p] = transform_plane(block.shape, axes, difference_.data(), out.plane[p]);
    }
}

bool SourceTile::transform_plane(const BlockShape& shape, AxisTransforms axes,
                                 const float* difference, std::vector<float>& out) {
    const auto texels = static_cast<std::size_t>(shape.texels());
    // Both buffers only grow, because they are swapped below and growing clears memory.
    out.resize(std::max(out.size(), texels));
    scratch_.resize(std::max(scratch_.size(), texels));
    const bool blank = is_blank(difference, texels);
    const float* from = difference;
    for (int axis = blank ? -1 : 3; axis >= 0; --axis) {
        if (shape.n[axis] == 1)
            continue;
        const AxisTransform kind = axis == 0 ? axes.u : axis == 1 ? axes.v : AxisTransform::cosine;
        if (kind == AxisTransform::none)
            continue;
        if (kind == AxisTransform::sine)
            forward_sine_axis(from, scratch_.data(), shape, axis);
        else
            forward_axis(from, scratch_.data(), shape, axis);
        out.swap(scratch_);
        from = out.data();
    }
    if (from == difference)
        std::copy_n(difference, texels, out.data());
    return blank;
}

} // namespace tessera
