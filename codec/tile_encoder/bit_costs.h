// Ideal code lengths in bits under a file's tables, for rate-distortion decisions.
#pragma once

#include "format/tile/code_tables.h"

#include <array>

namespace tessera {

struct BitCosts {
    explicit BitCosts(const CodeTables& tables);

    std::array<std::array<float, 2>, zero_parameters> zero; // [parameter][is non-zero]
    std::array<std::array<float, magnitude_tokens>, all_magnitude_tables>
        magnitude; // with the raw bits of the token and the sign
    std::array<std::array<float, length_tokens>, length_contexts> first_length; // with raw bits
    std::array<std::array<float, length_tokens>, length_tokens> other_length;
    std::array<std::array<std::array<float, split_kinds>, depth_classes>, depth_classes> split;
    std::array<std::array<float, colour_kinds>, 2> colour; // with raw bits
    std::array<std::array<float, prediction_kinds>, prediction_contexts> prediction;
    std::array<std::array<float, displacement_kinds>, 2> displacement_kind;
    std::array<std::array<float, displacement_tokens>, displacement_classes>
        displacement; // with raw bits and sign
};

} // namespace tessera
