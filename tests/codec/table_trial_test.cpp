// Tables fitted from two initial tables. Noise shows the gain best.
#include "codec/encoder.h"
#include "tests/support/efforts.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/tool_words.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr double deviation = 16;

test::MemoryTexture white_noise() {
    auto random = std::make_shared<std::mt19937>(7);
    return test::MemoryTexture({{64, 64, 8, 8}, SampleType::unorm8, 1},
                               [random](int, int, int, int, int) {
                                   double sum = 0; // of twelve uniform numbers: nearly normal
                                   for (int i = 0; i < 12; ++i)
                                       sum += static_cast<double>((*random)()) / 4294967296.0;
                                   return 0.5 + deviation / 255 * (sum - 6);
                               });
}

// Bits per texel above Shannon's bound for a Gaussian source at the measured error.
double excess(bool dense_tables, double quality) {
    test::MemoryTexture texture = white_noise();
    test::SwitchedOptions options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.effort = test::quick_effort; // a longer search gains nothing on noise
    options.tools = dense_tables ? "+dependent,+dense-tables" : "+dependent,-dense-tables";
    test::Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    if (!report)
        return 0;
    const double texels = 64.0 * 64 * 8 * 8;
    const double bits = 8.0 * static_cast<double>(file.size()) / texels;
    const double error = 255.0 * 255 / std::pow(10, report->psnr / 10);
    const double bound = 0.5 * std::log2(deviation * deviation / error);
    std::printf("quality %.0f%s: %.3f bits per texel, bound %.3f\n", quality,
                dense_tables ? "" : ", one start", bits, bound);
    return bits - bound;
}

// The best scalar quantiser is 0.23 (at one bit) to 0.25 bits above the bound.
TEST(DenseTables, NoiseComesCloserToTheBoundThanScalarQuantisersDo) {
    const double at_one_bit = excess(true, 58);
    EXPECT_LT(at_one_bit, 0.225);
    EXPECT_LT(at_one_bit, excess(false, 58) - 0.02);
    EXPECT_LT(excess(true, 74), 0.225);
}

} // namespace
} // namespace tessera
