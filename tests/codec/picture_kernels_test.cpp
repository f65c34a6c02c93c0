// The kernels of pictures give the same results on all paths.
#include "codec/kernels/kernels.h"
#include "format/tile/block_colour.h"
#include "format/tile/dequantizer.h"
#include "format/tile/limits.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>
#include <vector>

namespace tessera::test {
namespace {

std::vector<const Kernels*> usable_kernels() {
    std::vector<const Kernels*> paths{&kernels_scalar, &kernels_vector};
    if (avx2_available())
        paths.push_back(&kernels_avx2);
    return paths;
}

// Within -limit .. limit.
std::vector<std::int32_t> integers_within(Random& random, int limit, int count) {
    std::vector<std::int32_t> values(static_cast<std::size_t>(count));
    for (std::int32_t& x : values)
        x = random.range(-limit, limit);
    return values;
}

// Chroma from luma is a matrix like that of a rotation.
TEST(PictureKernels, PredictedChromaIsThatOfItsMatrix) {
    Random random(10);
    constexpr std::int32_t one = 1 << rotation_bits;
    for (int share = -most_share; share <= most_share; ++share) {
        const int count = random.range(1, 40);
        const std::int32_t weight = share * (one >> share_bits[random.range(0, 1)]);
        std::vector<std::int32_t> luma = integers_within(random, coefficient_limit, count);
        const std::vector<std::int32_t> chroma = integers_within(random, coefficient_limit, count);
        luma[0] = random.chance(0.5) ? coefficient_limit : -coefficient_limit;
        auto by_matrix = chroma, zero = std::vector<std::int32_t>(chroma.size()), same = luma;
        std::int32_t* const planes[3] = {same.data(), by_matrix.data(), zero.data()};
        const RotationMatrix matrix{{{one, 0, 0}, {weight, one, 0}, {0, 0, one}}};
        kernels_scalar.unrotate(planes, count, matrix);
        ASSERT_EQ(same, luma) << share;
        for (const Kernels* path : usable_kernels()) {
            auto got = chroma;
            path->add_luma(luma.data(), count, weight, got.data());
            ASSERT_EQ(got, by_matrix) << path->name << " " << share;
        }
    }
}

TEST(PictureKernels, PlanesBetweenBordersAreCorrect) {
    Random random(12);
    for (int nu = 1; nu <= max_block_side; ++nu)
        for (const int nv : {1, 2, 3, 7, 8, 33, max_block_side}) {
            const auto top = integers_within(random, 1 << 18, nu + 1);
            const auto left = integers_within(random, 1 << 18, nv + 1);
            const auto at = [](const auto& side, int i) {
                return side[static_cast<std::size_t>(i)];
            };
            std::vector<std::int32_t> right;
            for (int y = 0; y < nv; ++y)
                for (int x = 0; x < nu; ++x) {
                    const int a = 64 * (x + 1) / nu, b = 64 * (y + 1) / nv;
                    right.push_back(((64 - a) * at(left, y) + a * at(top, nu) +
                                     (64 - b) * at(top, x) + b * at(left, nv) + 64) >>
                                    7);
                }
            for (const Kernels* path : usable_kernels()) {
                std::vector<std::int32_t> got(right.size());
                path->continue_both(top.data(), left.data(), nu, nv, got.data());
                ASSERT_EQ(got, right) << path->name << " " << nu << "x" << nv;
            }
        }
}

} // namespace
} // namespace tessera::test
