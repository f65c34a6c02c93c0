// Tests the decoder's shaders, compiled as C++, with arbitrary bytes: they refuse what the CPU refuses,
// end, and stay inside their buffers.
#include "tests/support/format_values.h"
#include "tests/support/random_predictions.h"
#include "tests/support/random_tile.h"
#include "tests/support/shader_oracle.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

// Textures of one or two tiles, small enough to be decoded thousands of times. Some have
// corrections and some predictions, because no file has both.
std::vector<std::unique_ptr<ShaderOracle>> small_files() {
    struct File {
        TextureDesc desc;
        Extent4 tile;
    };
    std::vector<std::unique_ptr<ShaderOracle>> files;
    unsigned number = 0;
    for (const File& file : {File{{{7, 5, 3, 2}, SampleType::unorm8, 3}, {7, 5, 3, 2}},
                             File{{{9, 4, 3, 4}, SampleType::half16, 4}, {5, 4, 3, 4}},
                             File{{{1, 1, 1, 1}, SampleType::unorm8, 2}, {1, 1, 1, 1}},
                             File{{{2, 3, 17, 5}, SampleType::unorm8, 1}, {2, 3, 17, 5}},
                             File{{{41, 2, 3, 2}, SampleType::unorm8, 3}, {64, 2, 3, 2}},
                             File{{{19, 14, 1, 1}, SampleType::half16, 3}, {19, 14, 1, 1}},
                             File{{{21, 14, 1, 1}, SampleType::unorm8, 2}, {21, 14, 1, 1}},
                             File{{{11, 18, 1, 1}, SampleType::half16, 2}, {11, 18, 1, 1}},
                             File{{{70, 5, 1, 1}, SampleType::unorm8, 4}, {70, 5, 1, 1}}}) {
        Random random(++number);
        CodingParameters parameters;
        parameters.parameters = random_parameters(random);
        parameters.colour_rotation = true;
        parameters.dependent = number % 2 == 1;
        parameters.correction_error = static_cast<std::uint16_t>(number);
        if (number > 2)
            parameters.filter = random_filter(random);
        files.push_back(
            std::make_unique<ShaderOracle>(empty_file(file.desc, file.tile, parameters, true)));
        parameters.prediction = true;
        parameters.leaves_out_transforms = number % 3 != 0;
        parameters.transforms_any_plane = number % 2 == 1;
        parameters.plane_trees = file.desc.channels == 2;
        parameters.smooth_copies = number % 4 >= 2;
        parameters.base = {.on = number % 2 == 0, .margin = 3, .v_against_u = number % 4 == 0};
        files.push_back(
            std::make_unique<ShaderOracle>(empty_file(file.desc, file.tile, parameters, false)));
    }
    return files;
}

Bytes random_payload(Random& random, const ShaderOracle& file, std::uint64_t tile = 0) {
    const BlockShape shape = file.shape_of_tile(tile);
    const TileCoding& coding = file.coding();
    CorrectionMap map(static_cast<std::size_t>(shape.texels() * coding.planes));
    for (std::int32_t& multiplier : map)
        multiplier = random.chance(0.05) ? random.range(-3, 3) : 0;
    const double split = coding.predicts ? 0.8 : 0.5;
    const RandomTileOptions options{.split = split, .density = 0.05, .magnitude_bits = 12};
    const TileLevels levels = coding.predicts
                                  ? random_predicted_tile(random, coding, options, shape, 0.7)
                                  : RandomTile(random, coding, options).make(shape);
    Bytes payload;
    encode_levels(levels,
                  coding.predicts ? std::vector<Bytes>()
                                  : encode_corrections(map, shape, coding.planes, coding.tables),
                  coding, payload);
    return payload;
}

TEST(ShaderBytes, RandomBytesAreRefusedOrDecodedAsOnTheCpu) {
    Random random(11);
    std::uint64_t accepted = 0, refused = 0;
    for (const auto& file : small_files()) {
        for (int i = 0; i < 1500; ++i) {
            std::vector<Bytes> payload{random.bytes(static_cast<std::size_t>(random.range(0, 64)))};
            if (i % 3 == 0 && !payload[0].empty()) // makes a valid table more likely
                payload[0][0] &= std::byte{0x81};
            ASSERT_EQ(file->check(payload, {i % 4 < 2}), "") << "case " << i;
        }
        EXPECT_LE(file->most_rounds(), shader_round_limit);
        accepted += file->accepted(), refused += file->refused();
    }
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, 0u);
}

TEST(ShaderBytes, CutOffPayloadsAreRefusedOrDecodedAsOnTheCpu) {
    Random random(12);
    for (const auto& file : small_files()) {
        const Bytes whole = random_payload(random, *file);
        ASSERT_EQ(file->check_one(whole), "");
        EXPECT_EQ(file->accepted(), 1u);
        for (std::size_t length = 0; length < whole.size(); ++length) {
            const auto end = whole.begin() + static_cast<std::ptrdiff_t>(length);
            ASSERT_EQ(file->check_one(Bytes(whole.begin(), end)), "") << length;
        }
    }
}

TEST(ShaderBytes, EveryFlippedBitIsRefusedOrDecodedAsOnTheCpu) {
    Random random(13);
    std::uint64_t accepted = 0, refused = 0;
    for (const auto& file : small_files()) {
        const Bytes whole = random_payload(random, *file);
        const std::size_t step = 1 + whole.size() / 250; // every byte of short payloads
        for (std::size_t at = 0; at < whole.size(); at += at < 64 ? 1 : step)
            for (int bit = 0; bit < 8; ++bit) {
                std::vector<Bytes> payload{whole};
                payload[0][at] ^= static_cast<std::byte>(1 << bit);
                ASSERT_EQ(file->check(payload, {}), "") << at << " bit " << bit;
            }
        accepted += file->accepted(), refused += file->refused();
    }
    EXPECT_GT(accepted, 0u); // flipped raw bits remain valid
    EXPECT_GT(refused, accepted);
}

// Changes every word before the payloads, and up to a handful at once, to offsets, counts and
// records that no host writes.
TEST(ShaderBytes, ChangedBatchesEndAndStayInsideTheirBuffers) {
    constexpr std::uint64_t patience = 300000;
    Random random(14);
    for (const auto& file : small_files()) {
        std::vector<Bytes> payloads;
        for (std::uint64_t tile = 0; tile < file->reader().tile_count(); ++tile)
            payloads.push_back(random_payload(random, *file, tile));
        std::size_t records = 0;
        const auto note_records = [&](auto words) { records = words[shaders::tsr_b_payload_at]; };
        ASSERT_EQ(file->check_changed(payloads, {}, note_records, patience), "");
        const std::size_t step = 1 + records / 40; // every word, except where many blocks repeat
        for (std::size_t at = 0; at < records; at += at < 96 ? 1 : step)
            for (const std::uint32_t value :
                 {0u, 1u, 7u, 13758u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu}) {
                const auto change = [&](auto words) { words[at] = value; };
                ASSERT_EQ(file->check_changed(payloads, {true}, change, patience), "")
                    << "word " << at << " is " << value;
            }
        for (int i = 0; i < 60; ++i) {
            const auto change = [&](auto words) {
                for (int n = random.range(2, 8); n > 0; --n)
                    words[random() % records] = random() >> random.range(0, 31);
            };
            ASSERT_EQ(file->check_changed(payloads, {i % 2 == 0}, change, patience), "") << i;
        }
    }
}

} // namespace
} // namespace tessera::test
