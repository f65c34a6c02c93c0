#include "codec/entropy/tile_entropy.h"

#include "codec/entropy/tile_syntax.h"

namespace tessera {
namespace {

struct StatisticsVisitor {
    Statistics& statistics;

    void split(std::size_t spatial, std::size_t angular, int kind) {
        statistics.chain(split_offset + static_cast<int>(spatial * depth_classes + angular) *
                                            (split_kinds - 1),
                         split_kinds - 1, split_kinds, kind);
    }
    void first_length(int context, int token) {
        statistics.chain(first_length_offset + context * (length_tokens - 1), length_tokens - 1,
                         length_tokens, token);
    }
    void other_length(int previous, int token) {
        statistics.chain(other_length_offset + previous * (length_tokens - 1), length_tokens - 1,
                         length_tokens, token);
    }
    void prediction(int context, int symbol) {
        statistics.chain(prediction_offset + context * (prediction_kinds - 1), prediction_kinds - 1,
                         prediction_kinds, symbol);
    }
    void displacement_kind(int direction, int kind) {
        statistics.chain(displacement_kind_offset + direction * (displacement_kinds - 1),
                         displacement_kinds - 1, displacement_kinds, kind);
    }
    void mode(int context, int symbol) {
        statistics.chain(mode_offset + context * (mode_symbols - 1), mode_symbols - 1, mode_symbols,
                         symbol);
    }
    void transform(int context, int kind) {
        for (int other = 0; other < kind; ++other)
            statistics.decide(transform_parameter(context, other), true);
        if (kind + 1 < transform_kinds)
            statistics.decide(transform_parameter(context, kind), false);
    }
    void base(bool has_base) { statistics.decide(base_offset, has_base); }
    void from_base(bool before, bool copies) {
        statistics.decide(from_base_offset + before, copies);
    }
    void base_displacement(int token) {
        statistics.chain(base_displacement_offset, displacement_tokens - 1, displacement_tokens,
                         token);
    }
    void displacement(int table, int token) {
        statistics.chain(displacement_offset + table * (displacement_tokens - 1),
                         displacement_tokens - 1, displacement_tokens, token);
    }
    void zero(int parameter, bool is_zero) { statistics.decide(parameter, !is_zero); }
    void magnitude(int table, int token) {
        statistics.chain(magnitude_offset + table * magnitude_chain, magnitude_chain,
                         magnitude_tokens, token);
    }
    void colour(int context, int kind) {
        statistics.chain(colour_offset + context * (colour_kinds - 1), colour_kinds - 1,
                         colour_kinds, kind);
    }
    void share(int plane, int token) {
        statistics.chain(share_offset + plane * (share_tokens - 1), share_tokens - 1, share_tokens,
                         token);
    }
    void raw(std::uint32_t, int) {}
};

struct CodingVisitor {
    const CodeTables& tables;
    RansEncoder coder;

