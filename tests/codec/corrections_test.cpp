// Corrections guarantee an error bound.
#include "codec/entropy/corrections.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/reconstruct/tile_decoder.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_codes.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::random_codes;

TEST(Corrections, KeepTheErrorBoundAndRoundTrip) {
    Random random(28);
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const int error : {0, 1, 2, 3, 4, 5, 100, 254, 255, 4000, 65535})
            for (int channels = 1; channels <= 4; ++channels) {
                if (type == SampleType::unorm8 && error > 255)
                    continue;
                const BlockShape shape =
                    channels == 2 ? shape_of(32, 32, 4, 3) : shape_of(7, 5, 3, 2);
                const TextureDesc desc{{1, 1, 1, 1}, type, static_cast<std::uint8_t>(channels)};
                const auto samples = static_cast<std::size_t>(shape.texels() * channels);
                const Bytes original = random_samples(random, samples, type);
                Bytes decoded = random_samples(random, samples, type);
                const std::size_t same = channels == 2 ? decoded.size() / 2 : decoded.size() / 8;
                std::copy_n(original.begin(), same - same % 2, decoded.begin());
                CorrectionMap map;
                const bool any = find_corrections(original, decoded, desc, error, map);
                EXPECT_EQ(any, std::ranges::any_of(map, [](std::int32_t k) { return k != 0; }));
                const CodeTables tables(random.chance(0.5) ? random_parameters(random)
                                                           : default_parameters());
                PayloadParts parts;
                const auto streams = encode_corrections(map, shape, channels, tables);
                for (const auto& stream : streams)
                    parts.corrections.emplace_back(stream);
                CorrectionMap got;
                ASSERT_TRUE(decode_corrections(parts, shape, channels, tables, got));
                ASSERT_EQ(got, map);
                apply_corrections(got, desc, error, decoded);
                for (std::size_t i = 0; i < samples; ++i)
                    ASSERT_LE(std::abs(code_at(original, i, type) - code_at(decoded, i, type)),
                              error)
                        << "error " << error << " sample " << i;
                if (error == 0 && type == SampleType::unorm8) {
                    EXPECT_EQ(decoded, original);
                }
            }
}

TEST(Corrections, NothingToCorrectCostsNothing) {
    const BlockShape shape = shape_of(32, 32, 4, 3);
    const CorrectionMap map(static_cast<std::size_t>(shape.texels()));
    for (const auto& stream : encode_corrections(map, shape, 1, CodeTables(default_parameters())))
        EXPECT_TRUE(stream.empty());
}

} // namespace
} // namespace tessera::test
