// Sample codes.

#include "format/samples.h"
#include "format/texture.h"
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

TEST(SampleCodes, AreMonotoneAndInvertible) {
    for (int code = -31743; code <= 31743; ++code) {
        const std::uint16_t half = code_sample(code, SampleType::half16);
        ASSERT_EQ(sample_code(half, SampleType::half16), code);
        if (code > -31743) {
            ASSERT_GT(half_to_float(half),
                      half_to_float(code_sample(code - 1, SampleType::half16)));
        }
    }
    EXPECT_EQ(sample_code(0x8000, SampleType::half16), 0);
    EXPECT_EQ(code_sample(1 << 30, SampleType::half16), 0x7BFF);
    EXPECT_EQ(code_sample(-(1 << 30), SampleType::half16), 0xFBFF);
    EXPECT_EQ(code_sample(-5, SampleType::unorm8), 0);
    EXPECT_EQ(code_sample(300, SampleType::unorm8), 255);
}

} // namespace
} // namespace tessera::test
