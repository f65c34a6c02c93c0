// Decoding keeps the mean colour of a texture.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/tile_encoder/mean_balance.h"
#include "format/samples.h"
#include "format/tile/dequantizer.h"
#include "tests/support/layered_files.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tuple>

namespace tessera {
namespace {

using namespace test::layered_files;
using test::Bytes;

constexpr Extent4 small_size{32, 24, 8, 8};

// The largest difference of the means over all channels, in codes.
double mean_bias(const char* scene, const EncodeOptions& options) {
    const auto file = encode_scene(scene, small_size, false, options);
    EXPECT_TRUE(file.ok()) << file.status().message();
    const auto memory = wrap_memory(file->file);
    const auto decoder = Decoder::open(*memory);
    const TextureDesc desc = decoder->desc();
    const Bytes decoded = texels_of(*decoder, Box4::whole(small_size));
    Bytes source(decoded.size());
    EXPECT_TRUE(baked(scene, small_size).read(Box4::whole(small_size), source).ok());
    const std::size_t bytes = sample_bytes(desc.type);
    Means sum{};
    for (std::size_t i = 0; i < decoded.size() / bytes; ++i)
        sum[i % desc.channels] +=
            sample_code(load_sample(&decoded[i * bytes], desc.type), desc.type) -
            sample_code(load_sample(&source[i * bytes], desc.type), desc.type);
    return largest_of(sum) / static_cast<double>(texel_count(small_size));
}

// Without balancing the means differ by 0.15, 0.84 and 0.70 codes.
TEST(MeanBalance, SmallTexturesKeepTheirMeanColours) {
    for (const auto& [scene, quality, effort] :
         {std::tuple{"composed", 68.0, 1}, {"mirror", 60.0, 2}, {"lamps", 75.0, 1}}) {
        EncodeOptions options;
        options.rate = {RateTarget::Kind::quality, quality};
        options.effort = effort;
        EXPECT_LT(mean_bias(scene, options), 0.03) << scene;
    }
}

// MeanDebt asks the remaining blocks for the error of the mean that is not yet corrected.
TEST(MeanBalance, AsksOnlyForTheRemainingError) {
    const TextureDesc desc{{4, 4, 1, 1}, SampleType::unorm8, 1};
    ColourCoding colour;
    colour.desc = desc;
    CodingParameters parameters;
    parameters.step[0] = StepCode::nearest(64);
    const TileCoding coding(parameters, desc.type, desc.channels);
    BlockCoefficients block;
    block.shape.n = {4, 4, 1, 1};
    const auto asked_by = [&](const MeanDebt& debt) {
        block.plane[0].assign(16, 0);
        debt.ask_of(block);
        return block.plane[0][0] / 4; // as a change of the mean
    };
    MeanDebt debt({-3.0 / 8}, 32, 8, coding, colour);
    EXPECT_FLOAT_EQ(asked_by(debt), 3) << "eight times its share";
    TilePlanes before, after;
    before.shape = after.shape = block.shape;
    before.plane[0].assign(16, 0);
    after.plane[0].assign(16, 8); // half a code in 16 texels: 8 of the 12 codes that 32 texels lack
    debt.count({{0, 0, 0, 0}, block.shape}, before, after);
    EXPECT_FLOAT_EQ(asked_by(debt), 2) << "eight times a quarter of a code";
    const MeanDebt large({-100}, 16, 8, coding, colour);
    EXPECT_FLOAT_EQ(asked_by(large), 8) << "half a step of the first coefficient";
}

} // namespace
} // namespace tessera
