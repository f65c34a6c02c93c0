// Transforms of whole blocks, for the tests of the kernels.
#pragma once

#include "codec/kernels/kernels.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <cmath>

namespace tessera::test::transforms {

inline const std::vector<BlockShape> shapes_4d = {
    shape_of(32, 32, 8, 8), shape_of(32, 32, 4, 4), shape_of(16, 16, 4, 4), shape_of(8, 8, 8, 8),
    shape_of(4, 4, 1, 1),   shape_of(7, 5, 3, 2),   shape_of(17, 9, 5, 3),  shape_of(1, 1, 8, 8),
    shape_of(2, 2, 2, 2),   shape_of(5, 1, 31, 6)};

// The number of coded frequencies along an axis.
inline int coded(const BlockShape& shape, std::size_t axis) {
    return std::min<int>(shape.n[axis], max_frequencies);
}

// Calls visit(index) for every coded frequency of a block, u fastest.
template <class Visit> void for_each_coded(const BlockShape& shape, Visit visit) {
    const auto& n = shape.n;
    for (int t = 0; t < coded(shape, 3); ++t)
        for (int s = 0; s < coded(shape, 2); ++s)
            for (int v = 0; v < coded(shape, 1); ++v)
                for (int u = 0; u < coded(shape, 0); ++u)
                    visit(static_cast<std::size_t>(((t * n[2] + s) * n[1] + v) * n[0] + u));
}

// Runs the passes of FORMAT.md 4.3 on a block with all coded frequencies, with the kernels.
inline std::vector<std::int32_t> inverse_by_kernels(const std::vector<std::int32_t>& block,
                                                    const BlockShape& shape) {
    std::vector<std::int32_t> x(block.size()), y(block.size());
    const auto& n = shape.n;
    const Kernels& k = kernels();
    int rows = coded(shape, 1) * coded(shape, 2) * coded(shape, 3);
    // The first pass reads its axis as the outermost one.
    int next = 0;
    for_each_coded(shape, [&](std::size_t i) {
        x[static_cast<std::size_t>(next % coded(shape, 0) * rows + next / coded(shape, 0))] =
            block[i];
        ++next;
    });
    if (n[0] > 1) {
        k.inverse_rows(x.data(), y.data(), rows, coded(shape, 0), n[0]);
        x.swap(y);
    }
    int inner = n[0];
    for (std::size_t axis = 1; axis < 4; ++axis) {
        rows /= coded(shape, axis);
        for (int o = 0; n[axis] > 1 && o < rows; ++o)
            k.inverse_planes(x.data() + o * coded(shape, axis) * inner,
                             y.data() + o * n[axis] * inner, coded(shape, axis), n[axis], inner);
        if (n[axis] > 1)
            x.swap(y);
        inner *= n[axis];
    }
    return x;
}

// Fixed-point coefficients in the scale of the dequantiser (FORMAT.md 4.1), but exact: the bound is
// on the error of the transform alone, so the rounding of the scales to 11 bits is left out.
inline std::vector<std::int32_t> exact_fixed_point(const std::vector<double>& x,
                                                   const BlockShape& shape) {
    const auto& n = shape.n;
    const double scale =
        std::ldexp(1.0, fraction_bits(SampleType::unorm8)) / std::sqrt(shape.texels());
    std::vector<std::int32_t> fixed;
    for (int i = 0; i < shape.texels(); ++i) {
        const int axes = (i % n[0] > 0) + (i / n[0] % n[1] > 0) + (i / (n[0] * n[1]) % n[2] > 0) +
                         (i / (n[0] * n[1] * n[2]) > 0);
        fixed.push_back(static_cast<std::int32_t>(
            std::lround(x[static_cast<std::size_t>(i)] * scale * std::pow(2.0, axes / 2.0))));
    }
    return fixed;
}

inline std::vector<float> random_floats(Random& random, int count, double amplitude) {
    std::vector<float> x(static_cast<std::size_t>(count));
    for (float& value : x)
        value = static_cast<float>((random.unit() * 2 - 1) * amplitude);
    return x;
}

} // namespace tessera::test::transforms
