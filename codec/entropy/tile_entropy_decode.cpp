#include "codec/entropy/context_grid.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "format/tile/split_tree.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace tessera {
namespace {

// Decodes one tile. The limits of the format bound every loop, whatever the bytes are.
class LevelDecoder {
public:
    LevelDecoder(const TileCoding& coding, ContextGrid& grid, TileLevels& out)
        : coding_(coding), grid_(grid), out_(out) {}

    Status decode(const PayloadParts& parts, const BlockShape& shape) {
        out_.clear();
        out_.shape = shape;
        for (std::size_t i = 0; i < parts.segments.size(); ++i) {
            rans_ = RansDecoder(parts.segments[i].bytes);
            work_ = 0;
            last_colour_ = ColourMemory{};
            if (i == 0 && !decode_tree())
                return damaged(i, "split tree out of range");
            if (i == 0 && !order_copies())
                return damaged(i, "copies depend on copies more than 15 deep");
            const std::size_t end =
                i + 1 < parts.segments.size()
                    ? static_cast<std::size_t>(parts.segments[i + 1].first_block)
                    : out_.blocks.size();
            if (end > out_.blocks.size() ||
                (i > 0 && end <= static_cast<std::size_t>(parts.segments[i].first_block)))
                return damaged(i, "segment begins past the last block");
            for (std::size_t block = static_cast<std::size_t>(parts.segments[i].first_block);
                 block < end; ++block)
                if (!decode_block(block))
                    return damaged(i, "level or work out of range");
            if (!rans_.ended_well())
                return damaged(i, "stream does not end where it should");
        }
        out_.nonzeros.resize(found_);
        return {};
    }

private:
    static Status damaged(std::size_t segment, const char* what) {
        return {ErrorCode::invalid_file, "segment " + std::to_string(segment) + ": " + what};
    }

    bool decode_tree() {
        const auto node = [&](Split split) {
            ++work_;
            out_.splits.push_back(static_cast<std::uint8_t>(split));
        };
        if (coding_.parameters.plane_trees && is_picture(out_.shape) && rans_.raw(1) != 0)
            return decode_plane_trees(node);
        ModeMemory modes;
        const auto base_leaf = [&](const Block& block) {
            out_.blocks.push_back(block);
            out_.predictions.push_back(decode_border_mode(rans_, coding_.tables, block, modes));
            return out_.blocks.size() <= max_leaves;
        };
        const auto base = base_shape(out_.shape, coding_.parameters.base);
        const bool has_base = base && coding_.tables.base.decode(rans_) != 0;
        if (has_base &&
            !decode_split_tree(rans_, coding_.tables, base_root(*base), node, base_leaf))
            return false;
        out_.base_blocks = out_.blocks.size();
        PredictionMemory memory;
        const auto leaf = [&](const Block& block) {
            out_.blocks.push_back(block);
            if (out_.blocks.size() > max_leaves)
                return false;
            if (coding_.predicts && is_picture(out_.shape)) {
                out_.predictions.push_back(decode_border_mode(rans_, coding_.tables, block, modes));
                return true;
            }
            return !coding_.predicts ||
                   decode_prediction(rans_, coding_.tables,
                                     has_base ? &coding_.parameters.base : nullptr, block, memory,
                                     out_.predictions.emplace_back());
        };
        return decode_split_tree(rans_, coding_.tables, Block{{0, 0, 0, 0}, out_.shape, 0, 0}, node,
                                 leaf);
    }

    // A tree for each of two planes.
    template <class Node> bool decode_plane_trees(const Node& node) {
        for (int plane = 0; plane < 2; ++plane) {
            out_.second_tree = out_.blocks.size();
            ModeMemory modes;
            const auto leaf = [&](const Block& block) {
                out_.blocks.push_back(block);
                out_.predictions.push_back(decode_border_mode(rans_, coding_.tables, block, modes));
                return out_.blocks.size() <= max_leaves;
            };
            if (!decode_split_tree(rans_, coding_.tables, Block{.shape = out_.shape}, node, leaf))
                return false;
        }
        return true;
    }

    // False if copies depend on copies more than max_copy_depth deep.
    bool order_copies() {
        if (!predicts_anything(out_.predictions) && out_.base_blocks == 0) {
            out_.forget_copies();
            return true;
        }
        CopyDepths depths =
            copy_depths(out_.shape, out_.blocks, out_.predictions, out_.base_blocks);
        out_.order = std::move(depths.order);
        return depths.largest <= max_copy_depth;
    }

