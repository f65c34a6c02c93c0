// Tests step codes and the section CODE.
#include "format/tile/coding_parameters.h"
#include "format/tile/rans.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

TEST(StepCode, RoundTripsAndRoundsToNearest) {
    double previous = 0;
    for (int bits = 0; bits < (max_step_exponent + 1) << 11; ++bits) {
        const StepCode code{static_cast<std::uint16_t>(bits)};
        const double apart = code.value() - previous;
        ASSERT_GT(apart, 0);
        ASSERT_EQ(StepCode::nearest(code.value()), code) << bits;
        if (bits > 0) {
            ASSERT_EQ(StepCode::nearest(code.value() - 0.49 * apart), code) << bits;
            ASSERT_EQ(StepCode::nearest(code.value() - 0.51 * apart).value(), previous) << bits;
        }
        previous = code.value();
    }
    EXPECT_EQ(StepCode::nearest(0.0).value(), 0.5);
    EXPECT_EQ(StepCode::nearest(1e30).value(), previous);
    EXPECT_EQ(StepCode::nearest(1.0).value(), 1.0);
}

CodingParameters random_coding_parameters(Random& random, double changed) {
    CodingParameters coding;
    const auto step = [&] {
        return StepCode{
            static_cast<std::uint16_t>(random.range(0, ((max_step_exponent + 1) << 11) - 1))};
    };
    for (StepCode& code : coding.step)
        code = step();
    coding.rotated_step = step();
    coding.colour_rotation = random.chance(0.5);
    coding.prediction = random.chance(0.5);
    coding.smooth_copies = coding.prediction && random.chance(0.5);
    coding.leaves_out_transforms = coding.prediction && random.chance(0.5);
    coding.transforms_any_plane = coding.prediction && random.chance(0.5);
    if (coding.prediction && random.chance(0.5))
        coding.base = {.on = true,
                       .margin = static_cast<std::uint8_t>(random.range(0, max_base_margin)),
                       .v_against_u = random.chance(0.5)};
    coding.dependent = random.chance(0.5);
    if (random.chance(0.5))
        coding.filter = random_filter(random);
    for (auto& offsets : coding.offsets)
        for (std::uint8_t& offset : offsets)
            offset = static_cast<std::uint8_t>(random.range(0, 31));
    for (std::uint8_t& weight : coding.scan_weights)
        weight = static_cast<std::uint8_t>(random.range(1, 255));
    coding.correction_error = static_cast<std::uint16_t>(random.range(0, 65535));
    for (int i = 0; i < parameter_count; ++i)
        if (random.chance(changed) && (coding.prediction || !is_of_copies(i)) &&
            (coding.base.on || !is_of_bases(i)) &&
            (coding.leaves_out_transforms || i < no_transform_offset))
            coding.parameters[static_cast<std::size_t>(i)] =
                static_cast<std::uint8_t>(random.range(0, 63));
    return coding;
}

void expect_in_range(const CodingParameters& coding) {
    for (const StepCode& code : coding.step)
        ASSERT_LE(code.bits >> 11, max_step_exponent);
    ASSERT_LE(coding.rotated_step.bits >> 11, max_step_exponent);
    for (const auto& offsets : coding.offsets)
        for (const std::uint8_t offset : offsets)
            ASSERT_LE(offset, 31);
    for (const std::uint8_t weight : coding.scan_weights)
        ASSERT_GE(weight, 1);
    for (const std::uint8_t p : coding.parameters)
        ASSERT_LE(p, 63);
}

// Of a file with 4 planes and corrections, which stores all fields.
Bytes write_all(const CodingParameters& coding) {
    return write_coding_parameters(coding, 4, true);
}
Result<CodingParameters> read_all(std::span<const std::byte> bytes) {
    return read_coding_parameters(bytes, 4, true);
}

TEST(CodingParameters, RoundTrip) {
    Random random(9);
    for (int round = 0; round < 60; ++round) {
        const CodingParameters want =
            round == 0 ? CodingParameters{} : random_coding_parameters(random, round % 4 * 0.3);
        const Bytes bytes = write_all(want);
        const Result<CodingParameters> got = read_all(bytes);
        ASSERT_TRUE(got) << got.status().message();
        EXPECT_EQ(got->step, want.step);
        EXPECT_EQ(got->rotated_step, want.colour_rotation ? want.rotated_step : StepCode());
        EXPECT_EQ(got->colour_rotation, want.colour_rotation);
        EXPECT_EQ(got->prediction, want.prediction);
        EXPECT_EQ(got->smooth_copies, want.smooth_copies);
        EXPECT_EQ(got->leaves_out_transforms, want.leaves_out_transforms);
        EXPECT_EQ(got->transforms_any_plane, want.transforms_any_plane);
        EXPECT_EQ(got->plane_trees, want.plane_trees);
        EXPECT_EQ(got->base, want.base);
        EXPECT_EQ(got->dependent, want.dependent);
        EXPECT_EQ(got->filter, want.filter);
        EXPECT_EQ(got->offsets, want.offsets);
        EXPECT_EQ(got->scan_weights, want.scan_weights);
        EXPECT_EQ(got->correction_error, want.correction_error);
        EXPECT_EQ(got->parameters, want.parameters);
    }
}

