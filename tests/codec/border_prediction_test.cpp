// Prediction of blocks from their border.
#include "codec/reconstruct/border_prediction.h"
#include "format/tile/dequantizer.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

// A picture of side x side texels with the value f(u, v) at each. What lies above a block and to its
// left is decoded.
class TestPicture {
public:
    template <class Function>
    TestPicture(int side, Function f) : shape_(shape_of(side, side, 1, 1)) {
        for (int v = 0; v < side; ++v)
            for (int u = 0; u < side; ++u)
                plane_.push_back(f(u, v));
    }
    static Block block(int u, int v, int nu, int nv) {
        return {{static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 0, 0},
                shape_of(nu, nv, 1, 1)};
    }
    // Declares rows 0..v - 1 decoded up to column `width`, and columns 0..u - 1 of the rows from v
    // on up to row `height`.
    void decode(int u, int v, int width, int height) {
        done_.reset();
        if (v > 0)
            done_.add(block(0, 0, width, v));
        if (u > 0)
            done_.add(block(0, v, u, height - v));
    }
    std::vector<std::int32_t> predict(const Block& block, int mode) const {
        std::vector<std::int32_t> out(static_cast<std::size_t>(block.shape.texels()));
        BlockBorder(block, shape_, border_reach(block, shape_, done_), plane_)
            .predict(static_cast<BorderMode>(mode), out.data());
        return out;
    }
    // As above, with all that may precede the block decoded.
    std::vector<std::int32_t> predict(int u, int v, int nu, int nv, int mode) {
        decode(u, v, shape_.n[0], shape_.n[1]);
        return predict(block(u, v, nu, nv), mode);
    }

private:
    BlockShape shape_;
    std::vector<std::int32_t> plane_;
    DecodedRegion done_;
};

TEST(BorderPrediction, EveryModeContinuesAConstant) {
    for (const int value : {0, 1, -1, 1234, -262144, 262143})
        for (const auto& [u, v] : {std::pair{32, 32}, {0, 32}, {32, 0}})
            for (const auto& [nu, nv] : {std::pair{8, 8}, {1, 1}, {16, 2}, {3, 32}, {5, 7}}) {
                TestPicture picture(64, [&](int, int) { return value; });
                for (int mode = 1; mode < border_mode_count; ++mode)
                    for (const std::int32_t x : picture.predict(u, v, nu, nv, mode))
                        ASSERT_EQ(x, value) << "mode " << mode << " at " << u << ", " << v;
            }
}

TEST(BorderPrediction, IsZeroWithoutABorder) {
    TestPicture picture(32, [](int, int) { return 77; });
    for (int mode = 1; mode < border_mode_count; ++mode)
        for (const std::int32_t x : picture.predict(0, 0, 8, 5, mode))
            ASSERT_EQ(x, 0) << mode;
}

TEST(BorderPrediction, MeanOfTheTexelsThatTouchTheBlock) {
    // Texels beyond the block's own columns and rows do not count.
    TestPicture picture(32, [](int u, int v) { return u >= 12 || v >= 12 ? 9999 : u + 100 * v; });
    const auto mean = [&](int u, int v) { return picture.predict(u, v, 4, 4, mode_mean)[0]; };
    // The row above has u = 8..11 at v = 7, the column to the left v = 8..11 at u = 7.
    EXPECT_EQ(mean(8, 8), (4 * 700 + 38 + 4 * 7 + 3800) / 8);
    EXPECT_EQ(mean(8, 0), 7 + 100 * 6 / 4);
    EXPECT_EQ(mean(0, 8), 700 + 6 / 4);
    TestPicture negative(8, [](int u, int) { return -u; });
    EXPECT_EQ(negative.predict(0, 4, 2, 2, mode_mean)[0], -1); // floor of -1 / 2
    EXPECT_EQ(negative.predict(4, 4, 1, 2, mode_mean)[0], -4); // floor of (-4 - 3 - 3) / 3
}

TEST(BorderPrediction, PlanarOfADiagonalRamp) {
    // The two ramps of the planar mode rise by 1/16 more than this picture.
    TestPicture picture(64, [](int u, int v) { return 16 * (u - v); });
    const auto predicted = picture.predict(16, 16, 8, 8, mode_planar);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_EQ(predicted[static_cast<std::size_t>(8 * y + x)], 17 * (x - y));
}

TEST(BorderPrediction, PlanarEndsInTheMeanOfTheFarTexels) {
    TestPicture picture(64, [](int u, int v) { return 3 * u * u - 5 * v; });
    for (const auto& [nu, nv] : {std::pair{8, 8}, {5, 11}, {1, 16}}) {
        const int right = 3 * (16 + nu) * (16 + nu) - 5 * 15, below = 3 * 15 * 15 - 5 * (16 + nv);
        EXPECT_EQ(picture.predict(16, 16, nu, nv, mode_planar).back(), (right + below + 1) >> 1);
    }
}

