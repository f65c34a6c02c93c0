// Masked texels: the bytes they save, and the results they must not affect.
#include "codec/decoder.h"
#include "codec/metrics.h"
#include "codec/tile_encoder/dont_care.h"
#include "codec/trials/background.h"
#include "format/texture.h"
#include "tests/support/efforts.h"
#include "tests/support/encoded_file.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

namespace tessera::test {
namespace {

using Kind = RateTarget::Kind;

// (u, v, s, t) -> whether the texel matters.
using Matters = std::function<bool(int, int, int, int)>;

MemoryTexture make_mask(const Extent4& size, const Matters& matters) {
    return MemoryTexture({size, SampleType::unorm8, 1}, [&](int u, int v, int s, int t, int) {
        return matters(u, v, s, t) ? 3 / 255.0 : 0.0;
    });
}

constexpr Extent4 masked_size{32, 24, 8, 8};
const TextureDesc colour{masked_size, SampleType::unorm8, 3};
// For comparisons of file sizes, because tables dominate small files.
constexpr Extent4 large_size{48, 40, 8, 8};
const TextureDesc large_colour{large_size, SampleType::unorm8, 3};

bool in_chart(int u, int v, int, int) {
    return ((u / 8 + v / 8) & 1) != 0;
}

bool in_disk(int, int, int s, int t) {
    return (2 * s - 7) * (2 * s - 7) + (2 * t - 7) * (2 * t - 7) <= 64;
}

EncodeOptions masked_options(RateTarget rate, TexelSource* mask, int effort = copies_effort) {
    EncodeOptions options;
    options.rate = rate;
    options.effort = effort;
    options.threads = 2;
    options.tile_extent = {16, 16, 8, 8};
    options.mask = mask;
    return options;
}

Bytes decode_whole(const Bytes& file) {
    const auto source = wrap_memory(file);
    const auto decoder = Decoder::open(*source);
    EXPECT_TRUE(decoder) << decoder.status().message();
    if (!decoder)
        return {};
    const Box4 whole = Box4::whole(decoder->desc().size);
    Bytes texels(decoder->desc().box_bytes(whole));
    EXPECT_TRUE(decoder->decode_box(whole, texels, {.threads = 2}));
    return texels;
}

// The error over the texels that matter, for 8-bit textures of three channels.
struct Figures {
    double psnr = 0;
    int max_error = 0;
    std::uint64_t texels = 0;
};

Figures measure(const Bytes& a, const Bytes& b, const MemoryTexture& mask) {
    Figures figures;
    double sum = 0;
    for (std::size_t i = 0; i < mask.texels.size(); ++i) {
        if (mask.texels[i] == std::byte{0})
            continue;
        ++figures.texels;
        for (std::size_t at = 3 * i; at < 3 * i + 3; ++at) {
            const int error = std::to_integer<int>(a[at]) - std::to_integer<int>(b[at]);
            sum += error * error;
            figures.max_error = std::max(figures.max_error, std::abs(error));
        }
    }
    figures.psnr = 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(figures.texels) / sum);
    return figures;
}

TEST(Mask, ThatMasksNothingChangesNothing) {
    MemoryTexture texture = named_texture(colour, "smooth");
    MemoryTexture all = make_mask(masked_size, [](int, int, int, int) { return true; });
    for (const int effort : {0, copies_effort})
        EXPECT_EQ(
            encode_file_of(texture, masked_options({Kind::quality, 60}, &all, effort)).file,
            encode_file_of(texture, masked_options({Kind::quality, 60}, nullptr, effort)).file);
}

TEST(Mask, SavesBytesAndReportIgnoresMaskedTexels) {
    MemoryTexture noise = named_texture(large_colour, "noise");
    MemoryTexture mask = make_mask(large_size, in_chart);
    const EncodedFile plain =
        encode_file_of(noise, masked_options({Kind::quality, 70}, nullptr, quick_effort));
    const EncodedFile masked =
        encode_file_of(noise, masked_options({Kind::quality, 70}, &mask, quick_effort));
    EXPECT_LT(masked.file.size(), plain.file.size() * 7 / 10);
    const Figures figures = measure(noise.texels, decode_whole(masked.file), mask);
    EXPECT_NEAR(masked.report.psnr, figures.psnr, 1e-9);
    EXPECT_EQ(masked.report.max_error, figures.max_error);
    EXPECT_EQ(masked.report.texels_that_matter, figures.texels);
    EXPECT_EQ(plain.report.texels_that_matter, std::nullopt);
    const double all = static_cast<double>(texel_count(large_size));
    EXPECT_DOUBLE_EQ(masked.report.bits_per_texel,
                     8.0 * static_cast<double>(masked.file.size()) / all);
    const Figures before = measure(noise.texels, decode_whole(plain.file), mask);
    EXPECT_NEAR(figures.psnr, before.psnr, 1.0); // the bytes were not saved by lower quality
}

// `texture` with noise in its masked texels. with_gaps() makes them black.
MemoryTexture with_noise_behind(MemoryTexture texture, const MemoryTexture& mask) {
    for (std::size_t i = 0; i < mask.texels.size(); ++i)
        if (mask.texels[i] == std::byte{0})
            std::generate_n(&texture.texels[3 * i], 3, [n = i * 3]() mutable {
                return static_cast<std::byte>(++n * 2654435761u >> 13);
            });
    return texture;
}

MemoryTexture with_gaps(MemoryTexture texture, const MemoryTexture& mask) {
    for (std::size_t i = 0; i < mask.texels.size(); ++i)
        if (mask.texels[i] == std::byte{0})
            std::fill_n(&texture.texels[3 * i], 3, std::byte{0});
    return texture;
}

TEST(Mask, TargetsIgnoreMaskedTexels) {
    // If the masked noise counted, the target would need many times the bytes.
    MemoryTexture mask = make_mask(masked_size, in_disk);
    MemoryTexture texture = with_noise_behind(named_texture(colour, "smooth"), mask);
    const EncodedFile coded =
        encode_file_of(texture, masked_options({Kind::psnr, 42}, &mask, quick_effort));
    EXPECT_GE(coded.report.psnr, 42);
    EXPECT_LT(coded.report.psnr, 42.5);
    EXPECT_NEAR(measure(texture.texels, decode_whole(coded.file), mask).psnr, coded.report.psnr,
                1e-9);
}

TEST(Mask, NoiseInMaskedTexelsCostsNothing) {
    const MemoryTexture smooth = named_texture(colour, "smooth");
    MemoryTexture mask = make_mask(masked_size, in_chart);
    const EncodeOptions options = masked_options({Kind::quality, 60}, &mask);
    MemoryTexture gaps = with_gaps(smooth, mask), noisy = with_noise_behind(smooth, mask);
    EXPECT_EQ(encode_file_of(noisy, options).file, encode_file_of(gaps, options).file);
}

TEST(Mask, SmoothContinuationInMaskedTexelsSavesBytes) {
    // The waves are too short for a fill to continue them.
    MemoryTexture waves({large_size, SampleType::unorm8, 3}, [](int u, int v, int, int, int) {
        return 0.5 + 0.4 * std::sin(0.9 * u + 0.5 * v);
    });
    MemoryTexture mask = make_mask(large_size, in_chart), gaps = with_gaps(waves, mask);
    const EncodeOptions options = masked_options({Kind::quality, 60}, &mask, quick_effort);
    EXPECT_LT(encode_file_of(waves, options).file.size(),
              encode_file_of(gaps, options).file.size() * 8 / 10);
}

TEST(Mask, ErrorBoundsHoldForUnmaskedTexels) {
    const TextureDesc small{{24, 16, 6, 5}, SampleType::unorm8, 3};
    MemoryTexture noise = named_texture(small, "noise");
    MemoryTexture mask = make_mask(small.size, in_chart);
    for (const int bound : {0, 2}) {
        const RateTarget rate{Kind::max_error, static_cast<double>(bound)};
        const EncodedFile masked = encode_file_of(noise, masked_options(rate, &mask, 0));
        const EncodedFile plain = encode_file_of(noise, masked_options(rate, nullptr, 0));
        const Figures figures = measure(noise.texels, decode_whole(masked.file), mask);
        EXPECT_LE(figures.max_error, bound);
        EXPECT_EQ(masked.report.max_error, figures.max_error);
        EXPECT_LT(masked.file.size(), plain.file.size() * 8 / 10) << bound;
    }
}

TEST(Mask, SidesOfOneAreBroadcast) {
    MemoryTexture texture = named_texture(colour, "smooth");
    const auto oddly = [](int u, int, int, int t) { return (u / 3 + t) % 3 != 0; };
    const std::vector<std::pair<Extent4, Matters>> cases{
        {{32, 24, 1, 1}, in_chart}, {{1, 1, 8, 8}, in_disk}, {{32, 1, 1, 8}, oddly}};
    for (const auto& [mask_size, matters] : cases) {
        MemoryTexture narrow = make_mask(mask_size, matters),
                      whole = make_mask(masked_size, matters);
        const EncodedFile a =
            encode_file_of(texture, masked_options({Kind::quality, 60}, &narrow, quick_effort));
        const EncodedFile b =
            encode_file_of(texture, masked_options({Kind::quality, 60}, &whole, quick_effort));
        EXPECT_EQ(a.file, b.file) << to_string(mask_size);
        EXPECT_EQ(a.report.texels_that_matter, b.report.texels_that_matter);
        EXPECT_LT(*a.report.texels_that_matter, texel_count(masked_size));
    }
}

TEST(Mask, ThreadsChangeNoByte) {
    MemoryTexture texture = named_texture(colour, "smooth");
    MemoryTexture mask = make_mask(masked_size, in_chart);
    for (const bool layers : {false, true}) {
        EncodeOptions options = masked_options({Kind::quality, 60}, &mask);
        options.layers = layers;
        options.threads = 1;
        const Bytes one = encode_file_of(texture, options).file;
        options.threads = 3;
        EXPECT_EQ(encode_file_of(texture, options).file, one);
        EXPECT_GT(measure(texture.texels, decode_whole(one), mask).psnr, 35);
    }
}

TEST(Mask, TileTrialIgnoresMaskedTexels) {
    const TextureDesc large{{64, 36, 8, 8}, SampleType::unorm8, 3};
    MemoryTexture mask = make_mask(large.size, in_disk);
    MemoryTexture texture = with_gaps(named_texture(large, "smooth"), mask);
    MemoryTexture other = with_noise_behind(texture, mask);
    EncodeOptions options = masked_options({Kind::quality, 50}, &mask, quick_effort);
    options.tile_extent = tile_by_trial;
    EXPECT_EQ(encode_file_of(texture, options).file, encode_file_of(other, options).file);
}

TEST(Mask, StrictModeIgnoresMaskedTexels) {
    const TextureDesc hdr{{16, 16, 4, 4}, SampleType::half16, 3};
    const auto with_nan = [&](int where) {
        return MemoryTexture(hdr, [=](int u, int, int, int, int) {
            return u == where ? std::numeric_limits<double>::quiet_NaN() : 0.1 * u;
        });
    };
    MemoryTexture mask = make_mask({16, 1, 1, 1}, [](int u, int, int, int) { return u != 5; });
    EncodeOptions options = masked_options({Kind::quality, 60}, &mask, 2);
    options.strict = true;
    MemoryTexture harmless = with_nan(5), harmful = with_nan(6);
    EXPECT_EQ(encode_file_of(harmless, options).report.nan_count, 0u);
    Bytes file;
    const auto refused = encode_memory(harmful, file, options);
    EXPECT_EQ(refused.status().code(), ErrorCode::invalid_file);
}

TEST(Mask, MayMaskAllTexels) {
    MemoryTexture noise = named_texture(colour, "noise");
    MemoryTexture none = make_mask({1, 1, 1, 1}, [](int, int, int, int) { return false; });
    for (const RateTarget rate : {RateTarget{Kind::quality, 80}, RateTarget{Kind::psnr, 40}}) {
        const EncodedFile coded = encode_file_of(noise, masked_options(rate, &none, quick_effort));
        EXPECT_EQ(coded.report.texels_that_matter, 0u);
        EXPECT_EQ(coded.report.psnr, 999);
        EXPECT_LT(coded.file.size(), 1000u);
    }
}

TEST(Mask, BackgroundChoiceIgnoresMaskedTexels) {
    Sample sample;
    sample.boxes = {{{0, 0, 0, 0}, {5, 1, 1, 1}}};
    const auto bytes = [](std::initializer_list<int> values) {
        Bytes result;
        for (const int value : values)
            result.push_back(static_cast<std::byte>(value));
        return result;
    };
    sample.tiles = {{bytes({9, 9, 9, 4, 4}), {}}};
    const TextureDesc grey{{5, 1, 1, 1}, SampleType::unorm8, 1};
    EXPECT_EQ(find_background(sample, grey)[0], 9);
    sample.tiles[0].matters = bytes({0, 1, 0, 1, 1});
    EXPECT_EQ(find_background(sample, grey)[0], 4);
    EXPECT_EQ(sample.texel_count(), 5u);
    EXPECT_EQ(sample.texels_that_matter(), 3u);
}

class SlicedMask : public MemoryTexture {
public:
    using MemoryTexture::MemoryTexture;
    Locality locality() const override { return Locality::angular_cells; }
};

TEST(Mask, OfTheWrongKindIsRefused) {
    MemoryTexture texture = named_texture(colour, "smooth");
    const auto zero = [](int, int, int, int, int) { return 0.0; };
    const auto refused = [&](TexelSource&& mask, const char* word) {
        Bytes file;
        const auto report =
            encode_memory(texture, file, masked_options({Kind::quality, 60}, &mask, 1));
        EXPECT_EQ(report.status().code(), ErrorCode::bad_argument);
        EXPECT_NE(report.status().message().find(word), std::string::npos)
            << report.status().message();
        CompareOptions compare;
        compare.mask = &mask;
        EXPECT_EQ(compare_textures(texture, texture, compare).status().code(),
                  ErrorCode::bad_argument);
        EXPECT_EQ(compare_sample(texture, texture, 1, 1, compare).status().code(),
                  ErrorCode::bad_argument);
    };
    refused(MemoryTexture({masked_size, SampleType::unorm8, 3}, zero), "one channel");
    refused(MemoryTexture({masked_size, SampleType::half16, 1}, zero), "8 bits");
    refused(MemoryTexture({{40, 24, 8, 4}, SampleType::unorm8, 1}, zero), "40x24x8x4");
    refused(MemoryTexture({{2, 1, 1, 1}, SampleType::unorm8, 1}, zero), "2x1x1x1");
    refused(SlicedMask({masked_size, SampleType::unorm8, 1}, zero), "any order");
}

TEST(Mask, ComparisonIgnoresMaskedTexels) {
    MemoryTexture a = named_texture(colour, "noise"), b = a;
    MemoryTexture mask = make_mask(masked_size, in_disk);
    for (std::size_t i = 0; i < b.texels.size(); ++i) {
        const bool matters = mask.texels[i / 3] != std::byte{0};
        const int value = std::to_integer<int>(b.texels[i]);
        b.texels[i] = static_cast<std::byte>(value < 128 ? value + (matters ? i % 4 : 100) : value);
    }
    CompareOptions options;
    options.mask = &mask;
    const Figures expected = measure(a.texels, b.texels, mask);
    for (const auto& c : {compare_textures(a, b, options), compare_sample(a, b, 1, 1, options)}) {
        ASSERT_TRUE(c) << c.status().message();
        EXPECT_NEAR(c->errors.psnr(), expected.psnr, 1e-9);
        EXPECT_EQ(c->errors.texels(), expected.texels);
        EXPECT_EQ(c->errors.max_error(), 3u);
        EXPECT_FALSE(c->has_ssim);
    }
}

TEST(Mask, ComparisonIgnoresMaskedHalfFloats) {
    const TextureDesc hdr{{16, 8, 4, 4}, SampleType::half16, 1};
    const auto ramp = [](double at_five) {
        return [=](int u, int, int, int, int) { return u == 5 ? at_five : 0.25 * u; };
    };
    MemoryTexture a(hdr, ramp(1)), b(hdr, ramp(std::numeric_limits<double>::infinity()));
    MemoryTexture mask = make_mask({16, 1, 1, 1}, [](int u, int, int, int) { return u != 5; });
    CompareOptions options;
    EXPECT_EQ(compare_textures(a, b, options)->errors.non_finite(1), 128u);
    options.mask = &mask;
    const auto c = compare_textures(a, b, options);
    ASSERT_TRUE(c);
    EXPECT_EQ(c->errors.differing_samples(), 0u);
    EXPECT_EQ(c->errors.non_finite(1), 0u);
    EXPECT_EQ(c->errors.texels(), 15u * 8 * 4 * 4);
}

} // namespace
} // namespace tessera::test
