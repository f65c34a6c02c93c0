// Conversion of levels to values, codes and samples (FORMAT.md 4.1 to 4.5).
#pragma once

#include "tests/reference/spec_code.h"

#include <algorithm>
#include <array>
#include <vector>

namespace tessera_reference::spec {

using Vector4 = std::array<int, 4>; // u, v, s, t

inline int product(const Vector4& n) {
    return n[0] * n[1] * n[2] * n[3];
}

// ((t * ns + s) * nv + v) * nu + u
inline size_t place(const Vector4& at, const Vector4& n) {
    return static_cast<size_t>(((at[3] * n[2] + at[2]) * n[1] + at[1]) * n[0] + at[0]);
}

// The number of coded frequencies along an axis of n texels.
inline int coded_frequencies(int n) {
    return std::min(n, 32);
}

// Calls visit for every position in a tile or block.
template <class Visit> void for_each_place(const Vector4& size, Visit visit) {
    Vector4 at{};
    for (at[3] = 0; at[3] < size[3]; ++at[3])
        for (at[2] = 0; at[2] < size[2]; ++at[2])
            for (at[1] = 0; at[1] < size[1]; ++at[1])
                for (at[0] = 0; at[0] < size[0]; ++at[0])
                    visit(at);
}

// The scale M, x for coefficients with that z of 4.1.
struct Scale {
    int64_t M = 0;
    int x = 0;
};

Scale make_scale(const Step& step, int N, int z, int F, bool dependent);

int64_t dequantise(int64_t level, const Scale& scale, int offset);

// Transforms `values`, which place() indexes, in four passes and rounds them. The results are in
// units of 2^-(F - bits) of a code.
enum class AxisTransform { cosines, sines, none };
void inverse_transform(std::vector<int64_t>& values, const Vector4& n,
                       const std::array<AxisTransform, 4>& transforms, int bits);

using Matrix = std::array<std::array<int64_t, 3>, 3>; // [row][column]

// The 49 rotations in ascending lexicographic order.
std::vector<Matrix> make_rotations();

// The matrix of a block whose Co and Cg are predicted from luma with the shares a and b.
Matrix shares_matrix(int a, int b);

// Multiplies the coefficients of planes 0, 1, 2 at one frequency by Q.
std::array<int64_t, 3> recolour(const Matrix& Q, const std::array<int64_t, 3>& x);

int64_t code_of(uint16_t sample, int sample_type);

int64_t clamp_code(int64_t code, int sample_type);

uint16_t sample_of(int64_t code, int sample_type);

// Converts the codes of a texel's channels to planes.
std::array<int64_t, 4> to_planes(std::array<int64_t, 4> x, int colour);

std::array<int64_t, 4> from_planes(std::array<int64_t, 4> x, int colour);

} // namespace tessera_reference::spec
