#include "format/tile/prediction.h"

#include <algorithm>
#include <bit>

namespace tessera {
namespace {

bool decode_displacement(RansDecoder& rans, const CodeTables& tables, int direction,
                         PredictionMemory& memory, Displacement& out) {
    const auto d = static_cast<std::size_t>(direction);
    const int kind = tables.displacement_kind[d].decode(rans);
    if (kind < 2) {
        out = memory.known(direction, kind);
    } else {
        std::array<int, 2> at = {memory.known(direction, 0).u, memory.known(direction, 0).v};
        for (int component = 0; component < 2; ++component) {
            int& value = at[static_cast<std::size_t>(component)];
            value += decode_difference(rans, tables.displacement[static_cast<std::size_t>(
                                                 displacement_class(direction, component))]);
            if (value < -max_displacement || value > max_displacement)
                return false;
        }
        out = {static_cast<std::int8_t>(at[0]), static_cast<std::int8_t>(at[1])};
    }
    memory.remember(direction, out);
    return true;
}

// Decodes the displacement of a block that copies the base picture.
bool decode_base_displacement(RansDecoder& rans, const CodeTables& tables, const BasePictures& base,
                              PredictionMemory& memory, Displacement& out) {
    const int d = memory.base_displacement() + decode_difference(rans, tables.base_displacement);
    if (d < -max_displacement || d > max_displacement)
        return false;
    memory.remember_base_displacement(d);
    out = base_displacement(base, d);
    return true;
}

// The path of splits that leads to coordinate x of a side of n: one bit per split, the first one
// highest.
std::uint32_t split_path(int n, int x) {
    std::uint32_t path = 0;
    for (int depth = 0; depth < max_split_depth; ++depth) {
        const int head = (n + 1) / 2;
        const bool second = n > 1 && x >= head;
        path = path << 1 | (second ? 1u : 0u);
        x -= second ? head : 0;
        n = second ? n - head : head;
    }
    return path;
}

} // namespace

bool copies_anything(std::span<const BlockPrediction> predictions) {
    return std::any_of(predictions.begin(), predictions.end(),
                       [](const BlockPrediction& prediction) { return prediction.copies(); });
}

bool predicts_anything(std::span<const BlockPrediction> predictions) {
    return std::any_of(predictions.begin(), predictions.end(),
                       [](const BlockPrediction& prediction) { return prediction.is_predicted(); });
}

BlockPrediction decode_border_mode(RansDecoder& rans, const CodeTables& tables, const Block& block,
                                   ModeMemory& memory) {
    const int symbol = tables.mode[static_cast<std::size_t>(memory.context(block))].decode(rans);
    BlockPrediction prediction;
    prediction.mode = symbol == ModeMemory::other_direction
                          ? static_cast<BorderMode>(mode_first_direction + rans.raw(direction_bits))
                          : memory.mode_of(block, symbol);
    memory.remember(block, prediction.mode);
    return prediction;
}

bool decode_prediction(RansDecoder& rans, const CodeTables& tables, const BasePictures* base,
                       const Block& block, PredictionMemory& memory, BlockPrediction& out) {
    out = {};
    if (base != nullptr) {
        const bool copies = tables.from_base[memory.copied_base()].decode(rans) != 0;
        memory.remember_base(copies);
        if (copies) {
            out.from = CopyFrom::base;
            return decode_base_displacement(rans, tables, *base, memory, out.displacement);
        }
    }
    const int context = memory.context_of(block);
    if (context < 0)
        return true;
    const int from = copy_from_symbol(
        tables.prediction[static_cast<std::size_t>(context)].decode(rans), context);
    if (from < 0)
        return false;
    out.from = static_cast<CopyFrom>(from);
    memory.remember(from != 0);
    return !out.copies() ||
           decode_displacement(rans, tables, out.direction(), memory, out.displacement);
}

CopyDepths copy_depths(const BlockShape& tile, std::span<const Block> blocks,
                       std::span<const BlockPrediction> predictions, std::size_t base_blocks) {
    // The cells of angular splits are ordered by their paths, t before s. The views before a cell
    // along s or t then lie in cells that come earlier in this order, whatever their sizes.
    std::array<std::uint32_t, max_tile_side> path_s{}, path_t{};
    for (int s = 0; s < tile.n[2]; ++s)
        path_s[static_cast<std::size_t>(s)] = split_path(tile.n[2], s);
    for (int t = 0; t < tile.n[3]; ++t)
        path_t[static_cast<std::size_t>(t)] = split_path(tile.n[3], t);
    const auto key = [&](const Block& block) {
        std::uint32_t both = 0;
        for (int bit = max_split_depth; bit-- > 0;)
            both = both << 2 | (path_t[block.origin[3]] >> bit & 1) << 1 |
                   (path_s[block.origin[2]] >> bit & 1);
        return both;
    };
    // The low bits keep the order of blocks with equal keys.
    constexpr int index_bits = 16;
    static_assert(max_leaves <= 1 << index_bits && 2 * max_split_depth + 1 + index_bits <= 32);
    std::vector<std::uint32_t> keys(blocks.size());
    for (std::size_t i = 0; i < blocks.size(); ++i)
        keys[i] = (i < base_blocks ? 0 : 1 + key(blocks[i])) << index_bits |
                  static_cast<std::uint32_t>(i);
    if (!std::ranges::is_sorted(keys)) // as they are in pictures
        std::ranges::sort(keys);
    CopyDepths result;
    result.order.reserve(blocks.size());
    for (const std::uint32_t k : keys)
        result.order.push_back(static_cast<std::uint16_t>(k));

    std::vector<std::uint8_t> view_depth(static_cast<std::size_t>(tile.n[2] * tile.n[3]));
    const auto deepest = [&](int s, int s_end, int t, int t_end) {
        int depth = 0;
        for (int y = t; y < t_end; ++y)
            for (int x = s; x < s_end; ++x)
                depth =
                    std::max<int>(depth, view_depth[static_cast<std::size_t>(y * tile.n[2] + x)]);
        return depth;
    };
    result.depth.resize(blocks.size());
    for (const std::uint16_t i : result.order) {
        if (i < base_blocks)
            continue; // blocks of the base picture have depth 0 and lie in no view of the tile
        const Block& block = blocks[i];
        const int s = block.origin[2], s_end = s + block.shape.n[2];
        const int t = block.origin[3], t_end = t + block.shape.n[3];
        int depth = 0;
        if (predictions[i].from == CopyFrom::along_s && s > 0)
            depth = 1 + deepest(s - 1, s, t, t_end);
        else if (predictions[i].from == CopyFrom::along_t && t > 0)
            depth = 1 + deepest(s, s_end, t - 1, t);
        else if (predictions[i].copies_base())
            depth = 1;
        result.largest = std::max(result.largest, depth);
        result.depth[i] = static_cast<std::uint8_t>(std::min(depth, max_copy_depth + 1));
        for (int y = t; y < t_end; ++y)
            for (int x = s; x < s_end; ++x) {
                auto& view = view_depth[static_cast<std::size_t>(y * tile.n[2] + x)];
                view = std::max(view, result.depth[i]);
            }
    }
    return result;
}

CopyDepths limit_copy_depths(const BlockShape& tile, std::span<const Block> blocks,
                             std::span<BlockPrediction> predictions) {
    for (;;) {
        CopyDepths depths = copy_depths(tile, blocks, predictions);
        if (depths.largest <= max_copy_depth)
            return depths;
        for (std::size_t i = 0; i < blocks.size(); ++i)
            if (depths.depth[i] > max_copy_depth)
                predictions[i] = {};
    }
}

} // namespace tessera
