// Compares the dequantiser with exact arithmetic.
#include "format/tile/coding_parameters.h"
#include "tests/support/block_shapes.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera::test {
namespace {

using namespace tessera::test::block_shapes;

TEST(Dequantizer, ScalesAreTheRoundedIdeal) {
    Random random(2);
    for (const BlockShape& shape : shapes)
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (int round = 0; round < 300; ++round) {
                const StepCode step{static_cast<std::uint16_t>(
                    random.range(0, ((max_step_exponent + 1) << 11) - 1))};
                const bool dependent = random.chance(0.5);
                const ScaleSet scales = make_scales(step, shape, type, dependent);
                for (int axes = 0; axes <= 4; ++axes) {
                    const Scale scale = scales[static_cast<std::size_t>(axes)];
                    const long double ideal = static_cast<long double>(step.value()) *
                                              (dependent ? 0.5L : 1.0L) *
                                              std::exp2l(fraction_bits(type) + axes / 2.0L) /
                                              std::sqrt(static_cast<long double>(shape.texels()));
                    ASSERT_GE(scale.mantissa, 1024);
                    ASSERT_LE(scale.mantissa, 2047);
                    // Half a unit of rounding, plus the bits that the integer root drops.
                    ASSERT_NEAR(static_cast<double>(std::ldexp(ideal, -scale.exponent)),
                                scale.mantissa, 0.51)
                        << name_of(shape) << " step " << step.value() << " axes " << axes;
                }
            }
}

// All values are positive, so that integer division rounds down.
std::int64_t dequantize_twin(std::int64_t magnitude, Scale scale, std::int64_t offset) {
    const std::int64_t product = magnitude * scale.mantissa - scale.mantissa * offset / 64;
    const long double exact = std::ldexp(static_cast<long double>(product), scale.exponent);
    const long double rounded = std::floor(exact + 0.5L);
    return rounded > coefficient_limit ? coefficient_limit : static_cast<std::int64_t>(rounded);
}

TEST(Dequantizer, MatchesExactArithmeticAndSaturates) {
    Random random(3);
    std::int64_t saturated = 0;
    for (int round = 0; round < 300000; ++round) {
        const Scale scale{random.range(1024, 2047), random.range(-35, 28)};
        const int magnitude =
            round % 7 == 0 ? max_level : random.range(1, 1 << random.range(1, 19));
        const ReconstructionOffsets offsets{static_cast<std::uint8_t>(random.range(0, 31)),
                                            static_cast<std::uint8_t>(random.range(0, 31))};
        const std::int32_t got = dequantize(magnitude, scale, offsets);
        ASSERT_EQ(got, dequantize_twin(magnitude, scale, offsets[magnitude > 1 ? 1 : 0]))
            << magnitude << " * " << scale.mantissa << " * 2^" << scale.exponent;
        ASSERT_GE(got, 0);
        saturated += got == coefficient_limit;
    }
    EXPECT_GT(saturated, 1000);
    for (const int magnitude : {1, 2, 3, 100}) // monotone even where the offset changes
        EXPECT_LT(dequantize(magnitude, {1024, 0}, {31, 31}),
                  dequantize(magnitude + 1, {1024, 0}, {31, 31}));
}

} // namespace
} // namespace tessera::test