    bool decode_block(std::size_t index) {
        const Block& block = out_.blocks[index];
        const ShapeCoding& shape = shapes_.get(coding_, block.shape);
        const std::size_t first_plane = out_.planes.size();
        int previous = 0;
        bool is_empty = true; // all planes before
        const PlaneRange range = out_.planes_of(index, coding_.planes);
        for (int file_plane = 0; file_plane < coding_.planes; ++file_plane) {
            const int plane = file_plane - range.first; // in the block
            if (plane < 0 || file_plane >= range.end) {
                out_.planes.push_back({.first = static_cast<std::uint32_t>(found_)});
                continue;
            }
            const int token =
                coding_.table_class(plane) == 0
                    ? coding_.tables
                          .first_length[static_cast<std::size_t>(
                              length_context(block.shape, out_.copies(index)))]
                          .decode(rans_)
                    : coding_.tables.other_length[static_cast<std::size_t>(previous)].decode(rans_);
            const int bits = length_raw_bits(token);
            int length = token == 0 ? 0 : 1 << (token - 1);
            length += static_cast<int>(rans_.raw(bits)) << std::max(0, token - 1 - bits);
            length = std::min(length, shape.order.length());
            work_ += 1 + length;
            if (work_ > max_segment_work)
                return false;
            PlaneLevels levels;
            levels.first = static_cast<std::uint32_t>(found_);
            levels.coded_length = static_cast<std::uint16_t>(length);
            out_.planes.push_back(levels);
            if (plane == 0) {
                previous = token;
                if (!decode_colour(length))
                    return false;
            }
            if (length > 0 && out_.is_predicted(index) &&
                is_before_transform(plane, is_empty, coding_.parameters.transforms_any_plane))
                decode_transform(block.shape, out_.predictions[index]);
            is_empty = is_empty && length == 0;
            if (length > 0 && !decode_plane(first_plane + static_cast<std::size_t>(range.first),
                                            plane, out_.copies(index), shape.order))
                return false;
        }
        return true;
    }

    bool decode_colour(int first_length) {
        BlockColour colour;
        if (first_length > 0 && coding_.rotates) {
            const int kind =
                coding_.tables.colour[static_cast<std::size_t>(last_colour_.context)].decode(rans_);
            if (kind == colour_as_before)
                colour = last_colour_.last;
            else if (kind == colour_rotated)
                colour.rotation = static_cast<std::uint8_t>(1 + rans_.raw(rotation_index_bits));
            else if (kind == colour_from_luma)
                for (std::size_t c = 0; c < 2; ++c) {
                    const int share =
                        last_colour_.share[c] + decode_difference(rans_, coding_.tables.share[c]);
                    if (std::abs(share) > most_share)
                        return false;
                    colour.share[c] = static_cast<std::int8_t>(share);
                }
            if (colour.rotation > rotation_count || (kind == colour_from_luma && colour.is_plain()))
                return false;
            last_colour_.remember(colour);
        }
        out_.colours.push_back(colour);
        return true;
    }

    void decode_transform(const BlockShape& shape, BlockPrediction& prediction) {
        if (const int context = transform_context(prediction.mode, shape); context >= 0)
            prediction.transform = static_cast<BlockTransform>(
                coding_.tables.transform[static_cast<std::size_t>(context)].decode(rans_));
    }

    bool decode_plane(std::size_t first_plane, int plane, bool copies, const ScanOrder& order) {
        PlaneLevels& levels = out_.planes[first_plane + static_cast<std::size_t>(plane)];
        const int length = levels.coded_length;
        const bool dependent = coding_.parameters.dependent;
        grid_.begin(order);
        const auto for_each_before = [&](auto visit) {
            for (int earlier = 0; earlier < plane; ++earlier)
                for (const NonZero& nz :
                     out_.levels(out_.planes[first_plane + static_cast<std::size_t>(earlier)]))
                    if (nz.index < length)
                        visit(nz);
        };
        for_each_before([&](const NonZero& nz) {
            grid_.mark_cross(order.context[nz.index], amplitude_of_level(nz.level, dependent));
        });
        const bool flat = is_picture(order.shape);
        const bool first = coding_.table_class(plane) == 0;
        const auto decode = !dependent ? first ? &LevelDecoder::decode_coefficients<false, 0, false>
                                               : &LevelDecoder::decode_coefficients<false, 1, false>
                            : flat ? first ? &LevelDecoder::decode_coefficients<true, 0, true>
                                           : &LevelDecoder::decode_coefficients<true, 1, true>
                            : first ? &LevelDecoder::decode_coefficients<true, 0, false>
                                       : &LevelDecoder::decode_coefficients<true, 1, false>;
        make_room(static_cast<std::size_t>(length));
        const bool is_well = (this->*decode)(length, copies, order);
        levels.count = static_cast<std::uint16_t>(found_ - levels.first);
        grid_.undo(order, length, out_.levels(levels), for_each_before);
        return is_well;
    }

