// Conversion of texels to planes and back.
#include "codec/entropy/tile_syntax.h"
#include "codec/reconstruct/tile_decoder.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_codes.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::random_codes;

TEST(TilePlanes, TexelsRoundTripExactly) {
    Random random(29);
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (int channels = 1; channels <= 4; ++channels)
            for (const ColourTransform transform :
                 {ColourTransform::none, ColourTransform::ycocg_r}) {
                if (channels < 3 && transform != ColourTransform::none)
                    continue;
                const BlockShape shape = shape_of(7, 5, 3, 2);
                const ColourCoding colour{{{7, 5, 3, 2}, type, static_cast<std::uint8_t>(channels)},
                                          transform,
                                          {3, 77, 0, 200}};
                Bytes texels = random_samples(
                    random, static_cast<std::size_t>(shape.texels() * channels), type);
                for (std::size_t i = 0; type == SampleType::half16 && i < texels.size(); i += 2)
                    if (code_at(texels, i / 2, type) == 0) // -0 is coded as 0
                        texels[i] = texels[i + 1] = std::byte{0};
                TilePlanes planes;
                planes_from_texels(texels, colour, shape, planes);
                for (int c = 0; c < channels && transform == ColourTransform::none; ++c) {
                    const auto i = static_cast<std::size_t>(c);
                    const std::int32_t code =
                        code_at(texels, i, type) - sample_code(colour.background[i], type);
                    EXPECT_EQ(planes.plane[i][0], code * (1 << value_bits(type))) << channels;
                }
                Bytes again(texels.size());
                texels_from_planes(planes, colour, again);
                EXPECT_EQ(again, texels) << channels;
            }
}

} // namespace
} // namespace tessera::test
