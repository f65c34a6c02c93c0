// Rate targets are met.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/support/efforts.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/round_trips.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

using Kind = RateTarget::Kind;

TEST(Rate, MaximumErrorIsAGuarantee) {
    for (const SampleType type : types)
        for (const int channels : {1, 3, 4}) {
            const TextureDesc desc = describe({11, 9, 3, 3}, type, channels);
            for (const NamedTexture& named : named_textures(desc))
                for (const int error : {0, 1, 2, 5, type == SampleType::unorm8 ? 255 : 60}) {
                    if (channels != 3 && error > 1)
                        continue;
                    MemoryTexture texture(desc, named.sample);
                    const Encoded encoded = encode(
                        texture, options_for({Kind::max_error, static_cast<double>(error)}, 0));
                    const Difference d =
                        difference(texture.texels, decode_all(encoded.file, desc), type);
                    ASSERT_LE(d.largest, error) << named.name << " channels " << channels;
                    ASSERT_EQ(encoded.report.max_error, d.largest) << named.name;
                    if (error == 0) {
                        ASSERT_EQ(decode_all(encoded.file, desc), texture.texels) << named.name;
                    }
                }
        }
}

// The texture is so large that the PSNR varies in small steps. In tiny ones it jumps by half a dB.
TEST(Rate, PsnrIsNeverBelowTheTarget) {
    for (const SampleType type : types) {
        MemoryTexture texture = named_texture(describe({33, 20, 9, 8}, type), "smooth");
        for (const double psnr : {34.0, 41.5}) {
            const Encoded encoded = encode(texture, options_for({Kind::psnr, psnr}, quick_effort));
            EXPECT_GE(encoded.report.psnr, psnr);
            EXPECT_LE(encoded.report.psnr, psnr + 0.6); // a small texture: few levels, large jumps
            EXPECT_LE(encoded.report.passes, 6u);
            EXPECT_EQ(encoded.report.note, "");
        }
    }
}

// Beyond the finest quantiser a lossless file is written if it is smaller or lossless_fallback is
// set.
TEST(Rate, PsnrBeyondTheFinestQuantiserCanFallBackToLossless) {
    MemoryTexture noise = named_texture(describe({9, 8, 5, 4}, SampleType::half16), "noise");
    EncodeOptions options = options_for({Kind::psnr, 119}, 0);
    const Encoded cheaper = encode(noise, options);
    EXPECT_EQ(cheaper.report.target_met, cheaper.report.psnr >= 119);
    EXPECT_NE(cheaper.report.note, "");
    options.lossless_fallback = true;
    const Encoded wanted = encode(noise, options);
    EXPECT_TRUE(wanted.report.target_met);
    EXPECT_EQ(wanted.report.max_error, 0u);
    EXPECT_LE(cheaper.file.size(), wanted.file.size());
    EXPECT_EQ(decode_all(wanted.file, noise.desc()), noise.texels);
}

TEST(Rate, SizesAreNeverExceeded) {
    for (const SampleType type : types)
        for (const char* name : {"smooth", "noise", "bright_texel"}) {
            if (type == SampleType::half16 && std::string(name) == "noise")
                continue; // adds nothing to the other cases
            const bool smooth = std::string(name) == "smooth";
            const Extent4 size = smooth ? Extent4{33, 20, 9, 8} : Extent4{33, 9, 9, 8};
            MemoryTexture texture = named_texture(describe(size, type), name);
            const auto texels = static_cast<double>(texel_count(texture.desc().size));
            // With 8-bit samples "smooth" gives files up to 2,137 bytes or above 6,000 bytes.
            const double most = smooth && type == SampleType::unorm8 ? 2100 : 4000;
            for (const double bytes : smooth ? std::vector{1200.0, most} : std::vector{most}) {
                const Encoded encoded = encode(texture, options_for({Kind::bytes, bytes}, 0));
                EXPECT_LE(static_cast<double>(encoded.file.size()), bytes) << name;
                if (smooth) {
                    EXPECT_GE(static_cast<double>(encoded.file.size()), 0.85 * bytes);
                }
            }
            const Encoded encoded = encode(texture, options_for({Kind::bpt, 0.5}, 0));
            EXPECT_LE(static_cast<double>(encoded.file.size()) * 8 / texels, 0.5) << name;
            EXPECT_LE(encoded.report.bits_per_texel, 0.5) << name;
        }
    MemoryTexture texture = named_texture(describe({16, 16, 8, 8}), "smooth");
    Bytes out;
    const auto refused = encode_memory(texture, out, options_for({Kind::bytes, 50}));
    EXPECT_EQ(refused.status().code(), ErrorCode::bad_argument);
    EXPECT_NE(refused.status().message(), "");
}

TEST(Rate, TargetsOutOfRangeAreRefused) {
    MemoryTexture texture = named_texture(describe({4, 4, 2, 2}), "smooth");
    Bytes out;
    for (const RateTarget rate :
         {RateTarget{Kind::quality, 0}, RateTarget{Kind::quality, 101}, RateTarget{Kind::psnr, 0},
          RateTarget{Kind::psnr, NAN}, RateTarget{Kind::bpt, 0}, RateTarget{Kind::bytes, -1},
          RateTarget{Kind::max_error, -1}, RateTarget{Kind::max_error, 0.5},
          RateTarget{Kind::max_error, 256}, RateTarget{Kind::bytes, INFINITY}})
        EXPECT_EQ(encode_memory(texture, out, options_for(rate)).status().code(),
                  ErrorCode::bad_argument)
            << static_cast<int>(rate.kind) << " " << rate.value;
    for (const int effort : {-1, most_effort + 1})
        EXPECT_EQ(encode_memory(texture, out, options_for({}, effort)).status().code(),
                  ErrorCode::bad_argument);
}

} // namespace
} // namespace tessera::test
