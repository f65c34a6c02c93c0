#include "format/tile/code_tables.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

std::array<std::uint16_t, parameter_count_of_odds> make_frequencies() {
    std::array<std::uint16_t, parameter_count_of_odds> table{};
    for (int p = 0; p < parameter_count_of_odds; ++p)
        table[static_cast<std::size_t>(p)] = static_cast<std::uint16_t>(
            std::clamp(std::lround(4096.0 / (1.0 + std::exp2((p - 32) / 3.0))), 1L, 4095L));
    return table;
}

// Each symbol takes the share of the remaining frequency that its parameter gives, but at least 1,
// and leaves at least 1 for each symbol after it.
template <int symbols>
void build(SymbolTable<symbols>& table, const std::uint8_t* chain, int chain_length) {
    std::uint32_t start = 0;
    for (int symbol = 0; symbol + 1 < symbols; ++symbol) {
        table.start[static_cast<std::size_t>(symbol)] = static_cast<std::uint16_t>(start);
        const std::uint32_t left = probability_total - start;
        const std::uint32_t later = static_cast<std::uint32_t>(symbols - 1 - symbol);
        const std::uint32_t share =
            (left * stop_frequency(chain[std::min(symbol, chain_length - 1)])) >> probability_bits;
        start += std::clamp(share, 1u, left - later);
    }
    table.start[symbols - 1] = static_cast<std::uint16_t>(start);
    table.start[symbols] = probability_total;
}

// The last symbols have no share where no transform is left out, so they never occur.
void build_transform(const Parameters& parameters, bool leaves_out, int context,
                     SymbolTable<transform_kinds>& table) {
    std::array<std::uint8_t, transform_kinds - 1> chain{};
    for (int kind = 0; kind + 1 < transform_kinds; ++kind)
        chain[static_cast<std::size_t>(kind)] =
            parameters[static_cast<std::size_t>(transform_parameter(context, kind))];
    if (leaves_out)
        return build(table, chain.data(), transform_kinds - 1);
    SymbolTable<usual_transform_kinds> usual;
    build(usual, chain.data(), usual_transform_chain);
    table.start.fill(probability_total);
    std::ranges::copy(usual.start, table.start.begin());
}

} // namespace

std::uint32_t stop_frequency(std::uint8_t parameter) {
    static const auto frequencies = make_frequencies();
    return frequencies[parameter & (parameter_count_of_odds - 1)];
}

CodeTables::CodeTables(const Parameters& parameters, bool leaves_out) {
    for (int i = 0; i < zero_parameters; ++i)
        zero[static_cast<std::size_t>(i)] =
            static_cast<std::uint16_t>(stop_frequency(parameters[i]));
    const std::uint8_t* next = parameters.data() + magnitude_offset;
    const auto build_next = [&next](auto& tables, int chain_length) {
        for (auto& table : tables) {
            build(table, next, chain_length);
            next += chain_length;
        }
    };
    build_next(magnitude, magnitude_chain);
    build_next(first_length, length_tokens - 1);
    build_next(other_length, length_tokens - 1);
    for (auto& row : split)
        build_next(row, split_kinds - 1);
    build_next(correction, correction_chain);
    build_next(colour, colour_kinds - 1);
    build_next(share, share_tokens - 1);
    build_next(prediction, prediction_kinds - 1);
    build_next(displacement_kind, displacement_kinds - 1);
    build_next(displacement, displacement_tokens - 1);
    build(base, parameters.data() + base_offset, 1);
    next = parameters.data() + from_base_offset;
    build_next(from_base, 1);
    build(base_displacement, next, displacement_tokens - 1);
    next += displacement_tokens - 1;
    build_next(mode, mode_symbols - 1);
    for (int context = 0; context < transform_contexts; ++context)
        build_transform(parameters, leaves_out, context,
                        transform[static_cast<std::size_t>(context)]);
}

} // namespace tessera
