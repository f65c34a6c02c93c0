// The probabilities of a file: parameters, contexts and the rANS tables made from them, normative
// (FORMAT.md 3.5).
//
// Every probability is one parameter, a quantised log-odds. A binary decision uses one; a symbol of
// a larger alphabet is a chain of decisions "this one, or a later one". So tables of any size are
// arrays of small numbers that can be coded as differences to the built-in defaults.
#pragma once

#include "format/limits.h"
#include "format/rans.h"
#include "format/scan_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Frequency out of 4096 of "no / stop" for a parameter: 4096 / (1 + 2^((p - 32) / 3)), rounded,
// within 1..4095. p = 0 is almost surely no, 63 almost surely yes.
constexpr int parameter_count_of_odds = 64;
std::uint32_t stop_frequency(std::uint8_t parameter);

constexpr int plane_classes = 2; // first plane of a leaf; the others
constexpr int neighbour_classes = 10;
constexpr int cross_classes = 3; // magnitudes at the same place in earlier planes: 0, 1, more
constexpr int magnitude_contexts = neighbour_classes + 1; // the last one is DC's
constexpr int magnitude_tokens = 24; // 1, 2, 3, 4, then groups 5-6, 7-10, 11-18, ... of 2^g values
constexpr int magnitude_chain = 9;   // own parameters; later decisions of the chain use the last
constexpr int length_tokens = 14;    // 0, then bit length of the coded length (up to 4096)
constexpr int size_classes = 9;      // (bit length of the block's texel count) / 2, 1..17 -> 0..8
// The table that codes the length of plane 0.
constexpr int size_class(const BlockShape& shape) {
    const int bits = static_cast<int>(std::bit_width(static_cast<unsigned>(shape.texels())));
    return std::min(bits / 2, size_classes - 1);
}
// Tables of plane 0's length: by size, blocks that copy nothing first.
constexpr int length_contexts = 2 * size_classes;
constexpr int length_context(const BlockShape& shape, bool copies) {
    return size_class(shape) + (copies ? size_classes : 0);
}
constexpr int depth_classes = max_split_depth + 1;

constexpr int colour_kinds = 3;         // plain, as the last rotated block, another rotation
constexpr int correction_contexts = 21; // neighbours 0..6, times 3 for the channel before
constexpr int correction_tokens = magnitude_tokens + 1; // 0, then those of magnitudes
constexpr int correction_chain = magnitude_chain + 1;

// Where each group's parameters start, in file order, and how many a file holds in all.
constexpr int zero_parameters =
    position_classes * neighbour_classes * (1 + (plane_classes - 1) * cross_classes);
constexpr int magnitude_offset = zero_parameters;
constexpr int magnitude_parameters = plane_classes * magnitude_contexts * magnitude_chain;
constexpr int first_length_offset = magnitude_offset + magnitude_parameters;
constexpr int first_length_parameters = length_contexts * (length_tokens - 1);
constexpr int other_length_offset = first_length_offset + first_length_parameters;
constexpr int other_length_parameters = length_tokens * (length_tokens - 1);
constexpr int split_offset = other_length_offset + other_length_parameters;
constexpr int split_parameters = depth_classes * depth_classes * 2;
constexpr int correction_offset = split_offset + split_parameters;
constexpr int correction_parameters = correction_contexts * correction_chain;
constexpr int colour_offset = correction_offset + correction_parameters;
constexpr int colour_parameters =
    2 * (colour_kinds - 1); // after a plain block, after a rotated one
constexpr int prediction_kinds = 4;      // nothing, along s, along t, both (see format/prediction.h)
constexpr int prediction_contexts = 6;   // what lies before: s, t, both; times the block before
constexpr int displacement_kinds = 3;    // the last one, the one before it, a new one
constexpr int displacement_tokens = 9;   // bit length of a component's magnitude, 0..255
constexpr int displacement_classes = 2;  // along the parallax, across it
constexpr int prediction_offset = colour_offset + colour_parameters;
constexpr int prediction_parameters = prediction_contexts * (prediction_kinds - 1);
constexpr int displacement_kind_offset = prediction_offset + prediction_parameters;
constexpr int displacement_kind_parameters = 2 * (displacement_kinds - 1);
constexpr int displacement_offset = displacement_kind_offset + displacement_kind_parameters;
constexpr int displacement_parameters = displacement_classes * (displacement_tokens - 1);
constexpr int parameter_count = displacement_offset + displacement_parameters;

using Parameters = std::array<std::uint8_t, parameter_count>;

// Index of the zero-flag parameter. cross is 0 in plane class 0.
constexpr int zero_parameter(int plane_class, int position, int neighbours, int cross) {
    const int row = plane_class == 0 ? 0 : 1 + cross;
    return (row * position_classes + position) * neighbour_classes + neighbours;
}

// A multi-symbol table: start[i] .. start[i + 1] is symbol i's share of 4096.
template <int symbols> struct SymbolTable {
    std::array<std::uint16_t, symbols + 1> start{};

    template <class Coder> void encode(Coder& coder, int symbol) const {
        coder.put(start[symbol], start[symbol + 1] - start[symbol]);
    }
    int decode(RansDecoder& decoder) const {
        const std::uint32_t slot = decoder.slot();
        int symbol = 0;
        while (symbol + 1 < symbols && slot >= start[symbol + 1])
            ++symbol;
        decoder.consume(start[symbol], start[symbol + 1] - start[symbol]);
        return symbol;
    }
};

// Tables ready for coding, made from parameters. Immutable, so thread-safe.
struct CodeTables {
    explicit CodeTables(const Parameters& parameters);

    std::array<std::uint16_t, zero_parameters> zero; // frequency of a zero coefficient
    std::array<std::array<SymbolTable<magnitude_tokens>, magnitude_contexts>, plane_classes>
        magnitude;
    std::array<SymbolTable<length_tokens>, length_contexts> first_length;
    std::array<SymbolTable<length_tokens>, length_tokens> other_length;
    std::array<std::array<SymbolTable<split_kinds>, depth_classes>, depth_classes> split;
    std::array<SymbolTable<correction_tokens>, correction_contexts> correction;
    std::array<SymbolTable<colour_kinds>, 2> colour; // [last block with a colour was rotated]
    std::array<SymbolTable<prediction_kinds>, prediction_contexts> prediction;
    std::array<SymbolTable<displacement_kinds>, 2> displacement_kind; // [along s, along t]
    std::array<SymbolTable<displacement_tokens>, displacement_classes> displacement;
};

// Built-in defaults: what files start from and what small files use as they are.
const Parameters& default_parameters();

} // namespace tessera
