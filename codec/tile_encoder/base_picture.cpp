#include "codec/tile_encoder/base_picture.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

// Where a position of the base picture is seen along one axis: in which view, the nearest to the
// middle one that sees it, and at which of its texels. If no view sees it, the middle view's edge
// is used.
struct Seen {
    int view, texel;
};
Seen look(int at, int texels, int views, int displacement) {
    const int middle = (views - 1) / 2;
    if (at >= 0 && at < texels)
        return {middle, at};
    for (int away = 1; away < views; ++away)
        for (const int view : {middle - away, middle + away}) {
            const int texel = at - (((view - middle) * displacement + base_unit / 2) >> 3);
            if (view >= 0 && view < views && texel >= 0 && texel < texels)
                return {view, texel};
        }
    return {middle, std::clamp(at, 0, texels - 1)};
}

template <class T> void prepend(const std::vector<T>& before, std::vector<T>& items) {
    items.insert(items.begin(), before.begin(), before.end());
}

} // namespace

void BaseDisplacements::take(const TileLevels& tile) {
    for (std::size_t i = 0; i < tile.blocks.size(); ++i)
        if (tile.predictions[i].copies_base())
            set(tile.blocks[i], tile.predictions[i].displacement.u);
}

void BaseDisplacements::set(const Block& block, int displacement) {
    for (int v = 0; v < block.shape.n[1]; ++v)
        std::fill_n(of_place_.begin() + (block.origin[1] + v) * width_ + block.origin[0],
                    block.shape.n[0], static_cast<std::int8_t>(displacement));
}

void make_base_picture(const TilePlanes& tile, int planes, const BasePictures& pictures,
                       const BaseDisplacements& displacements, TilePlanes& picture) {
    const auto& n = tile.shape.n;
    const int margin = pictures.margin;
    picture.resize(*base_shape(tile.shape, pictures), planes);
    std::size_t at = 0;
    for (int v = -margin; v < n[1] + margin; ++v)
        for (int u = -margin; u < n[0] + margin; ++u, ++at) {
            const int d =
                displacements.at(std::clamp<int>(u, 0, n[0] - 1), std::clamp<int>(v, 0, n[1] - 1));
            const Seen s = look(u, n[0], n[2], d);
            const Seen t = look(v, n[1], n[3], pictures.v_against_u ? -d : d);
            const auto from = plane_index(tile.shape, s.texel, t.texel, s.view, t.view);
            for (int plane = 0; plane < planes; ++plane)
                picture.plane[plane][at] = tile.plane[plane][from];
        }
}

bool copies_base(const TileLevels& tile) {
    return std::any_of(tile.predictions.begin(), tile.predictions.end(),
                       [](const BlockPrediction& prediction) { return prediction.copies_base(); });
}

void prepend_base(const TileLevels& base, TileLevels& tile) {
    tile.base_blocks = base.blocks.size();
    for (PlaneLevels& plane : tile.planes)
        plane.first += static_cast<std::uint32_t>(base.nonzeros.size());
    for (std::uint16_t& block : tile.order)
        block = static_cast<std::uint16_t>(block + base.blocks.size());
    std::vector<Block> blocks = base.blocks;
    for (Block& block : blocks)
        block.angular_depth = base_root(base.shape).angular_depth;
    prepend(blocks, tile.blocks);
    prepend(base.colours, tile.colours);
    prepend(base.splits, tile.splits);
    std::vector<BlockPrediction> predictions = base.predictions;
    predictions.resize(base.blocks.size()); // empty if nothing is predicted
    prepend(predictions, tile.predictions);
    std::vector<std::uint16_t> order(base.blocks.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = static_cast<std::uint16_t>(i);
    prepend(order, tile.order);
    prepend(base.planes, tile.planes);
    prepend(base.nonzeros, tile.nonzeros);
}

} // namespace tessera
