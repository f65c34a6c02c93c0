// The order of a tile's symbols, written once for all code of the encoder that walks them:
// counting, coding and estimating. A Visitor has the functions
//
//   split(depth classes, kind), prediction(context, symbol), displacement_kind(direction, kind),
//   displacement(class, token), base(has one), from_base(block before does, copies),
//   base_displacement(token), mode(context, symbol), first_length(context, token),
//   other_length(previous, token), colour(context, kind), share(plane, token),
//   transform(context, kind), zero(parameter index, is_zero), magnitude(table, token),
//   raw(value, bits)
#pragma once

#include "codec/entropy/context_grid.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "format/tile/block_colour.h"

#include <bit>
#include <cstdlib>

namespace tessera {

constexpr int length_token(int coded_length) {
    return static_cast<int>(std::bit_width(static_cast<unsigned>(coded_length)));
}
constexpr int length_raw_bits(int token) {
    return token <= 1 ? 0 : token == 2 ? 1 : 2;
}

// The token of a difference between displacements.
inline int difference_token(int difference) {
    return static_cast<int>(std::bit_width(static_cast<unsigned>(std::abs(difference))));
}

// Magnitudes 1..4 have tokens 0..3. Token 3 + g covers the 2^g magnitudes from 2^g + 3 on.
struct MagnitudeToken {
    int token = 0;
    int raw_bits = 0;
    std::uint32_t raw = 0;
};
inline MagnitudeToken magnitude_token(std::int32_t magnitude) {
    if (magnitude <= 4)
        return {magnitude - 1, 0, 0};
    const auto offset = static_cast<std::uint32_t>(magnitude - 3);
    const int group = static_cast<int>(std::bit_width(offset)) - 1;
    return {3 + group, group, offset - (1u << group)};
}

// Codes the raw bits that follow a magnitude token. One step of the coder takes at most 16 bits.
template <class Coder> void put_magnitude_raw(Coder& coder, const MagnitudeToken& token) {
    if (token.raw_bits > 16)
        coder.raw(token.raw >> 16, token.raw_bits - 16);
    if (token.raw_bits > 0)
        coder.raw(token.raw & 0xFFFFu, std::min(token.raw_bits, 16));
}

// Reads the raw bits that follow a token and returns the magnitude.
inline std::int32_t take_magnitude(RansDecoder& rans, int token) {
    if (token < 4)
        return token + 1;
    const int group = token - 3;
    std::uint32_t raw = group > 16 ? rans.raw(group - 16) << 16 : 0;
    raw |= rans.raw(std::min(group, 16));
    return static_cast<std::int32_t>((1u << group) + raw + 3);
}

// What a segment remembers of the colours of its blocks.
struct ColourMemory {
    int context = 0; // of the last block with a colour symbol: plain, rotated, predicted
    BlockColour last{.rotation = 1, .share = {}}; // of the last block that was not plain
    std::array<std::int8_t, 2> share{};           // of the last predicted block

