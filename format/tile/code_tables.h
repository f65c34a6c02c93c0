// The probabilities of a file: their parameters, the contexts that select them, and the rANS tables
// that follow from them, normative (FORMAT.md 3.4, 3.5).
//
// Every probability is one parameter, a quantised log-odds. A binary decision uses one parameter. A
// symbol of a larger alphabet is a chain of decisions "this symbol, or a later one". So all tables
// are arrays of small numbers, which are coded as differences from the built-in defaults.
#pragma once

#include "format/tile/limits.h"
#include "format/tile/rans.h"
#include "format/tile/scan_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The number of values that a parameter can have.
constexpr int parameter_count_of_odds = 64;
// The frequency of 0 ("stop") out of 4096 for a parameter: 4096 / (1 + 2^((p - 32) / 3)), rounded,
// within 1..4095. At p = 0 a decision is almost always 0, at p = 63 almost always 1.
std::uint32_t stop_frequency(std::uint8_t parameter);

constexpr int plane_classes = 2; // the first plane of a block; the other planes
constexpr int copy_classes = 2;  // blocks that copy nothing; blocks that copy

// Dependent quantisation (FORMAT.md 3.4): the parities of the magnitudes before a coefficient
// select one of two quantisers, which have the even and the odd multiples of half a step. Files
// without dependent quantisation stay in state 0.
constexpr int quantiser_states = 8;
// [state][parity of the magnitude]
constexpr std::uint8_t next_state[quantiser_states][2] = {{0, 2}, {5, 7}, {1, 3}, {6, 4},
                                                          {2, 0}, {4, 6}, {3, 1}, {7, 5}};
constexpr int quantisers = 2;
constexpr int quantiser_of(int state) {
    return state & 1;
}

// Contexts depend on amplitudes, which are distances from 0 in half steps, rounded down to two
// binary digits. The code c stands for amplitudes[c].
constexpr int amplitude_codes = 16;
constexpr std::array<std::uint8_t, amplitude_codes> amplitudes{0,  1,  2,  3,  4,  6,  8,   12,
                                                               16, 24, 32, 48, 64, 96, 128, 192};
constexpr std::uint32_t amplitude_of(int code) {
    return amplitudes[static_cast<std::size_t>(code)];
}
// The code of each number up to the largest mean of amplitudes in 1/8. The decoder waits for these
// look-ups, so that a longer table is faster than a comparison.
inline constexpr auto codes_of_amplitudes = [] {
    std::array<std::uint8_t, 8 * amplitudes.back() + 1> codes{};
    for (std::size_t x = 1; x < codes.size(); ++x) {
        const std::size_t before = codes[x - 1];
        codes[x] = static_cast<std::uint8_t>(
            before + (before + 1 < amplitudes.size() && x == amplitudes[before + 1]));
    }
    return codes;
}();
constexpr int amplitude_code(std::uint32_t amplitude) {
    return codes_of_amplitudes[std::min<std::size_t>(amplitude, amplitudes.back())];
}
// amplitude_of(amplitude_code(x)) of each x up to the largest amplitude.
inline constexpr auto rounded_amplitudes = [] {
    std::array<std::uint8_t, amplitudes.back() + 1> rounded{};
    for (std::size_t x = 0; x < rounded.size(); ++x)
        rounded[x] = amplitudes[codes_of_amplitudes[x]];
    return rounded;
}();
constexpr std::uint32_t rounded_amplitude(std::uint32_t amplitude) {
    return rounded_amplitudes[std::min<std::size_t>(amplitude, amplitudes.back())];
}
// Classes of the weighted mean of the neighbours' amplitudes, which counts in 1/8. `sum` is the
// weighted sum of rounded amplitudes, and `share` is 4096 / (sum of the weights).
constexpr int neighbour_classes = amplitude_codes;
constexpr int neighbour_class(std::uint32_t sum, std::uint32_t share) {
    return codes_of_amplitudes[(sum * share) >> 9];
}
constexpr int cross_classes = 6; // of the amplitude at the same frequency in earlier planes
constexpr int cross_class(int code) {
    return std::min((code + 1) / 2, cross_classes - 1);
}
inline constexpr auto cross_classes_of_codes = [] {
    std::array<std::uint8_t, amplitude_codes> classes{};
    for (int code = 0; code < amplitude_codes; ++code)
        classes[static_cast<std::size_t>(code)] = static_cast<std::uint8_t>(cross_class(code));
    return classes;
}();
constexpr int magnitude_tokens = 24; // 1, 2, 3, 4, then groups 5-6, 7-10, 11-18, ... of 2^g values
constexpr int magnitude_chain = 9;   // parameters per table; later decisions use the last one
constexpr int length_tokens = 14;    // 0, then the bit length of the coded length (up to 4096)
constexpr int size_classes = 9;      // half the bit length of the block's number of texels
constexpr int size_class(const BlockShape& shape) {
    const int bits = static_cast<int>(std::bit_width(static_cast<unsigned>(shape.texels())));
    return std::min(bits / 2, size_classes - 1);
}
// Tables for the coded length of plane 0: one per size class for blocks that copy nothing, then one
// per size class for blocks that copy.
constexpr int length_contexts = 2 * size_classes;
constexpr int length_context(const BlockShape& shape, bool copies) {
    return size_class(shape) + (copies ? size_classes : 0);
}
// Classes of the depth of a node in the split tree along a pair of axes. The deepest nodes share
// one.
constexpr int depth_classes = 6;
constexpr std::size_t depth_class(int depth) {
    return static_cast<std::size_t>(std::min(depth, depth_classes - 1));
}

