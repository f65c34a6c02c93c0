#include "codec/reconstruct.h"

#include "codec/kernels.h"

#include <algorithm>
#include <cstdlib>

namespace tessera {
namespace {

using Support = std::array<std::uint8_t, 4>;

// Dense coefficients of the support box, order t, s, v, u.
void dequantize_plane(std::span<const NonZero> levels, const ShapeCoding& shape, int plane,
                      const ReconstructionOffsets& offsets, const Support& support,
                      std::vector<std::int32_t>& box) {
    const int v_step = support[0], s_step = v_step * support[1], t_step = s_step * support[2];
    // Room for every later pass, too.
    box.resize(std::max(box.size(), static_cast<std::size_t>(shape.order.shape.texels())));
    std::fill_n(box.begin(), t_step * support[3], 0);
    const ScaleSet& scales = shape.scales[static_cast<std::size_t>(plane)];
    for (const NonZero& nz : levels) {
        const auto& k = shape.order.entry[nz.index].k;
        const int axes = (k[0] > 0) + (k[1] > 0) + (k[2] > 0) + (k[3] > 0);
        const std::int32_t magnitude =
            dequantize(std::abs(nz.level), scales[static_cast<std::size_t>(axes)], offsets);
        box[static_cast<std::size_t>(k[0] + k[1] * v_step + k[2] * s_step + k[3] * t_step)] =
            nz.level < 0 ? -magnitude : magnitude;
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

void store_block(const Block& block, const std::int32_t* values, int shift,
                 const BlockShape& tile, std::vector<std::int32_t>& plane) {
    const std::int32_t half = 1 << (shift - 1);
    const auto& n = block.shape.n;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s)
            for (int v = 0; v < n[1]; ++v, values += n[0]) {
                std::int32_t* row =
                    plane.data() +
                    (((block.origin[3] + t) * tile.n[2] + block.origin[2] + s) * tile.n[1] +
                     block.origin[1] + v) *
                        tile.n[0] +
                    block.origin[0];
                for (int u = 0; u < n[0]; ++u)
                    row[u] = (values[u] + half) >> shift;
            }
}

void fill_block(const Block& block, std::int32_t value, const BlockShape& tile,
                std::vector<std::int32_t>& plane) {
    const auto& n = block.shape.n;
    for (int t = 0; t < n[3]; ++t)
        for (int s = 0; s < n[2]; ++s)
            for (int v = 0; v < n[1]; ++v)
                std::fill_n(plane.data() +
                                (((block.origin[3] + t) * tile.n[2] + block.origin[2] + s) *
                                     tile.n[1] +
                                 block.origin[1] + v) *
                                    tile.n[0] +
                                block.origin[0],
                            n[0], value);
}

} // namespace

void reconstruct(const TileLevels& levels, const TileCoding& coding, ReconstructScratch& scratch,
                 TilePlanes& planes) {
    planes.resize(levels.shape, coding.planes);
    const int shift = fraction_bits(coding.type);
    for (std::size_t b = 0; b < levels.blocks.size(); ++b) {
        const Block& block = levels.blocks[b];
        const ShapeCoding& shape = coding.shape(block.shape);
        for (int plane = 0; plane < coding.planes; ++plane) {
            auto& target = planes.plane[static_cast<std::size_t>(plane)];
            const auto nonzeros =
                levels.levels(levels.planes[b * static_cast<std::size_t>(coding.planes) +
                                            static_cast<std::size_t>(plane)]);
            if (nonzeros.empty()) {
                fill_block(block, 0, levels.shape, target);
                continue;
            }
            const Support& support = shape.order.support[nonzeros.back().index];
            dequantize_plane(nonzeros, shape, plane,
                             coding.parameters.offsets[static_cast<std::size_t>(plane_class(plane))],
                             support, scratch.a);
            if (nonzeros.back().index == 0) {
                fill_block(block, (scratch.a[0] + (1 << (shift - 1))) >> shift, levels.shape,
                           target);
                continue;
            }
            inverse_transform(support, block.shape, scratch);
            store_block(block, scratch.a.data(), shift, levels.shape, target);
        }
    }
}

} // namespace tessera
