// The values that masked texels get before coding.
#include "codec/metrics.h"
#include "codec/tile_encoder/dont_care.h"
#include "format/texture.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

// A plane of one tile after its masked texels were filled.
std::vector<std::int32_t> filled(const BlockShape& shape, std::vector<std::int32_t> values,
                                 const std::vector<int>& matters) {
    Bytes mask;
    for (const int one : matters)
        mask.push_back(static_cast<std::byte>(one));
    TilePlanes planes;
    planes.resize(shape, 1);
    planes.plane[0] = std::move(values);
    DontCare dont_care;
    dont_care.set(mask, shape);
    dont_care.fill(planes, 1);
    return planes.plane[0];
}

BlockShape with_sides(std::initializer_list<std::pair<int, int>> sides) {
    BlockShape shape = shape_of(1, 1, 1, 1);
    for (const auto& [axis, side] : sides)
        shape.n[static_cast<std::size_t>(axis)] = static_cast<std::uint8_t>(side);
    return shape;
}

TEST(DontCare, RunsAreInterpolatedAndEndsRepeated) {
    for (const int axis : {axis_u, axis_v, axis_s, axis_t})
        EXPECT_EQ(
            filled(with_sides({{axis, 8}}), {7, 10, 7, 7, 7, 50, -40, 7}, {0, 1, 0, 0, 0, 1, 9, 0}),
            (std::vector<std::int32_t>{10, 10, 20, 30, 40, 50, -40, -40}))
            << axis_name(axis);
}

TEST(DontCare, FillsAlongTheFirstAxisWithKnownValues) {
    const std::vector<Axis> order{axis_t, axis_s, axis_v, axis_u};
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
        // In planes u varies fastest, then v, s and t, so order[i] varies slower than order[i + 1].
        const auto centre = filled(with_sides({{order[i], 3}, {order[i + 1], 3}}),
                                   {0, 20, 0, 100, 7, 100, 0, 24, 0}, {1, 1, 1, 1, 0, 1, 1, 1, 1});
        EXPECT_EQ(centre, (std::vector<std::int32_t>{0, 20, 0, 100, 22, 100, 0, 24, 0}))
            << axis_name(order[i]);
        // In masks s varies faster than v.
        const std::vector<int> two = order[i] == axis_s ? std::vector<int>{0, 1, 0, 0, 0, 1}
                                                        : std::vector<int>{0, 0, 0, 1, 0, 1};
        const auto corner =
            filled(with_sides({{order[i], 2}, {order[i + 1], 3}}), {7, 7, 7, 10, 7, 30}, two);
        EXPECT_EQ(corner[0], 10);
        EXPECT_EQ(corner[1], 20); // filled along the second axis
        EXPECT_EQ(corner[4], 20);
        EXPECT_EQ(corner[2], 30);
    }
}

TEST(DontCare, MaskHasTheOrderOfTexels) {
    // The texel (u 1, s 0) is the third of a box and the second of a plane.
    EXPECT_EQ(filled(with_sides({{axis_u, 2}, {axis_s, 2}}), {10, 99, 30, 40}, {1, 1, 0, 1}),
              (std::vector<std::int32_t>{10, 40, 30, 40}));
}

TEST(DontCare, FillsFullyMaskedTilesWithTheBackground) {
    EXPECT_EQ(
        filled(with_sides({{axis_u, 3}, {axis_t, 2}}), {1, 2, 3, 4, 5, 6}, {0, 0, 0, 0, 0, 0}),
        std::vector<std::int32_t>(6, 0));
}

TEST(DontCare, ProjectionReplacesMaskedValuesOnly) {
    const BlockShape shape = with_sides({{axis_v, 3}});
    TilePlanes planes, decoded;
    for (TilePlanes* both : {&planes, &decoded})
        both->resize(shape, 2);
    for (std::size_t p = 0; p < 2; ++p) {
        planes.plane[p] = {1, 2, 3};
        decoded.plane[p] = {11, 12, 13};
    }
    DontCare dont_care;
    dont_care.set(Bytes{std::byte{1}, std::byte{0}, std::byte{1}}, shape);
    dont_care.project(decoded, planes, 2);
    for (std::size_t p = 0; p < 2; ++p)
        EXPECT_EQ(planes.plane[p], (std::vector<std::int32_t>{1, 12, 3}));
}

} // namespace
} // namespace tessera::test