// The magnitude tables of a copy class and a quantiser. Plane 0 has one table per neighbour class,
// then those of its DC, one per size class. The other planes have one per half neighbour class and
// cross class, then those of their DC, one per size class.
constexpr int magnitude_crosses = cross_classes - 2; // the first three cross classes share a table
constexpr int other_magnitudes = neighbour_classes + size_classes;
constexpr int magnitude_tables =
    other_magnitudes + neighbour_classes / 2 * magnitude_crosses + size_classes;
// `neighbours` is the neighbour class, or the size class for DC.
constexpr int magnitude_table(bool copies, int quantiser, int plane_class, bool dc, int neighbours,
                              int cross) {
    const int first = (copies * quantisers + quantiser) * magnitude_tables;
    if (plane_class == 0)
        return first + (dc ? neighbour_classes : 0) + neighbours;
    return first + other_magnitudes +
           (dc ? neighbour_classes / 2 * magnitude_crosses + neighbours
               : neighbours / 2 * magnitude_crosses + std::max(cross - 2, 0));
}

// The symbols of a block's colour.
constexpr int colour_plain = 0, colour_as_before = 1, colour_rotated = 2, colour_from_luma = 3;
constexpr int colour_kinds = 4;
constexpr int colour_contexts = 3;      // the last block: plain, rotated, predicted
constexpr int correction_contexts = 21; // neighbours 0..6, times 3 for the channel before
constexpr int correction_tokens = magnitude_tokens + 1; // 0, then the tokens of magnitudes
constexpr int correction_chain = magnitude_chain + 1;

// The index of the first parameter of each group, in the order of the file, and the number of all
// parameters.
constexpr int zero_parameters =
    copy_classes * quantisers * (1 + cross_classes) * zero_positions * neighbour_classes;