    // Lets `more` levels follow those that were found. Levels are decoded in place, because copying
    // them would take longer than setting them to 0 here, many at once.
    void make_room(std::size_t more) {
        if (out_.nonzeros.size() < found_ + more)
            out_.nonzeros.resize(2 * (found_ + more));
    }

    // Decodes `length` coefficients and appends those that are not zero to the found ones. False if
    // a level is out of range. Decoding spends a quarter of its time here, so the loop keeps what it
    // needs in local variables. Files without dependent quantisation are rare and share one loop
    // for blocks of one view (`flat`) and of several.
    template <bool dependent, int p_class, bool flat>
    [[gnu::noinline]] bool decode_coefficients(int length, bool copies, const ScanOrder& order) {
        constexpr unsigned by_cross =
            zero_parameter(false, 0, 1, 0, 0, 1) - zero_parameter(false, 0, 1, 0, 0, 0);
        constexpr unsigned by_position = zero_parameter(false, 0, 0, 1, 0, 0);
        const auto zeros_of = [&](int quantiser) {
            return coding_.tables.zero.data() + zero_parameter(copies, quantiser, p_class, 0, 0, 0);
        };
        const std::uint16_t* const zeros[quantisers] = {zeros_of(0), zeros_of(1)};
        const auto magnitudes_of = [&](int quantiser) {
            return coding_.tables.magnitude.data() +
                   magnitude_table(copies, quantiser, p_class, false, 0, 0);
        };
        const SymbolTable<magnitude_tokens>* const magnitudes[quantisers] = {magnitudes_of(0),
                                                                             magnitudes_of(1)};
        constexpr unsigned dc_tables = magnitude_table(false, 0, p_class, true, 0, 0) -
                                       magnitude_table(false, 0, p_class, false, 0, 0);
        const ScanContext* const contexts = order.context.data();
        const ContextCells cells = grid_;
        RansDecoder rans = rans_;
        NonZero* found = out_.nonzeros.data() + found_;
        bool is_well = true;
        unsigned state = 0;
        // DC has no neighbours and uses the size of the block instead, and tables of its own.
        unsigned size = static_cast<unsigned>(size_class(order.shape)), own_tables = dc_tables;
        for (int i = 0; i < length; ++i) {
            const ScanContext& context = contexts[i];
            const unsigned neighbours = static_cast<unsigned>(cells.neighbours(context)) + size;
            const unsigned first_table = own_tables;
            size = 0;
            own_tables = 0;
            const int cross = p_class == 0 ? 0 : cells.cross(context); // no planes before the first
            const unsigned quantiser = state & 1;
            if (!rans.bit(zeros[quantiser][unsigned(cross) * by_cross +
                                           context.position * by_position + neighbours])) {
                state = dependent ? next_state[state][0] : 0;
                continue;
            }
            const unsigned table = p_class == 0 || first_table != 0
                                       ? first_table + neighbours
                                       : neighbours / 2 * magnitude_crosses +
                                             static_cast<unsigned>(std::max(cross - 2, 0));
            const auto magnitude = static_cast<std::uint32_t>(
                take_magnitude(rans, magnitudes[quantiser][table].decode(rans)));
            const std::uint32_t level = dependent ? 2 * magnitude - quantiser : magnitude;
            if (level > max_level) {
                is_well = false;
                break;
            }
            const std::uint32_t negative = rans.raw(1);
            *found++ = {static_cast<std::uint16_t>(i),
                        static_cast<std::int32_t>((level ^ (0 - negative)) + negative)};
            if constexpr (dependent)
                cells.mark<flat>(context, level);
            else
                cells.mark(context, 2 * level);
            state = dependent ? next_state[state][magnitude & 1] : 0;
        }
        rans_ = rans;
        found_ = static_cast<std::size_t>(found - out_.nonzeros.data());
        return is_well;
    }

    const TileCoding& coding_;
    ContextGrid& grid_;
    TileLevels& out_;
    RansDecoder rans_;
    std::size_t found_ = 0; // levels that were found, the first ones of out_.nonzeros
    RecentShapes shapes_;
    ColourMemory last_colour_;
    int work_ = 0;
};

} // namespace

Status decode_levels(const PayloadParts& parts, const BlockShape& shape, const TileCoding& coding,
                     ContextGrid& grid, TileLevels& out) {
    return LevelDecoder(coding, grid, out).decode(parts, shape);
}

} // namespace tessera