TEST(CodingParameters, FieldsThatAFileDoesNotUseAreLeftOut) {
    Random random(11);
    const CodingParameters coding = random_coding_parameters(random, 0.3);
    const Result<CodingParameters> grey =
        read_coding_parameters(write_coding_parameters(coding, 1, false), 1, false);
    ASSERT_TRUE(grey) << grey.status().message();
    EXPECT_EQ(grey->step[0], coding.step[0]);
    EXPECT_EQ(grey->step[1], StepCode());
    EXPECT_EQ(grey->offsets[0], coding.offsets[0]);
    EXPECT_EQ(grey->offsets[1], ReconstructionOffsets());
    EXPECT_EQ(grey->correction_error, 0);
    EXPECT_EQ(grey->parameters, coding.parameters);

    CodingParameters plain;
    EXPECT_EQ(write_coding_parameters(plain, 1, false).size(), 6u); // flags, step, 2 offsets
    EXPECT_EQ(write_coding_parameters(plain, 3, false).size(), 12u);
    EXPECT_EQ(write_coding_parameters(plain, 3, true).size(), 14u);
    plain.colour_rotation = true;
    EXPECT_EQ(write_coding_parameters(plain, 3, false).size(), 14u);
    plain.scan_weights[2] = 17;
    EXPECT_EQ(write_coding_parameters(plain, 3, false).size(), 18u);
    plain.parameters[7] ^= 1;
    EXPECT_GT(write_coding_parameters(plain, 3, false).size(), 21u);
}

// A stream of differences, of which there are none, is valid; bytes that no flag announces are not.
TEST(CodingParameters, TheFlagsDecideWhereTheSectionEnds) {
    Bytes bytes = write_all({});
    bytes.resize(bytes.size() + 3);
    EXPECT_FALSE(read_all(bytes));
    bytes[1] = std::byte{1};
    const Result<CodingParameters> got = read_all(bytes);
    ASSERT_TRUE(got) << got.status().message();
    EXPECT_EQ(got->parameters, default_parameters());
    bytes.back() = std::byte{64};
    EXPECT_FALSE(read_all(bytes)) << "difference model";
    bytes.back() = std::byte{0};
    bytes.pop_back();
    EXPECT_FALSE(read_all(bytes)) << "cut off";
    bytes[1] = std::byte{2};
    EXPECT_FALSE(read_all(bytes)) << "unknown flag";
}

TEST(CodingParameters, ParametersOfCopiesAreOmittedWithoutPredictions) {
    CodingParameters coding;
    int left_out = 0;
    for (int i = 0; i < parameter_count; ++i)
        if (is_of_copies(i)) {
            std::uint8_t& parameter = coding.parameters[static_cast<std::size_t>(i)];
            parameter = static_cast<std::uint8_t>((parameter + 1) % 64);
            ++left_out;
        }
    EXPECT_EQ(left_out,
              1344 + 1188 + 117 + 12 + 4 + 16 + 1 + 2 + 8 + 45 + 36 + 36); // FORMAT.md 3.5
    EXPECT_EQ(write_all(coding).size(), write_all({}).size());
    coding.prediction = coding.base.on = coding.leaves_out_transforms = true;
    const Result<CodingParameters> got = read_all(write_all(coding));
    ASSERT_TRUE(got) << got.status().message();
    EXPECT_EQ(got->parameters, coding.parameters);
}

TEST(CodingParameters, ParametersOfBasePicturesAreOmittedWithoutThem) {
    CodingParameters coding;
    coding.prediction = true;
    const std::size_t bytes = write_all(coding).size();
    for (int i = 0; i < parameter_count; ++i)
        if (is_of_bases(i))
            coding.parameters[static_cast<std::size_t>(i)] = 63;
    EXPECT_EQ(write_all(coding).size(), bytes);
    coding.base.on = true;
    EXPECT_GT(write_all(coding).size(), bytes);
}