constexpr int magnitude_offset = zero_parameters;
constexpr int all_magnitude_tables = copy_classes * quantisers * magnitude_tables;
constexpr int magnitude_parameters = all_magnitude_tables * magnitude_chain;
constexpr int first_length_offset = magnitude_offset + magnitude_parameters;
constexpr int first_length_parameters = length_contexts * (length_tokens - 1);
constexpr int other_length_offset = first_length_offset + first_length_parameters;
constexpr int other_length_parameters = length_tokens * (length_tokens - 1);
constexpr int split_offset = other_length_offset + other_length_parameters;
constexpr int split_parameters = depth_classes * depth_classes * (split_kinds - 1);
constexpr int correction_offset = split_offset + split_parameters;
constexpr int correction_parameters = correction_contexts * correction_chain;
constexpr int colour_offset = correction_offset + correction_parameters;
// One set after a plain block, one after a rotated block.
constexpr int colour_parameters = colour_contexts * (colour_kinds - 1);
constexpr int share_tokens = 9; // bit length of the magnitude of a difference
constexpr int share_offset = colour_offset + colour_parameters;
constexpr int share_parameters = 2 * (share_tokens - 1);
constexpr int prediction_kinds = 3;     // nothing, along s, along t (see format/tile/prediction.h)
constexpr int prediction_contexts = 6;  // earlier views along s, t, both; times the block before
constexpr int displacement_kinds = 3;   // the last one, the one before it, a new one
constexpr int displacement_tokens = 9;  // bit length of the magnitude of a difference, 0..255
constexpr int displacement_classes = 2; // along the parallax, across it
constexpr int prediction_offset = share_offset + share_parameters;
constexpr int prediction_parameters = prediction_contexts * (prediction_kinds - 1);
constexpr int displacement_kind_offset = prediction_offset + prediction_parameters;
constexpr int displacement_kind_parameters = 2 * (displacement_kinds - 1);
constexpr int displacement_offset = displacement_kind_offset + displacement_kind_parameters;
constexpr int displacement_parameters = displacement_classes * (displacement_tokens - 1);
constexpr int base_offset = displacement_offset + displacement_parameters;
constexpr int from_base_offset = base_offset + 1;
constexpr int base_displacement_offset = from_base_offset + 2;
constexpr int mode_offset = base_displacement_offset + displacement_tokens - 1;
constexpr int mode_symbols = 6;  // see ModeMemory in format/tile/border_mode.h
constexpr int mode_contexts = 9; // kinds of the modes above and to the left
constexpr int transform_offset = mode_offset + mode_contexts * (mode_symbols - 1);
constexpr int transform_kinds = 7;       // see BlockTransform in format/tile/block_transform.h
constexpr int usual_transform_kinds = 4; // those that do not leave out a transform
constexpr int transform_contexts = 12;   // four sizes of the block, times three kinds of its mode
constexpr int usual_transform_chain = usual_transform_kinds - 1;
constexpr int no_transform_chain = transform_kinds - usual_transform_kinds;
constexpr int no_transform_offset = transform_offset + transform_contexts * usual_transform_chain;
constexpr int parameter_count = no_transform_offset + transform_contexts * no_transform_chain;
// The parameter that decides whether a transform symbol is `kind` or a later one.
constexpr int transform_parameter(int context, int kind) {
    return kind < usual_transform_chain
               ? transform_offset + context * usual_transform_chain + kind
               : no_transform_offset + context * no_transform_chain + kind - usual_transform_chain;
}

// A value per parameter. They are on the heap, because functions return structures that hold them,
// and the stack of a caller's thread may be small.
class Parameters {
public:
    using Values = std::array<std::uint8_t, parameter_count>;

    Parameters() : values_(parameter_count) {}
    explicit Parameters(const Values& values) : values_(values.begin(), values.end()) {}

    std::uint8_t& operator[](std::size_t i) { return values_[i]; }
    std::uint8_t operator[](std::size_t i) const { return values_[i]; }
    static constexpr std::size_t size() { return parameter_count; }
    const std::uint8_t* data() const { return values_.data(); }
    auto begin() { return values_.begin(); }
    auto end() { return values_.end(); }
    auto begin() const { return values_.begin(); }
    auto end() const { return values_.end(); }
    bool operator==(const Parameters&) const = default;

private:
    std::vector<std::uint8_t> values_;
};

// In these groups, the second half of the parameters is for blocks that copy, in the order of the
// first half.
struct ParameterGroup {
    int offset, count;
};
constexpr ParameterGroup groups_with_copies[] = {{0, zero_parameters},
                                                 {magnitude_offset, magnitude_parameters},
                                                 {first_length_offset, first_length_parameters}};

