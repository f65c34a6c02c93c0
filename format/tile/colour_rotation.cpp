#include "format/tile/colour_rotation.h"

#include <cmath>
#include <cstdlib>
#include <vector>

namespace tessera {
namespace {

using Vector = std::array<double, 3>;

Vector normalised(const Vector& v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::vector<std::array<int, 3>> make_directions() {
    std::vector<std::array<int, 3>> directions;
    for (int r = 0; r <= 2; ++r)
        for (int g = -2; g <= 2; ++g)
            for (int b = -2; b <= 2; ++b) {
                const int first = r != 0 ? r : g != 0 ? g : b;
                const bool primitive = (r | g | b) % 2 != 0; // not all even
                if (first > 0 && primitive)
                    directions.push_back({r, g, b});
            }
    return directions;
}

std::vector<RotationMatrix> make_matrices() {
    std::vector<RotationMatrix> matrices;
    for (int index = 0; index < rotation_count; ++index) {
        const auto axes = rotation_axes(index);
        RotationMatrix matrix;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [r, g, b] = axes[i];
            const Vector planes = {(r + 2 * g + b) / 4, r - b, g - (r + b) / 2};
            for (std::size_t plane = 0; plane < 3; ++plane)
                matrix[plane][i] = static_cast<std::int32_t>(
                    std::lround(std::ldexp(planes[plane], rotation_bits)));
        }
        matrices.push_back(matrix);
    }
    return matrices;
}

} // namespace

std::array<int, 3> rotation_direction(int index) {
    static const auto directions = make_directions();
    return directions[static_cast<std::size_t>(index)];
}

std::array<std::array<double, 3>, 3> rotation_axes(int index) {
    const auto d = rotation_direction(index);
    // The second axis is perpendicular to the first, and to the coordinate axis that is least
    // parallel to the first.
    std::size_t least = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (std::abs(d[i]) < std::abs(d[least]))
            least = i;
    Vector unit{};
    unit[least] = 1;
    const Vector a = normalised({double(d[0]), double(d[1]), double(d[2])});
    const Vector b = normalised(cross(a, unit));
    return {a, b, cross(a, b)};
}

const RotationMatrix& rotation_matrix(int index) {
    static const auto matrices = make_matrices();
    return matrices[static_cast<std::size_t>(index)];
}

} // namespace tessera
