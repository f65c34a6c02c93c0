// Ideal code lengths under a file's tables, in bits, for rate-distortion decisions.
#pragma once

#include "format/tile/code_tables.h"

#include <algorithm>
#include <array>

namespace tessera {

struct BitCosts {
    explicit BitCosts(const CodeTables& tables);

    std::array<std::array<float, 2>, zero_parameters> zero; // [parameter][is non-zero]
    // With the raw bits of the token and the sign.
    std::array<std::array<float, magnitude_tokens>, all_magnitude_tables> magnitude;
    // The same by neighbour class last, for TrellisTask, which looks up many classes at once:
    // [copies][quantiser], then rows as flag_row() and token_row() number them.
    template <class Row, int rows>
    using ByQuantiser = std::array<std::array<std::array<Row, rows>, quantisers>, copy_classes>;
    template <int symbols>
    using ByNeighbours = std::array<std::array<float, neighbour_classes>, symbols>;
    static constexpr int flag_rows = (1 + cross_classes) * zero_positions;
    static constexpr int token_rows = 3 + magnitude_crosses;
    ByQuantiser<ByNeighbours<2>, flag_rows> flags;
    ByQuantiser<ByNeighbours<magnitude_tokens>, token_rows> tokens;
    static constexpr int flag_row(int plane_class, int position, int cross) {
        return zero_parameter(false, 0, plane_class, position, 0, cross) / neighbour_classes;
    }
    static constexpr int token_row(int plane_class, bool dc, int cross) {
        return dc ? plane_class : plane_class == 0 ? 2 : 3 + std::max(cross - 2, 0);
    }

    std::array<std::array<float, length_tokens>, length_contexts> first_length; // with raw bits
    std::array<std::array<float, length_tokens>, length_tokens> other_length;
    std::array<std::array<std::array<float, split_kinds>, depth_classes>, depth_classes> split;
    std::array<std::array<float, colour_kinds>, colour_contexts> colour; // with raw bits
    std::array<std::array<float, share_tokens>, 2> share;                // with raw bits and sign
    std::array<std::array<float, mode_symbols>, mode_contexts> mode;     // with raw bits
    std::array<std::array<float, transform_kinds>, transform_contexts> transform;
    std::array<std::array<float, prediction_kinds>, prediction_contexts> prediction;
    std::array<std::array<float, displacement_kinds>, 2> displacement_kind;
    std::array<std::array<float, displacement_tokens>, displacement_classes>
        displacement; // with raw bits and sign

private:
    void order_by_neighbours();
};

} // namespace tessera
