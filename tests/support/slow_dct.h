// The transform in double precision, computed from its definition.
#pragma once

#include "format/tile/block.h"
#include "format/tile/limits.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tessera::test {

// The orthonormal DCT-II matrix: matrix[k * n + x].
inline const std::vector<double>& dct_matrix(int n) {
    static std::array<std::vector<double>, max_block_side + 1> matrices;
    std::vector<double>& matrix = matrices[static_cast<std::size_t>(n)];
    for (int k = 0; k < n && static_cast<int>(matrix.size()) < n * n; ++k)
        for (int x = 0; x < n; ++x)
            matrix.push_back(std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n)) *
                             std::sqrt((k == 0 ? 1.0 : 2.0) / n));
    return matrix;
}

// One pass along an axis of an array with u fastest, in place.
inline void slow_dct_axis(std::vector<double>& x, const BlockShape& shape, int axis, bool inverse) {
    const std::size_t n = shape.n[static_cast<std::size_t>(axis)];
    std::size_t inner = 1;
    for (int a = 0; a < axis; ++a)
        inner *= shape.n[static_cast<std::size_t>(a)];
    const std::vector<double>& matrix = dct_matrix(static_cast<int>(n));
    const std::size_t row = inverse ? 1 : n, column = inverse ? n : 1;
    std::vector<double> line(n);
    for (std::size_t block = 0; block < x.size(); block += inner * n)
        for (std::size_t i = 0; i < inner; ++i) {
            double* const first = x.data() + block + i;
            for (std::size_t b = 0; b < n; ++b)
                line[b] = first[b * inner];
            for (std::size_t a = 0; a < n; ++a) {
                const double* weight = matrix.data() + a * row;
                double sum = 0;
                for (const double value : line) {
                    sum += *weight * value;
                    weight += column;
                }
                first[a * inner] = sum;
            }
        }
}

inline void slow_dct(std::vector<double>& x, const BlockShape& shape, bool inverse) {
    for (int axis = 0; axis < 4; ++axis)
        if (shape.n[static_cast<std::size_t>(axis)] > 1)
            slow_dct_axis(x, shape, axis, inverse);
}

} // namespace tessera::test
