// Compares sampling on the GPU, with both residencies, with the CPU's sampler, and tests damaged
// files.
#include "decoder_glsl/gl_view_renderer.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "format/texture.h"
#include "tests/support/decode_cases.h"
#include "tests/support/sample_probes.h"
#include "tests/support/sampled_files.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::sampled_files;

// The four channels that tessera_sample() returns for a texel with fewer channels.
glm::dvec4 as_four(const glm::dvec4& c, int channels) {
    switch (channels) {
    case 1:
        return {c.x, c.x, c.x, 1};
    case 2:
        return {c.x, c.x, c.x, c.y};
    case 3:
        return {c.x, c.y, c.z, 1};
    default:
        return c;
    }
}

// The well-conditioned probes (sample_probes.h) and their colours computed on the CPU.
struct Judged {
    std::vector<Probe> probes;
    std::vector<glm::dvec4> expected;
};

Judged judge(SampledFile& file, unsigned count) {
    ProbeMaker maker(file.desc().size);
    Judged judged;
    for (unsigned i = 0; i < count; ++i) {
        const Probe probe = maker.make(i);
        const Condition condition = condition_of(file.desc().size, probe);
        if (condition.planar < 3e-4 || condition.jumps)
            continue;
        const auto colour = sample(file, probe.n, probe.d);
        EXPECT_TRUE(colour);
        judged.probes.push_back(probe);
        judged.expected.push_back(as_four(*colour, file.desc().channels));
    }
    return judged;
}

double worst_difference(const Judged& judged, const std::vector<glm::vec4>& colours) {
    double worst = 0;
    for (std::size_t i = 0; i < colours.size(); ++i)
        for (int c = 0; c < 4; ++c)
            worst = std::max(worst, std::abs(judged.expected[i][c] - colours[i][c]));
    return worst;
}

// Filtering hardware has 8-bit weights, with an error of up to 1/512 along s and along t.
constexpr double filter_precision = 2.0 / 512;

// Ten thousand samples are enough: a million find the same worst case.
TEST_F(GpuSample, ManySamplesAgreeWithTheCpu) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 60));
    const Judged judged = judge(file, 10000);
    for (const Residency residency : {Residency::on_load, Residency::on_feedback})
        for (const bool filter : {false, true}) {
            SCOPED_TRACE(std::string(name_of(residency)) + (filter ? " filtered" : ""));
            auto texture = SampledTexture::create(file.reader(), with(residency, filter));
            ASSERT_TRUE(texture) << texture.status().message();
            EXPECT_EQ(texture->damaged_tiles(), 0u);
            const double worst = worst_difference(judged, sampled(*texture, judged.probes));
            EXPECT_LE(worst, 1.0 / 255 + (filter ? filter_precision : 0));
            RecordProperty(std::string(name_of(residency)) + (filter ? "_filtered" : ""),
                           std::to_string(worst * 255));
        }
}

TEST_F(GpuSample, EveryTypeAndChannelCount) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (std::uint8_t channels = 1; channels <= 4; ++channels) {
            SampledFile file(mixed_file(type, channels, 40, false, {70, 36, 9, 9}));
            const Judged judged = judge(file, 4000);
            const double range = type == SampleType::half16 ? 4 : 1;
            for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
                SCOPED_TRACE(std::string(name_of(residency)) + " x" + std::to_string(channels));
                auto texture = SampledTexture::create(file.reader(), with(residency, false));
                ASSERT_TRUE(texture) << texture.status().message();
                EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)), range / 255);
            }
        }
}

// Covers whole textures, caches, borders and coarse texels. A small budget gives many batches.
TEST_F(GpuSample, PredictedTilesAreSampledAsOnTheCpu) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        const std::uint8_t channels = type == SampleType::unorm8 ? 3 : 4;
        SampledFile file(random_case(50u + channels, type, channels, {64, 32, 9, 9}, {32, 16, 8, 8},
                                     0.6, 0.005, 4, 0.6)
                             .file);
        const Judged judged = judge(file, 2000);
        double range = 1; // random levels give half floats of any size
        for (const glm::dvec4& colour : judged.expected)
            for (int c = 0; c < 4; ++c)
                range = std::max(range, std::abs(colour[c]));
        const auto check = [&](Residency residency, bool filter, std::uint64_t budget) {
            SCOPED_TRACE(std::string(name_of(residency)) + " x" + std::to_string(channels) +
                         (filter ? " filtered " : " ") + std::to_string(budget >> 10) + " KiB");
            auto texture = SampledTexture::create(file.reader(), with(residency, filter, budget));
            ASSERT_TRUE(texture) << texture.status().message();
            EXPECT_EQ(texture->damaged_tiles(), 0u);
            EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)),
                      range * (1.0 / 255 + (filter ? filter_precision : 0)));
            EXPECT_LE(texture->bytes(), budget);
        };
        check(Residency::on_load, false, 256ull << 20);
        check(Residency::on_feedback, false, 256ull << 20);
        check(Residency::on_feedback, true, 48ull << 20);
    }
}

