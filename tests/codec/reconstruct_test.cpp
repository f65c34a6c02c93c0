// Reconstruction of texels from levels, compared with a slow implementation.
#include "codec/kernels/kernels.h"
#include "codec/reconstruct/reconstruct.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_tile.h"
#include "tests/support/slow_dct.h"
#include "tests/support/transforms.h"

#include <cstdio>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::transforms;

// Compares reconstruct() with dequantisation and transforms in double precision. Covers supports,
// block positions and shortcuts.
TEST(Reconstruct, MatchesDoublePrecisionOnRandomTiles) {
    Random random(11);
    std::vector<BlockShape> shapes = shapes_4d;
    shapes.push_back(shape_of(1, 1, 1, 1));
    double worst_mse = 0;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const BlockShape& shape : shapes) {
            CodingParameters parameters;
            for (StepCode& step : parameters.step)
                step = StepCode::nearest(0.5 + 30 * random.unit());
            parameters.offsets = {{{7, 3}, {12, 5}}};
            const TileCoding coding(parameters, type, 2);
            const TileLevels tile =
                RandomTile(random, coding, {.split = 0.6, .density = 0.1, .magnitude_bits = 3})
                    .make(shape);
            ReconstructScratch scratch;
            TilePlanes planes;
            reconstruct(tile, coding, scratch, planes);
            double squares = 0, count = 0;
            for (std::size_t b = 0; b < tile.blocks.size(); ++b)
                for (std::size_t plane = 0; plane < 2; ++plane) {
                    const Block& block = tile.blocks[b];
                    const auto& n = block.shape.n;
                    const ShapeCoding& sc = coding.shape(block.shape);
                    std::vector<double> x(static_cast<std::size_t>(block.shape.texels()));
                    for (const NonZero& nz : tile.levels(tile.planes[b * 2 + plane])) {
                        const auto& k = sc.order.entry[nz.index].k;
                        const int axes = (k[0] > 0) + (k[1] > 0) + (k[2] > 0) + (k[3] > 0);
                        const double c = dequantize(
                            std::abs(nz.level), sc.scales[plane][static_cast<std::size_t>(axes)],
                            parameters.offsets[plane]);
                        x[static_cast<std::size_t>(k[0] +
                                                   n[0] * (k[1] + n[1] * (k[2] + n[2] * k[3])))] =
                            std::copysign(c, nz.level) *
                            std::sqrt(block.shape.texels() / std::exp2(axes)) /
                            std::exp2(fraction_bits(type));
                    }
                    slow_dct(x, block.shape, true);
                    for (std::size_t i = 0; i < x.size(); ++i) {
                        const int u = static_cast<int>(i) % n[0],
                                  v = static_cast<int>(i) / n[0] % n[1],
                                  s = static_cast<int>(i) / (n[0] * n[1]) % n[2],
                                  t = static_cast<int>(i) / (n[0] * n[1] * n[2]);
                        const int at = ((t + block.origin[3]) * shape.n[2] + s + block.origin[2]) *
                                           shape.n[1] * shape.n[0] +
                                       (v + block.origin[1]) * shape.n[0] + u + block.origin[0];
                        const double got = planes.plane[plane][static_cast<std::size_t>(at)] /
                                           std::exp2(value_bits(type));
                        ASSERT_NEAR(got, x[i], type == SampleType::unorm8 ? 0.04 : 0.65)
                            << name_of(shape) << " block " << b << " texel " << i;
                        const double error = got - x[i];
                        squares += error * error;
                        ++count;
                    }
                }
            constexpr double enough = 100; // values for a mean of rounding errors
            if (type == SampleType::unorm8 && count >= enough)
                worst_mse = std::max(worst_mse, squares / count);
        }
    // Rounding to sixteenths alone gives an error of 1 / 12 / 256.
    EXPECT_LE(worst_mse, 1.3 / 12 / 256);
    std::printf("reconstruct(): worst mean square error against double %.6f\n", worst_mse);
}

} // namespace
} // namespace tessera::test
