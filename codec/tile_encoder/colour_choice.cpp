#include "codec/tile_encoder/colour_choice.h"

#include "codec/search_kernels/search_kernels.h"
#include "format/tile/colour_rotation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace tessera {
namespace {

using Vector = std::array<float, 3>;

// Inverse of Y = (R + 2G + B) / 4, Co = R - B, Cg = G - (R + B) / 2.
Vector rgb_of(float y, float co, float cg) {
    return {y + (co - cg) / 2, y + cg / 2, y - (co + cg) / 2};
}

using Axes = std::array<Vector, 3>;

const std::array<Axes, rotation_count>& all_axes() {
    static const auto axes = [] {
        std::array<Axes, rotation_count> result;
        for (int i = 0; i < rotation_count; ++i) {
            const auto exact = rotation_axes(i);
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t c = 0; c < 3; ++c)
                    result[i][a][c] = static_cast<float>(exact[a][c]);
        }
        return result;
    }();
    return axes;
}

// First axes of all rotations by component, for vectors.
using FirstAxes = std::array<std::array<float, rotation_count>, 3>;
const FirstAxes& first_axes() {
    static const auto first = [] {
        FirstAxes result;
        for (std::size_t i = 0; i < rotation_count; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                result[c][i] = all_axes()[i][0][c];
        return result;
    }();
    return first;
}

} // namespace

ColourMoments kept_moments(const ColourCoefficients& block, const CodingParameters& parameters) {
    ColourMoments moments{};
    const float threshold = 0.6f * static_cast<float>(parameters.rotated_step.value());
    const float least = threshold * threshold;
    // Rows of the moments.
    typedef float Row __attribute__((vector_size(16)));
    std::array<Row, 3> sums{};
    const auto add = [&](std::size_t i) {
        const Vector x = rgb_of(block.plane[0][i], block.plane[1][i], block.plane[2][i]);
        const Row row{x[0], x[1], x[2]};
        for (std::size_t a = 0; a < 3; ++a)
            sums[a] += row * x[a];
    };
    constexpr std::size_t at_once = 64;
    const auto& [y, co, cg] = block.plane;
    for (std::size_t begin = 0; begin < block.count; begin += at_once) {
        const auto n = static_cast<int>(std::min(at_once, block.count - begin));
        std::uint64_t kept =
            search_kernels().long_colours(y + begin, co + begin, cg + begin, n, least);
        for (; kept != 0; kept &= kept - 1)
            add(begin + std::countr_zero(kept));
    }
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
            moments[a][b] = sums[a][b];
    return moments;
}

int choose_rotation(const ColourMoments& moments, int last) {
    const FirstAxes& d = first_axes();
    std::array<float, rotation_count> energy;
    for (std::size_t i = 0; i < rotation_count; ++i) {
        const auto along = [&](std::size_t row) {
            return moments[row][0] * d[0][i] + moments[row][1] * d[1][i] +
                   moments[row][2] * d[2][i];
        };
        energy[i] = d[0][i] * along(0) + d[1][i] * along(1) + d[2][i] * along(2);
    }
    int best = -1;
    float most = 0;
    for (int i = 0; i < rotation_count; ++i)
        if (energy[i] > most) {
            most = energy[i];
            best = i;
        }
    const float total = moments[0][0] + moments[1][1] + moments[2][2];
    if (best >= 0 && last >= 0 && total - energy[last] < 1.1f * (total - most))
        return last;
    return best;
}

void project_colours(const ColourCoefficients& block, int rotation, std::size_t axis, float* out) {
    const Vector& d = all_axes()[rotation][axis];
    // The contribution of each plane along the axis, by rgb_of.
    const float y = d[0] + d[1] + d[2], co = (d[0] - d[2]) / 2, cg = (d[1] - d[0] - d[2]) / 2;
    for (std::size_t i = 0; i < block.count; ++i)
        out[i] = y * block.plane[0][i] + co * block.plane[1][i] + cg * block.plane[2][i];
}

void rotate_colours(const BlockCoefficients& block, int rotation, BlockCoefficients& out) {
    const auto count = static_cast<std::size_t>(block.shape.texels());
    out.shape = block.shape;
    out.copies = block.copies;
    out.is_predicted = block.is_predicted;
    out.fineness = block.fineness;
    out.colour = {.rotation = static_cast<std::uint8_t>(rotation + 1), .share = {}};
    out.is_blank = block.is_blank;
    std::fill_n(out.is_blank.begin(), 3, false);
    for (std::size_t plane = 0; plane < 3; ++plane) {
        out.plane[plane].resize(count);
        project_colours(
            {{block.plane[0].data(), block.plane[1].data(), block.plane[2].data()}, count},
            rotation, plane, out.plane[plane].data());
    }
    for (std::size_t plane = 3; plane < out.plane.size(); ++plane)
        out.plane[plane] = block.plane[plane];
}

} // namespace tessera