// A picture that is constant along a direction and linear across it is continued exactly. Where a
// direction reaches the other border, it takes the nearest texel there.
TEST(BorderPrediction, DirectionsContinueRamps) {
    for (int k = 0; k < border_directions; ++k)
        for (const auto& [nu, nv] : {std::pair{8, 8}, {16, 16}, {4, 16}, {16, 4}, {5, 3}, {1, 1}}) {
            const int slope = direction_slope(k);
            const bool upper = k >= first_upper_direction;
            const auto f = [&](int u, int v) {
                return upper ? 32 * u + slope * v : 32 * v + slope * u;
            };
            TestPicture picture(64, f);
            const auto predicted = picture.predict(20, 24, nu, nv, mode_first_direction + k);
            for (int y = 0; y < nv; ++y)
                for (int x = 0; x < nu; ++x) {
                    const int along = upper ? x : y, away = upper ? y : x;
                    const bool at_other = along + 1 + ((away + 1) * slope >> 5) < 0;
                    const int error =
                        predicted[static_cast<std::size_t>(nu * y + x)] - f(20 + x, 24 + y);
                    ASSERT_LE(std::abs(error), at_other ? (std::abs(slope) + 1) / 2 : 0)
                        << "direction " << k << " of " << nu << " x " << nv << " at " << x << ", "
                        << y;
                }
        }
}

TEST(BorderPrediction, StraightDirectionsRepeatTheBorder) {
    Random random(3);
    TestPicture picture(64, [&](int, int) { return random.range(-1000, 1000); });
    const Block block = TestPicture::block(10, 12, 6, 5);
    picture.decode(10, 12, 64, 64);
    const auto down = picture.predict(block, mode_vertical);
    const auto across = picture.predict(block, mode_horizontal);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 6; ++x) {
            const auto i = static_cast<std::size_t>(6 * y + x);
            EXPECT_EQ(down[i], down[static_cast<std::size_t>(x)]);
            EXPECT_EQ(across[i], across[static_cast<std::size_t>(6 * y)]);
        }
    EXPECT_NE(down[0], down[1]);
    EXPECT_NE(across[0], across[6]);
}

// Direction 16 runs from the corner between the borders down the diagonal.
TEST(BorderPrediction, TheDiagonalBeginsAtTheCorner) {
    TestPicture picture(32, [](int u, int v) { return u == 7 && v == 7 ? 5 : 0; });
    const auto predicted = picture.predict(8, 8, 8, 8, mode_first_direction + 16);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_EQ(predicted[static_cast<std::size_t>(8 * y + x)], x == y ? 5 : 0);
}

TEST(BorderPrediction, OneBorderStandsInForTheOther) {
    TestPicture picture(64, [](int u, int v) { return 1000 + 10 * u + v; });
    // At the upper edge of the picture all texels above are the first one to the left.
    for (const std::int32_t x : picture.predict(16, 0, 8, 8, mode_vertical))
        EXPECT_EQ(x, 1000 + 10 * 15);
    // At its left edge it is the reverse.
    for (const std::int32_t x : picture.predict(0, 16, 8, 8, mode_horizontal))
        EXPECT_EQ(x, 1000 + 15);
    // The diagonal ends in the side that exists, and its corner is that side's first texel.
    const auto at_top = picture.predict(16, 0, 4, 4, mode_first_direction + 16);
    EXPECT_EQ(at_top[0], 1000 + 150);
    EXPECT_EQ(at_top[4 * 3], 1000 + 150 + 2);
    EXPECT_EQ(at_top[3], 1000 + 150);
}

// Texels that are not decoded, or lie outside the picture, repeat the last one that is there.
TEST(BorderPrediction, RepeatsTheLastDecodedTexel) {
    TestPicture picture(64, [](int u, int v) { return 100 * u + v; });
    const Block block = TestPicture::block(16, 16, 8, 8);
    const int up_right = mode_first_direction + 31, down_left = mode_first_direction + 0;
    const auto last = [&](int mode) { return picture.predict(block, mode).back(); };
    picture.decode(16, 16, 64, 64);
    // The last texel looks up to index 8 + 8 * 26 / 32 = 14.5 of the row above.
    EXPECT_EQ(last(up_right), 100 * (16 + 13) + 50 + 15);
    EXPECT_EQ(last(down_left), 1500 + 16 + 15);
    picture.decode(16, 16, 24, 24); // nothing beyond the block's own columns and rows
    EXPECT_EQ(last(up_right), 2300 + 15);
    EXPECT_EQ(last(down_left), 1500 + 23);
    picture.decode(16, 16, 26, 27);
    EXPECT_EQ(last(up_right), 2500 + 15);
    EXPECT_EQ(last(down_left), 1500 + 26);
    // A block in the lower right corner of the picture.
    const auto corner = picture.predict(56, 56, 8, 8, up_right);
    EXPECT_EQ(corner.back(), 6300 + 55);
    EXPECT_EQ(picture.predict(56, 56, 8, 8, down_left).back(), 5500 + 63);
}

// Predictions are weighted means, so none may leave the range of the border.
TEST(BorderPrediction, LargestValuesDoNotOverflow) {
    const std::int32_t limit = value_limit(SampleType::half16);
    Random random(5);
    for (int pattern = 0; pattern < 4; ++pattern) {
        TestPicture picture(192, [&](int u, int v) {
            const bool high = pattern == 0   ? random.chance(0.5)
                              : pattern == 1 ? (u + v) % 2 == 0
                                             : pattern == 2;
            return high ? limit - 1 : -limit;
        });
        for (const auto& [nu, nv] : {std::pair{64, 64}, {64, 1}, {1, 64}, {1, 1}, {63, 33}})
            for (const int origin : {0, 64})
                for (int mode = 1; mode < border_mode_count; ++mode)
                    for (const std::int32_t x : picture.predict(64, origin, nu, nv, mode)) {
                        ASSERT_LE(x, pattern == 3 ? -limit : limit - 1) << mode;
                        ASSERT_GE(x, pattern == 2 ? limit - 1 : -limit) << mode;
                    }
    }
}

} // namespace
} // namespace tessera::test
