// Tests sample codes and the traits of sample types.
#include "format/samples.h"

#include <array>
#include <cmath>
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

TEST(SampleCodes, TraitsAgreeWithEachOther) {
    for (std::size_t i = 0; i < sample_types.size(); ++i) {
        const auto type = static_cast<SampleType>(i);
        const SampleTraits& traits = traits_of(type);
        EXPECT_TRUE(is_known(type));
        EXPECT_EQ(sample_value(traits.one, type), 1.0);
        EXPECT_EQ(sample_value(0, type), 0.0);
        EXPECT_EQ(code_sample(sample_code(traits.one, type), type), traits.one);
        int with_code = 0;
        for (unsigned sample = 0; sample < 1u << (8 * traits.bytes); ++sample) {
            const auto stored = static_cast<std::uint16_t>(sample);
            std::array<std::byte, 2> bytes{};
            store_sample(bytes.data(), stored, type);
            ASSERT_EQ(load_sample(bytes.data(), type), stored);
            ASSERT_EQ(has_code(stored, type), std::isfinite(sample_value(stored, type)));
            with_code += has_code(stored, type);
        }
        // Types with a sign have two zeros.
        EXPECT_EQ(with_code, traits.largest_code - traits.smallest_code + 1 + traits.is_float);
        const std::int64_t largest = std::int64_t{traits.largest_code} << traits.value_bits;
        EXPECT_LT(largest, traits.value_limit);
    }
    EXPECT_FALSE(is_known(static_cast<SampleType>(sample_types.size())));
    EXPECT_STREQ(traits_of(SampleType::unorm8).name, "unorm8");
    EXPECT_STREQ(traits_of(SampleType::half16).name, "half16");
    EXPECT_EQ(half_to_float(traits_of(SampleType::half16).largest_code), 65504.0f);
}

} // namespace
} // namespace tessera::test