    void split(std::size_t spatial, std::size_t angular, int kind) {
        tables.split[spatial][angular].encode(coder, kind);
    }
    void first_length(int context, int token) {
        tables.first_length[static_cast<std::size_t>(context)].encode(coder, token);
    }
    void other_length(int previous, int token) {
        tables.other_length[static_cast<std::size_t>(previous)].encode(coder, token);
    }
    void prediction(int context, int symbol) {
        tables.prediction[static_cast<std::size_t>(context)].encode(coder, symbol);
    }
    void displacement_kind(int direction, int kind) {
        tables.displacement_kind[static_cast<std::size_t>(direction)].encode(coder, kind);
    }
    void mode(int context, int symbol) {
        tables.mode[static_cast<std::size_t>(context)].encode(coder, symbol);
    }
    void transform(int context, int kind) {
        tables.transform[static_cast<std::size_t>(context)].encode(coder, kind);
    }
    void base(bool has_base) { tables.base.encode(coder, has_base); }
    void from_base(bool before, bool copies) { tables.from_base[before].encode(coder, copies); }
    void base_displacement(int token) { tables.base_displacement.encode(coder, token); }
    void displacement(int table, int token) {
        tables.displacement[static_cast<std::size_t>(table)].encode(coder, token);
    }
    void zero(int parameter, bool is_zero) {
        coder.bit(!is_zero, tables.zero[static_cast<std::size_t>(parameter)]);
    }
    void magnitude(int table, int token) {
        tables.magnitude[static_cast<std::size_t>(table)].encode(coder, token);
    }
    void colour(int context, int kind) {
        tables.colour[static_cast<std::size_t>(context)].encode(coder, kind);
    }
    void share(int plane, int token) {
        tables.share[static_cast<std::size_t>(plane)].encode(coder, token);
    }
    void raw(std::uint32_t value, int bits) { coder.raw(value, bits); }
};

void put_u16(std::vector<std::byte>& out, std::size_t value) {
    out.push_back(static_cast<std::byte>(value & 255));
    out.push_back(static_cast<std::byte>(value >> 8));
}

int block_work(const TileLevels& tile, std::size_t block, int planes) {
    const PlaneRange range = tile.planes_of(block, planes);
    int work = range.end - range.first;
    for (int plane = range.first; plane < range.end; ++plane)
        work +=
            tile.planes[block * static_cast<std::size_t>(planes) + static_cast<std::size_t>(plane)]
                .coded_length;
    return work;
}

// An upper bound of the number of segments: two adjacent ones together exceed most_work.
constexpr int segments_bound(int work, int most_work) {
    return 2 * work / most_work + 1;
}
constexpr int most_work_of_tile(int texels) {
    return texels * max_planes + (max_planes + 2) * max_leaves; // coefficients, lengths, nodes
}
static_assert(segments_bound(most_work_of_tile(max_corrected_texels), usual_segment_work) <=
              most_segments(max_corrected_texels));
static_assert(segments_bound(most_work_of_tile(max_tile_texels), max_segment_work) <=
              most_segments(max_tile_texels));

// The first block of each segment. Segments are filled greedily.
std::vector<std::size_t> cut_segments(const TileLevels& tile, int planes, int most_work) {
    int total = static_cast<int>(tile.splits.size());
    for (std::size_t block = 0; block < tile.blocks.size(); ++block)
        total += block_work(tile, block, planes);
    if (segments_bound(total, most_work) > most_segments(tile.shape.texels()))
        most_work = max_segment_work;
    std::vector<std::size_t> first{0};
    int work = static_cast<int>(tile.splits.size());
    for (std::size_t block = 0; block < tile.blocks.size(); ++block) {
        const int more = block_work(tile, block, planes);
        if (work > 0 && work + more > most_work) {
            first.push_back(block);
            work = 0;
        }
        work += more;
    }
    return first;
}

} // namespace

int round_up_coded_length(int length, int limit) {
    const int shift = std::max(0, length_token(length) - 3);
    return std::min((((length - 1) >> shift) + 1) << shift, limit);
}

void Statistics::add(const Statistics& other) {
    for (std::size_t i = 0; i < parameter_count; ++i) {
        stops[i] += other.stops[i];
        goes[i] += other.goes[i];
    }
}

void count_symbols(const TileLevels& tile, const TileCoding& coding, Statistics& statistics) {
    StatisticsVisitor visitor{statistics};
    TileWalker walker(coding, visitor);
    walker.walk_tree(tile);
    // Each segment forgets the colours of the one before. Counting a long tile as one segment makes
    // its colour counts slightly inexact.
    for (std::size_t block = 0; block < tile.blocks.size(); ++block)
        walker.walk_block(tile, block);
}

void encode_levels(const TileLevels& tile, std::span<const std::vector<std::byte>> corrections,
                   const TileCoding& coding, std::vector<std::byte>& out, int segment_work) {
    CodingVisitor visitor{coding.tables, {}};
    TileWalker walker(coding, visitor);
    std::vector<std::size_t> first = cut_segments(tile, coding.planes, segment_work);
    std::vector<std::vector<std::byte>> segments(first.size());
    first.push_back(tile.blocks.size());
    walker.walk_tree(tile);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        walker.begin_segment();
        for (std::size_t block = first[i]; block < first[i + 1]; ++block)
            walker.walk_block(tile, block);
        visitor.coder.finish(segments[i]);
    }

    if (segments.size() > 1 || !corrections.empty()) {
        out.push_back(
            static_cast<std::byte>((segments.size() - 1) | (corrections.empty() ? 0u : 128u)));
        for (std::size_t i = 1; i < segments.size(); ++i) {
            put_u16(out, first[i]);
            put_u16(out, segments[i].size() / 2);
        }
        std::size_t mask = 0;
        for (std::size_t chunk = 0; chunk < corrections.size(); ++chunk)
            mask |= std::size_t{!corrections[chunk].empty()} << chunk;
        if (!corrections.empty())
            put_u16(out, mask);
        for (const auto& stream : corrections)
            if (!stream.empty())
                put_u16(out, stream.size() / 2);
    }
    for (const auto& stream : segments)
        out.insert(out.end(), stream.begin(), stream.end());
    for (const auto& stream : corrections)
        out.insert(out.end(), stream.begin(), stream.end());
}

} // namespace tessera