// Tiles with sides above 32, including odd ones. Some are too long for borders in a cache.
TEST_F(GpuSample, LongTilesAreSampledAsOnTheCpu) {
    const auto check = [](const Bytes& bytes) {
        SampledFile file(bytes);
        SCOPED_TRACE("tiles " + to_string(file.reader().header().tile_extent));
        const Judged judged = judge(file, 2000);
        double range = 1; // random levels give half floats of any size
        for (const glm::dvec4& colour : judged.expected)
            for (int c = 0; c < 4; ++c)
                range = std::max(range, std::abs(colour[c]));
        for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
            SCOPED_TRACE(name_of(residency));
            auto texture = SampledTexture::create(file.reader(), with(residency, true));
            ASSERT_TRUE(texture) << texture.status().message();
            EXPECT_EQ(texture->damaged_tiles(), 0u);
            EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)),
                      range * (1.0 / 255 + filter_precision));
        }
    };
    check(mixed_file(SampleType::unorm8, 3, 60, false, {128, 64, 3, 2}, {64, 64, 4, 4}));
    check(mixed_file(SampleType::half16, 4, 60, false, {125, 45, 4, 4}, {63, 45, 3, 3}));
    check(mixed_file(SampleType::unorm8, 3, 60, false, {64, 2, 32, 20}, {64, 1, 32, 32}));
    // Tiles larger than blocks, of four views and of one.
    check(mixed_file(SampleType::unorm8, 3, 60, false, {300, 200, 2, 2}, {256, 256, 2, 2}));
    check(random_case(64, SampleType::half16, 3, {400, 90, 1, 1}, {256, 128, 1, 1}, 0.8, 0.005, 4,
                      0.8)
              .file);
    // Trees of 11 levels.
    check(
        random_case(63, SampleType::unorm8, 3, {128, 2, 32, 2}, {64, 1, 32, 1}, 0.99, 0.3, 4).file);
    check(
        random_case(62, SampleType::half16, 3, {125, 45, 6, 3}, {63, 45, 5, 3}, 0.6, 0.005, 4, 0.6)
            .file);
}

// No texture is starved, and the budget that budget_for() names suffices for all.
TEST_F(GpuSample, SeveralTexturesShareABudget) {
    SampledFile large(mixed_file(SampleType::unorm8, 3, 50, false, {256, 128, 16, 16}));
    SampledFile small(mixed_file(SampleType::unorm8, 1, 50, false, {64, 32, 6, 6}));
    auto options = with(Residency::on_feedback, true);
    options.coarse = false; // which would decode all tiles
    const SampledTextureRequest files[] = {{&large.reader(), options}, {&small.reader(), options}};
    std::uint64_t needed = 0;
    std::vector<std::uint64_t> most; // slots, which tiles without bytes do not need
    const auto check = [&](std::uint64_t budget) {
        SCOPED_TRACE(std::to_string(budget >> 10) + " KiB");
        auto textures = SampledTexture::create(files, budget);
        ASSERT_TRUE(textures) << textures.status().message();
        std::uint64_t bytes = 0;
        std::vector<std::uint64_t> slots;
        for (const SampledTexture& texture : *textures) {
            bytes += texture.bytes();
            slots.push_back(texture.cache_slots());
        }
        EXPECT_LE(bytes, budget);
        if (most.empty()) {
            most = slots;
            for (std::size_t i = 0; i < std::size(files); ++i)
                needed = std::max(needed, (*textures)[i].budget_for(slots[i]));
        }
        const bool fits = budget >= needed;
        EXPECT_EQ(slots == most, fits) << slots[0] << " and " << slots[1] << " slots";
        EXPECT_GT(std::ranges::min(slots), 0u);
    };
    check(256ull << 20);
    check(needed);
    check(16ull << 20);
}

TEST_F(GpuSample, TexturesOfDifferentResidenciesAreNotForOneProgram) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    const SampledTextureRequest files[] = {
        {&file.reader(), with(Residency::on_feedback, true)},
        {&file.reader(), with(Residency::on_load, true)},
    };
    EXPECT_EQ(SampledTexture::create(files, 64ull << 20).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(SampledTexture::create({}, 64ull << 20).status().code(), ErrorCode::bad_argument);
}

TEST_F(GpuSample, CoarseTexelsOfAnotherTextureAreRefused) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    Bytes texels(file.desc().box_bytes(Box4::whole(file.desc().size)));
    MemorySource source(file.desc(), texels);
    auto options = with(Residency::on_feedback, true);
    options.coarse_from = {coarse_level(file.desc().size, 1, 1, 0), &source};
    EXPECT_EQ(SampledTexture::create(file.reader(), options).status().code(),
              ErrorCode::bad_argument);
}

TEST_F(GpuSample, NamesWhatDoesNotFit) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    const auto refusal = [&](const ContainerReader& reader, Residency residency,
                             std::uint64_t budget) {
        const auto texture = SampledTexture::create(reader, with(residency, true, budget));
        EXPECT_FALSE(texture);
        EXPECT_EQ(texture.status().code(), ErrorCode::unsupported);
        return texture.status().message();
    };
    EXPECT_NE(refusal(file.reader(), Residency::on_load, 1 << 20).find("budget"),
              std::string::npos);
    EXPECT_NE(refusal(file.reader(), Residency::on_feedback, 1 << 18).find("budget"),
              std::string::npos);

    const DecodeCase lossless = encoded_case("smooth", {{33, 21, 9, 6}, SampleType::unorm8, 3},
                                             {RateTarget::Kind::max_error, 0});
    SampledFile exact(lossless.file);
    const Judged judged = judge(exact, 4000);
    for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
        auto texture = SampledTexture::create(exact.reader(), with(residency, false));
        ASSERT_TRUE(texture) << texture.status().message();
        EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)), 1.0 / 255);
    }
    EXPECT_EQ(choose_residency(file.reader(), 1ull << 30), Residency::on_load);
    EXPECT_EQ(choose_residency(file.reader(), 1ull << 20), Residency::on_feedback);
}

} // namespace
} // namespace tessera::test