    int kind_of(const BlockColour& colour) const {
        return colour.is_plain()     ? colour_plain
               : colour == last      ? colour_as_before
               : colour.is_rotated() ? colour_rotated
                                     : colour_from_luma;
    }
    void remember(const BlockColour& colour) {
        context = colour.is_plain() ? 0 : colour.is_rotated() ? 1 : 2;
        if (context != 0)
            last = colour;
        if (context == 2)
            share = colour.share;
    }
};
constexpr int rotation_index_bits = 6;

template <class Visitor> class TileWalker {
public:
    TileWalker(const TileCoding& coding, Visitor& visitor) : coding_(coding), visitor_(visitor) {}

    // Each segment starts without the colours of the one before.
    void begin_segment() { last_colour_ = ColourMemory{}; }

    void walk_tree(const TileLevels& tile) {
        std::size_t next = 0;
        const Block root{.shape = tile.shape};
        leaf_ = 0;
        if (coding_.parameters.plane_trees && is_picture(tile.shape)) {
            visitor_.raw(tile.second_tree > 0 ? 1 : 0, 1);
            if (tile.second_tree > 0) {
                modes_ = ModeMemory{};
                walk_node(tile, root, next);
            }
        }
        predictions_ = PredictionMemory{};
        modes_ = ModeMemory{};
        if (const auto base = base_shape(tile.shape, coding_.parameters.base)) {
            visitor_.base(tile.base_blocks > 0);
            if (tile.base_blocks > 0)
                walk_node(tile, base_root(*base), next);
        }
        walk_node(tile, root, next);
    }

    void walk_block(const TileLevels& tile, std::size_t block) {
        const BlockShape& shape = tile.blocks[block].shape;
        const ShapeCoding& shape_coding = shapes_.get(coding_, shape);
        int previous = 0;
        bool is_empty = true; // all planes before
        const PlaneRange range = tile.planes_of(block, coding_.planes);
        const PlaneLevels* levels = &tile.planes[block * static_cast<std::size_t>(coding_.planes) +
                                                 static_cast<std::size_t>(range.first)];
        for (int plane = 0; plane < range.end - range.first; ++plane) {
            const int length = levels[plane].coded_length;
            // A length that the end of the scan order cut is coded as it was before the cut.
            const int uncut = round_up_coded_length(length, max_coded_length);
            const int token = length_token(uncut);
            if (coding_.table_class(plane) == 0)
                visitor_.first_length(length_context(shape, tile.copies(block)), token);
            else
                visitor_.other_length(previous, token);
            if (const int bits = length_raw_bits(token); bits > 0)
                visitor_.raw(static_cast<std::uint32_t>(uncut >> (token - 1 - bits)) &
                                 ((1u << bits) - 1),
                             bits);
            if (plane == 0) {
                previous = token;
                if (length > 0 && coding_.rotates)
                    walk_colour(tile.colours[block]);
            }
            if (length > 0 && tile.is_predicted(block) &&
                is_before_transform(plane, is_empty, coding_.parameters.transforms_any_plane))
                walk_transform(tile.predictions[block], shape);
            is_empty = is_empty && length == 0;
            if (length > 0)
                walk_plane(tile, tile.copies(block), {levels, static_cast<std::size_t>(plane) + 1},
                           shape_coding.order);
        }
    }

private:
    void walk_colour(const BlockColour& colour) {
        const int kind = last_colour_.kind_of(colour);
        visitor_.colour(last_colour_.context, kind);
        if (kind == colour_rotated)
            visitor_.raw(static_cast<std::uint32_t>(colour.rotation - 1), rotation_index_bits);
        if (kind == colour_from_luma)
            for (int c = 0; c < 2; ++c) {
                const int difference = colour.share[c] - last_colour_.share[c];
                const int token = difference_token(difference);
                visitor_.share(c, token);
                walk_difference(token, difference);
            }
        last_colour_.remember(colour);
    }

    void walk_transform(const BlockPrediction& prediction, const BlockShape& shape) {
        if (const int context = transform_context(prediction.mode, shape); context >= 0)
            visitor_.transform(context, static_cast<int>(prediction.transform));
    }

    void walk_node(const TileLevels& tile, const Block& node, std::size_t& next) {
        const auto split = static_cast<Split>(tile.splits[next++]);
        if (!is_too_large(node.shape))
            visitor_.split(depth_class(node.spatial_depth), depth_class(node.angular_depth),
                           static_cast<int>(split));
        if (split == Split::none) {
            if (coding_.predicts)
                walk_prediction(tile, node);
            return;
        }
        const Children children = children_of(node, split);
        for (int i = 0; i < children.count; ++i)
            walk_node(tile, children.block[static_cast<std::size_t>(i)], next);
    }

    void walk_prediction(const TileLevels& tile, const Block& block) {
        const BlockPrediction prediction =
            tile.predictions.empty() ? BlockPrediction{} : tile.predictions[leaf_];
        const bool of_base = leaf_++ < tile.base_blocks;
        if (of_base || is_picture(tile.shape)) {
            walk_mode(block, prediction.mode);
            return;
        }
        if (tile.base_blocks > 0) {
            visitor_.from_base(predictions_.copied_base(), prediction.copies_base());
            predictions_.remember_base(prediction.copies_base());
        }
        if (prediction.copies_base()) {
            const int d = prediction.displacement.u;
            const int token = difference_token(d - predictions_.base_displacement());
            visitor_.base_displacement(token);
            walk_difference(token, d - predictions_.base_displacement());
            predictions_.remember_base_displacement(d);
            return;
        }
        const int context = predictions_.context_of(block);
        if (context < 0)
            return;
        visitor_.prediction(context, prediction_symbol(prediction.from, context));
        predictions_.remember(prediction.copies());
        if (!prediction.copies())
            return;
        const int direction = prediction.direction();
        const Displacement& to = prediction.displacement;
        const int kind = predictions_.kind_of(direction, to);
        visitor_.displacement_kind(direction, kind);
        const Displacement from = predictions_.known(direction, 0);
        if (kind == 2) {
            walk_component(displacement_class(direction, 0), to.u - from.u);
            walk_component(displacement_class(direction, 1), to.v - from.v);
        }
        predictions_.remember(direction, to);
    }

    void walk_mode(const Block& block, BorderMode mode) {
        const int symbol = modes_.symbol(block, mode);
        visitor_.mode(modes_.context(block), symbol);
        if (symbol == ModeMemory::other_direction)
            visitor_.raw(static_cast<std::uint32_t>(mode - mode_first_direction), direction_bits);
        modes_.remember(block, mode);
    }

    void walk_component(int table, int difference) {
        const int token = difference_token(difference);
        visitor_.displacement(table, token);
        walk_difference(token, difference);
    }

    // Codes the raw bits that follow a token.
    void walk_difference(int token, int difference) {
        if (token == 0)
            return;
        const auto magnitude = static_cast<unsigned>(std::abs(difference));
        visitor_.raw(magnitude - (1u << (token - 1)), token - 1);
        visitor_.raw(difference < 0, 1);
    }

    // Codes the last plane of `planes`. The earlier ones give the cross contexts.
    void walk_plane(const TileLevels& tile, bool copies, std::span<const PlaneLevels> planes,
                    const ScanOrder& order) {
        const int length = planes.back().coded_length;
        const int p_class = coding_.table_class(static_cast<int>(planes.size()) - 1);
        const bool dependent = coding_.parameters.dependent;
        grid_.begin(order);
        const auto for_each_before = [&](auto visit) {
            for (const PlaneLevels& earlier : planes.first(planes.size() - 1))
                for (const NonZero& nz : tile.levels(earlier))
                    if (nz.index < length)
                        visit(nz);
        };
        for_each_before([&](const NonZero& nz) {
            grid_.mark_cross(order.context[nz.index], amplitude_of_level(nz.level, dependent));
        });
        const std::span<const NonZero> levels = tile.levels(planes.back());
        std::size_t next = 0;
        int state = 0;
        for (int i = 0; i < length; ++i) {
            const ScanContext& context = order.context[static_cast<std::size_t>(i)];
            const int neighbours = i == 0 ? size_class(order.shape) : grid_.neighbours(context);
            const int cross = grid_.cross(context);
            const int quantiser = quantiser_of(state);
            const bool zero = next == levels.size() || levels[next].index != i;
            visitor_.zero(
                zero_parameter(copies, quantiser, p_class, context.position, neighbours, cross),
                zero);
            std::int32_t magnitude = 0;
            if (!zero) {
                const std::int32_t level = levels[next++].level;
                magnitude = coded_magnitude(level, dependent);
                const MagnitudeToken token = magnitude_token(magnitude);
                visitor_.magnitude(
                    magnitude_table(copies, quantiser, p_class, i == 0, neighbours, cross),
                    token.token);
                put_magnitude_raw(visitor_, token);
                visitor_.raw(level < 0, 1);
                grid_.mark(context, amplitude_of_level(level, dependent));
            }
            if (dependent)
                state = next_state[static_cast<std::size_t>(state)]
                                  [static_cast<std::size_t>(magnitude & 1)];
        }
        grid_.undo(order, length, levels, for_each_before);
    }

    const TileCoding& coding_;
    RecentShapes shapes_;
    Visitor& visitor_;
    ContextGrid grid_;
    ColourMemory last_colour_;
    PredictionMemory predictions_;
    ModeMemory modes_;
    std::size_t leaf_ = 0; // index of the next leaf in walk_tree()
};

} // namespace tessera