// Whether only files with predictions store a parameter.
constexpr bool is_of_copies(int parameter) {
    for (const auto& [offset, count] : groups_with_copies)
        if (parameter >= offset + count / 2 && parameter < offset + count)
            return true;
    return parameter >= prediction_offset;
}

// Whether only files with base pictures store a parameter.
constexpr bool is_of_bases(int parameter) {
    return parameter >= base_offset && parameter < mode_offset;
}

// The index of the parameter of a zero flag. `cross` matters only in plane class 1. `neighbours` is
// the neighbour class, or the size class for DC.
constexpr int zero_parameter(bool copies, int quantiser, int plane_class, int position,
                             int neighbours, int cross) {
    const int row = (copies * quantisers + quantiser) * (1 + cross_classes) +
                    (plane_class == 0 ? 0 : 1 + cross);
    return (row * zero_positions + position) * neighbour_classes + neighbours;
}

// A table for symbols of an alphabet: symbol i has the range start[i] .. start[i + 1] - 1 of
// 0..4095.
template <int symbols> struct SymbolTable {
    std::array<std::uint16_t, symbols + 1> start{};

    template <class Coder> void encode(Coder& coder, int symbol) const {
        coder.put(start[symbol], start[symbol + 1] - start[symbol]);
    }
    int decode(RansDecoder& decoder) const {
        const std::uint32_t slot = decoder.slot();
        int symbol = 0;
        while (slot >= start[symbol + 1]) // ends, because the last start is above all slots
            ++symbol;
        decoder.consume(start[symbol], start[symbol + 1] - start[symbol]);
        return symbol;
    }
};

// Decodes a difference whose token is the bit length of its magnitude.
template <int symbols> int decode_difference(RansDecoder& rans, const SymbolTable<symbols>& table) {
    const int token = table.decode(rans);
    if (token == 0)
        return 0;
    const int magnitude = (1 << (token - 1)) + static_cast<int>(rans.raw(token - 1));
    return rans.raw(1) != 0 ? -magnitude : magnitude;
}

// The tables of all symbols, computed from the parameters. Immutable, so thread-safe.
struct CodeTables {
    // leaves_out: transform symbols may be those that leave out a transform.
    explicit CodeTables(const Parameters& parameters, bool leaves_out = true);

    std::array<std::uint16_t, zero_parameters> zero; // frequency of a coefficient of 0
    std::array<SymbolTable<magnitude_tokens>, all_magnitude_tables> magnitude;
    std::array<SymbolTable<length_tokens>, length_contexts> first_length;
    std::array<SymbolTable<length_tokens>, length_tokens> other_length;
    std::array<std::array<SymbolTable<split_kinds>, depth_classes>, depth_classes> split;
    std::array<SymbolTable<correction_tokens>, correction_contexts> correction;
    std::array<SymbolTable<colour_kinds>, colour_contexts> colour;
    std::array<SymbolTable<share_tokens>, 2> share; // of Co, of Cg
    std::array<SymbolTable<prediction_kinds>, prediction_contexts> prediction;
    std::array<SymbolTable<displacement_kinds>, 2> displacement_kind; // [along s, along t]
    std::array<SymbolTable<displacement_tokens>, displacement_classes> displacement;
    SymbolTable<2> base; // whether a tile has a base picture
    // Whether a block copies the base picture; [the block before copies it].
    std::array<SymbolTable<2>, 2> from_base;
    SymbolTable<displacement_tokens> base_displacement;
    std::array<SymbolTable<mode_symbols>, mode_contexts> mode;
    std::array<SymbolTable<transform_kinds>, transform_contexts> transform;
};

// The built-in defaults (FORMAT.md 3.5): for textures of many views, and for single pictures, whose
// coefficients are denser. A file stores only its differences from one of them.
enum class DefaultSet : std::uint8_t { views, pictures };
const Parameters& default_parameters(DefaultSet set = DefaultSet::views);

} // namespace tessera
