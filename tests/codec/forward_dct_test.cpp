// The forward transform compared with double precision.
#include "codec/search_kernels/forward_dct.h"
#include "format/tile/block_transform.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/slow_dct.h"
#include "tests/support/transforms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace tessera::test {
namespace {

using namespace tessera::test::transforms;

std::vector<float> forward(const std::vector<float>& texels, const BlockShape& shape) {
    std::vector<float> a = texels, b(texels.size());
    for (int axis = 0; axis < 4; ++axis) {
        forward_axis(a.data(), b.data(), shape, axis);
        a.swap(b);
    }
    return a;
}

// A sum of n float products has an error of at most about n roundings. The errors of passes add up.
TEST(ForwardTransform, MatchesDoublePrecision) {
    Random random(3);
    std::vector<BlockShape> shapes = shapes_4d;
    for (int n = 1; n <= max_block_side; ++n)
        shapes.push_back(shape_of(n, 1, 1, 1)), shapes.push_back(shape_of(1, n, 1, 1)),
            shapes.push_back(shape_of(1, 3, n, 1)), shapes.push_back(shape_of(2, 1, 1, n));
    for (const BlockShape& shape : shapes) {
        const std::vector<float> x = random_floats(random, shape.texels(), 255);
        std::vector<double> want(x.begin(), x.end());
        slow_dct(want, shape, false);
        const std::vector<float> got = forward(x, shape);
        const int terms = shape.n[0] + shape.n[1] + shape.n[2] + shape.n[3];
        const double bound = 255 * 6e-8 * terms * std::sqrt(shape.texels());
        for (std::size_t i = 0; i < x.size(); ++i)
            ASSERT_NEAR(got[i], want[i], bound) << name_of(shape) << " coefficient " << i;
    }
}

TEST(ForwardTransform, SinesMatchDoublePrecision) {
    Random random(5);
    for (int n = 2; n <= max_sine_side; ++n)
        for (const int other : {1, 3, 8, 19})
            for (const int axis : {0, 1}) {
                const BlockShape shape =
                    axis == 0 ? shape_of(n, other, 1, 1) : shape_of(other, n, 1, 1);
                const std::vector<float> x = random_floats(random, shape.texels(), 255);
                std::vector<float> got(x.size());
                forward_sine_axis(x.data(), got.data(), shape, axis);
                const int step = axis == 0 ? 1 : other, line = axis == 0 ? n : 1;
                for (int i = 0; i < other; ++i)
                    for (int k = 0; k < n; ++k) {
                        double want = 0;
                        for (int y = 0; y < n; ++y)
                            want +=
                                x[static_cast<std::size_t>(i * line + y * step)] *
                                std::sqrt(4.0 / (2 * n + 1)) *
                                std::sin((2 * k + 1) * (y + 1) * std::numbers::pi / (2 * n + 1));
                        ASSERT_NEAR(got[static_cast<std::size_t>(i * line + k * step)], want,
                                    255 * 6e-8 * n * std::sqrt(n))
                            << name_of(shape) << " axis " << axis << " frequency " << k;
                    }
            }
}

TEST(ForwardTransform, InverseRestoresTexels) {
    Random random(4);
    for (const BlockShape& shape : shapes_4d) {
        std::vector<float> x(static_cast<std::size_t>(shape.texels()));
        for (float& value : x)
            value = static_cast<float>(random.range(-255, 255));
        const std::vector<float> c = forward(x, shape);
        const std::vector<std::int32_t> y =
            inverse_by_kernels(exact_fixed_point({c.begin(), c.end()}, shape), shape);
        for (std::size_t i = 0; i < x.size(); ++i)
            ASSERT_EQ((y[i] + 8192) >> 14, static_cast<int>(x[i])) << name_of(shape);
    }
}

TEST(ForwardTransform, SegmentsMatchTheSplitTree) {
    for (int side = 1; side <= max_block_side; ++side)
        for (int depth = 0; depth <= max_split_depth; ++depth) {
            const std::vector<Segment> segments = axis_segments(side, depth);
            ASSERT_EQ(segments.size(), std::size_t{1} << depth);
            std::vector<Segment> want;
            const std::function<void(const Block&, int)> walk = [&](const Block& block, int left) {
                if (left == 0 || block.shape.n[1] == 1) {
                    want.push_back({block.origin[1], block.shape.n[1]});
                    for (int i = 1; i < 1 << left;
                         ++i) // a side of 1 is not split; the rest is empty
                        want.push_back({0, 0});
                    return;
                }
                const Children children = children_of(block, Split::spatial);
                for (int i = 0; i < children.count; ++i)
                    walk(children.block[static_cast<std::size_t>(i)], left - 1);
            };
            walk(Block{{0, 0, 0, 0}, shape_of(1, side, 1, 1), 0, 0}, depth);
            for (std::size_t i = 0; i < want.size(); ++i) {
                ASSERT_EQ(segments[i].size, want[i].size) << side << " " << depth << " " << i;
                if (want[i].size > 0) {
                    ASSERT_EQ(segments[i].begin, want[i].begin);
                }
            }
        }
}

} // namespace
} // namespace tessera::test
