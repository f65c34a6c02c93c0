// Tests the rotated colour axes.
#include "format/tile/colour_rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera {
namespace {

TEST(ColourRotation, AxesAreOrthonormalAndRightHanded) {
    for (int index = 0; index < rotation_count; ++index) {
        const auto axes = rotation_axes(index);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& a = axes[i];
            const auto& b = axes[(i + 1) % 3];
            const auto& c = axes[(i + 2) % 3];
            EXPECT_NEAR(a[0] * a[0] + a[1] * a[1] + a[2] * a[2], 1, 1e-12) << index;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t y = (k + 1) % 3, z = (k + 2) % 3;
                EXPECT_NEAR(a[y] * b[z] - a[z] * b[y], c[k], 1e-12) << index;
            }
        }
    }
}

TEST(ColourRotation, DirectionsAscendAndArePrimitive) {
    for (int index = 0; index < rotation_count; ++index) {
        const auto d = rotation_direction(index);
        EXPECT_GT(d, (std::array{0, 0, 0})); // the first nonzero component is positive
        EXPECT_TRUE(((d[0] | d[1] | d[2]) & 1) != 0) << index;
        if (index > 0) {
            EXPECT_LT(rotation_direction(index - 1), d);
        }
        const auto axis = rotation_axes(index)[0];
        const double length = std::hypot(d[0], d[1], d[2]);
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(axis[k], d[k] / length, 1e-12);
    }
}

} // namespace
} // namespace tessera