TEST(CodingParameters, BasePicturesHaveASmallMarginAndNeedPredictions) {
    constexpr std::size_t flags = 0, margin = 16; // after 4 steps, 4 offsets and E
    CodingParameters coding;
    coding.prediction = true;
    coding.base = {.on = true, .margin = 31, .v_against_u = true};
    Bytes bytes = write_all(coding);
    EXPECT_TRUE(read_all(bytes));
    bytes[margin] = std::byte{32};
    EXPECT_FALSE(read_all(bytes));
    bytes[margin] = std::byte{31};
    for (const int value : {32, 96, 66}) {
        bytes[flags] = static_cast<std::byte>(value);
        EXPECT_FALSE(read_all(bytes)) << value;
    }
    bytes[flags] = std::byte{34};
    const Result<CodingParameters> got = read_all(bytes);
    ASSERT_TRUE(got) << got.status().message();
    EXPECT_EQ(got->base, (BasePictures{.on = true, .margin = 31, .v_against_u = false}));
    bytes.resize(margin);
    EXPECT_FALSE(read_all(bytes));
}

TEST(CodingParameters, SmoothCopiesNeedPredictions) {
    constexpr std::size_t flags = 0;
    Bytes bytes = write_all({});
    for (const int value : {8, 12}) {
        bytes[flags] = static_cast<std::byte>(value);
        EXPECT_FALSE(read_all(bytes)) << value;
    }
    bytes[flags] = std::byte{10};
    const Result<CodingParameters> both = read_all(bytes);
    ASSERT_TRUE(both) << both.status().message();
    EXPECT_TRUE(both->smooth_copies);
}

TEST(CodingParameters, TreesOfPlanesNeedTwoPlanesAndPredictions) {
    CodingParameters coding;
    coding.plane_trees = coding.prediction = true;
    for (int planes = 1; planes <= 4; ++planes) {
        const auto got =
            read_coding_parameters(write_coding_parameters(coding, planes, false), planes, false);
        EXPECT_EQ(got.ok(), planes == 2) << planes;
        EXPECT_TRUE(!got || got->plane_trees);
    }
    coding.prediction = false;
    EXPECT_FALSE(read_coding_parameters(write_coding_parameters(coding, 2, false), 2, false));
}

TEST(CodingParameters, AcceptsTheLargestOffsetsAndAllFlags) {
    constexpr std::size_t offsets = 12, flags = 0; // after 5 steps
    CodingParameters coding;
    coding.colour_rotation = coding.prediction = coding.dependent = coding.smooth_copies = true;
    coding.leaves_out_transforms = coding.transforms_any_plane = true;
    coding.base = {.on = true, .margin = 1, .v_against_u = true};
    coding.filter.ring[1][2] = {-127, 255};
    Bytes bytes = write_all(coding);
    coding.scan_weights[0] = 1;
    coding.parameters[0] ^= 1;
    const Bytes all = write_all(coding);
    EXPECT_TRUE(read_all(all));
    EXPECT_EQ(all[flags], std::byte{255});
    EXPECT_EQ(all[flags + 1], std::byte{13});
    for (std::size_t i = offsets; i < offsets + 4; ++i) {
        bytes[i] = std::byte{32};
        EXPECT_FALSE(read_all(bytes));
        bytes[i] = std::byte{31};
        EXPECT_TRUE(read_all(bytes));
    }
}

TEST(CodingParameters, FiltersHaveARangeAndAnEffect) {
    constexpr std::size_t rings = 16;
    CodingParameters coding;
    coding.filter.ring[1][2] = {-127, 255};
    const Bytes bytes = write_all(coding);
    EXPECT_EQ(bytes.size(), write_all({}).size() + 12);
    const Result<CodingParameters> got = read_all(bytes);
    ASSERT_TRUE(got) << got.status().message();
    EXPECT_EQ(got->filter, coding.filter);
    const auto expect_refused = [&](std::size_t at, int value, const char* why) {
        Bytes changed = bytes;
        changed[at] = static_cast<std::byte>(value);
        EXPECT_FALSE(read_all(changed)) << why;
    };
    expect_refused(rings, 128, "strength -128");
    expect_refused(rings + 1, 0, "reach 0");
    expect_refused(rings + 10, 0, "no ring has a strength");
}

TEST(CodingParameters, DamageIsRefusedOrHarmless) {
    Random random(10);
    const Bytes bytes = write_all(random_coding_parameters(random, 0.3));
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        const Result<CodingParameters> got = read_all(cut);
        if (got)
            expect_in_range(*got);
        else
            ASSERT_EQ(got.status().code(), ErrorCode::invalid_file);
        // Half a word or a missing field is always detected.
        ASSERT_TRUE(!got || (length % 2 == bytes.size() % 2 && length >= 19)) << length;
    }
    for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
        Bytes flipped = bytes;
        flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
        if (const Result<CodingParameters> got = read_all(flipped))
            expect_in_range(*got);
    }
    for (int round = 0; round < 500; ++round)
        if (const auto got = read_all(random.bytes(static_cast<std::size_t>(random.range(0, 400)))))
            expect_in_range(*got);
}

} // namespace
} // namespace tessera::test
