#include "codec/tile_encoder/bit_costs.h"

#include "codec/entropy/tile_syntax.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera {
namespace {

std::array<float, probability_total + 1> make_bits() {
    std::array<float, probability_total + 1> all;
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = static_cast<float>(probability_bits - std::log2(static_cast<double>(i)));
    return all;
}

// -log2 of a frequency. Tabulated, because every pass needs thousands.
float bits(std::uint32_t frequency) {
    static const auto all = make_bits();
    return all[frequency];
}

template <int symbols>
void fill(std::array<float, symbols>& costs, const SymbolTable<symbols>& table) {
    for (int i = 0; i < symbols; ++i)
        costs[i] = bits(static_cast<std::uint32_t>(table.start[static_cast<std::size_t>(i) + 1] -
                                                   table.start[i]));
}

void add_length_raw_bits(std::array<float, length_tokens>& costs) {
    for (int token = 0; token < length_tokens; ++token)
        costs[token] += static_cast<float>(length_raw_bits(token));
}

} // namespace

BitCosts::BitCosts(const CodeTables& tables) {
    for (std::size_t i = 0; i < zero.size(); ++i)
        zero[i] = {bits(tables.zero[i]), bits(probability_total - tables.zero[i])};
    for (std::size_t i = 0; i < magnitude.size(); ++i) {
        fill<magnitude_tokens>(magnitude[i], tables.magnitude[i]);
        for (int token = 0; token < magnitude_tokens; ++token)
            magnitude[i][token] += static_cast<float>(1 + std::max(0, token - 3));
    }
    order_by_neighbours();
    for (std::size_t i = 0; i < first_length.size(); ++i) {
        fill<length_tokens>(first_length[i], tables.first_length[i]);
        add_length_raw_bits(first_length[i]);
    }
    for (std::size_t i = 0; i < other_length.size(); ++i) {
        fill<length_tokens>(other_length[i], tables.other_length[i]);
        add_length_raw_bits(other_length[i]);
    }
    for (std::size_t i = 0; i < colour.size(); ++i) {
        fill<colour_kinds>(colour[i], tables.colour[i]);
        colour[i][colour_rotated] += static_cast<float>(rotation_index_bits);
    }
    for (std::size_t i = 0; i < share.size(); ++i) {
        fill<share_tokens>(share[i], tables.share[i]);
        for (std::size_t token = 1; token < share_tokens; ++token)
            share[i][token] += static_cast<float>(token);
    }
    for (std::size_t i = 0; i < mode.size(); ++i) {
        fill<mode_symbols>(mode[i], tables.mode[i]);
        mode[i][ModeMemory::other_direction] += static_cast<float>(direction_bits);
    }
    for (std::size_t i = 0; i < transform.size(); ++i)
        fill<transform_kinds>(transform[i], tables.transform[i]);
    for (std::size_t i = 0; i < prediction.size(); ++i)
        fill<prediction_kinds>(prediction[i], tables.prediction[i]);
    for (std::size_t i = 0; i < displacement_kind.size(); ++i)
        fill<displacement_kinds>(displacement_kind[i], tables.displacement_kind[i]);
    for (std::size_t i = 0; i < displacement.size(); ++i) {
        fill<displacement_tokens>(displacement[i], tables.displacement[i]);
        for (std::size_t token = 1; token < displacement_tokens; ++token)
            displacement[i][token] += static_cast<float>(token);
    }
    for (std::size_t s = 0; s < split.size(); ++s)
        for (std::size_t a = 0; a < split[s].size(); ++a)
            fill<split_kinds>(split[s][a], tables.split[s][a]);
}

void BitCosts::order_by_neighbours() {
    for (int i = 0; i < zero_parameters; ++i)
        for (std::size_t flag = 0; flag < 2; ++flag) {
            const int row = i / neighbour_classes, quantiser = row / flag_rows;
            flags[quantiser / quantisers][quantiser % quantisers][row % flag_rows][flag]
                 [i % neighbour_classes] = zero[i][flag];
        }
    const auto fill_row = [&](bool copies, int quantiser, int p_class, bool dc, int cross) {
        auto& row = tokens[copies][quantiser][token_row(p_class, dc, cross)];
        // DC has size classes instead of neighbour classes.
        for (int c = 0; c < (dc ? size_classes : neighbour_classes); ++c)
            for (int token = 0; token < magnitude_tokens; ++token)
                row[token][c] =
                    magnitude[magnitude_table(copies, quantiser, p_class, dc, c, cross)][token];
    };
    tokens = {};
    for (const bool copies : {false, true})
        for (int quantiser = 0; quantiser < quantisers; ++quantiser) {
            for (int p_class = 0; p_class < plane_classes; ++p_class)
                fill_row(copies, quantiser, p_class, true, 0);
            fill_row(copies, quantiser, 0, false, 0);
            for (int cross = 2; cross < cross_classes; ++cross)
                fill_row(copies, quantiser, 1, false, cross);
        }
}

} // namespace tessera
