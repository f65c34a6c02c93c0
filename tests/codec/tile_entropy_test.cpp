// Entropy coding of levels, and payloads that no encoder writes.
#include "codec/entropy/context_grid.h"
#include "codec/entropy/corrections.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "tests/support/format_values.h"
#include "tests/support/random.h"
#include "tests/support/random_codes.h"
#include "tests/support/random_tile.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::random_codes;

void expect_same(const TileLevels& got, const TileLevels& want) {
    ASSERT_EQ(got.shape, want.shape);
    ASSERT_EQ(got.splits, want.splits);
    ASSERT_EQ(got.colours, want.colours);
    ASSERT_EQ(got.blocks.size(), want.blocks.size());
    for (std::size_t b = 0; b < want.blocks.size(); ++b) {
        ASSERT_EQ(got.blocks[b].origin, want.blocks[b].origin);
        ASSERT_EQ(got.blocks[b].shape, want.blocks[b].shape);
    }
    ASSERT_EQ(got.planes.size(), want.planes.size());
    for (std::size_t p = 0; p < want.planes.size(); ++p) {
        ASSERT_EQ(got.planes[p].coded_length, want.planes[p].coded_length) << "plane " << p;
        const auto a = got.levels(got.planes[p]), b = want.levels(want.planes[p]);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            ASSERT_EQ(a[i].index, b[i].index);
            ASSERT_EQ(a[i].level, b[i].level);
        }
    }
}

const std::vector<BlockShape> shapes = {
    shape_of(1, 1, 1, 1),   shape_of(7, 5, 3, 2),   shape_of(17, 9, 5, 3),
    shape_of(32, 32, 8, 8), shape_of(8, 8, 8, 8),   shape_of(31, 3, 13, 2),
    shape_of(16, 16, 4, 4), shape_of(32, 32, 1, 1), shape_of(2, 1, 31, 32)};

TEST(TileEntropy, RandomTilesRoundTrip) {
    Random random(21);
    std::size_t segments = 0;
    ContextGrid grid; // shared, because tiles must leave it clear
    for (const BlockShape& shape : shapes)
        for (int planes = 1; planes <= max_planes; ++planes)
            for (int round = 0; round < 6; ++round) {
                const TileCoding coding(parameters_with(random, planes >= 3 && round % 2 == 0),
                                        SampleType::unorm8, planes);
                const RandomTileOptions options{.split = std::array{0.0, 0.6, 0.9}[round % 3],
                                                .density = round % 4 == 0 ? 1 : random.unit() * 0.4,
                                                .empty = 0.5 * random.unit(),
                                                .magnitude_bits = round == 5 ? 20 : 1 + round,
                                                .full_length = round % 4 == 0};
                const TileLevels want = RandomTile(random, coding, options).make(shape);
                Bytes payload;
                encode_levels(want, {}, coding, payload);
                PayloadParts parts;
                ASSERT_TRUE(split_payload(payload, shape.texels(), parts));
                segments = std::max(segments, parts.segments.size());
                TileLevels got;
                const Status status = decode_levels(parts, shape, coding, grid, got);
                ASSERT_TRUE(status) << name_of(shape) << " planes " << planes << " round " << round
                                    << ": " << status.message();
                ASSERT_NO_FATAL_FAILURE(expect_same(got, want))
                    << name_of(shape) << " planes " << planes << " round " << round;
            }
    EXPECT_GE(segments, 5u); // the large tiles exercise the segment table
}

// Every coded length round-trips, including those limited by the scan order.
TEST(TileEntropy, EveryCodedLengthRoundTrips) {
    Random random(22);
    const TileCoding coding(CodingParameters{}, SampleType::unorm8, 1);
    for (const BlockShape& shape :
         {shape_of(1, 1, 1, 1), shape_of(3, 1, 1, 1), shape_of(5, 1, 1, 1), shape_of(7, 5, 3, 1),
          shape_of(7, 1, 1, 1), shape_of(13, 7, 1, 1), shape_of(9, 5, 3, 2), shape_of(31, 3, 3, 1)})
        for (int last = 0; last < shape.texels(); ++last) {
            TileLevels want;
            want.shape = shape;
            want.splits = {0};
            want.blocks = {Block{{0, 0, 0, 0}, shape, 0, 0}};
            want.colours.resize(1);
            want.nonzeros = {{static_cast<std::uint16_t>(last), -3}};
            const int length = round_up_coded_length(last + 1, coding.shape(shape).order.length());
            ASSERT_GT(length, last);
            PlaneLevels plane;
            plane.count = 1;
            plane.coded_length = static_cast<std::uint16_t>(length);
            want.planes = {plane};
            Bytes payload;
            encode_levels(want, {}, coding, payload);
            ContextGrid grid;
            TileLevels got;
            PayloadParts parts;
            ASSERT_TRUE(split_payload(payload, shape.texels(), parts));
            const Status status = decode_levels(parts, shape, coding, grid, got);
            ASSERT_TRUE(status) << name_of(shape) << " last " << last << ": " << status.message();
            ASSERT_NO_FATAL_FAILURE(expect_same(got, want)) << name_of(shape) << " last " << last;
        }
}

// Splits a block along u and v, then along s and t, into leaves of at most `texels` texels.
void add_leaves(const Block& block, int texels, TileLevels& tile) {
    const Split split = block.shape.texels() <= texels           ? Split::none
                        : can_split(block.shape, Split::spatial) ? Split::spatial
                                                                 : Split::angular;
    tile.splits.push_back(static_cast<std::uint8_t>(split));
    if (split == Split::none) {
        tile.blocks.push_back(block);
        return;
    }
    const Children children = children_of(block, split);
    for (int i = 0; i < children.count; ++i)
        add_leaves(children.block[static_cast<std::size_t>(i)], texels, tile);
}

// The largest work of any segment of the coded tile.
std::size_t most_work(const TileLevels& tile, const TileCoding& coding) {
    Bytes payload;
    encode_levels(tile, {}, coding, payload);
    PayloadParts parts;
    EXPECT_TRUE(split_payload(payload, tile.shape.texels(), parts));
    const auto planes = static_cast<std::size_t>(coding.planes);
    std::size_t block = 0, most = 0;
    for (std::size_t i = 0; i < parts.segments.size(); ++i) {
        const std::size_t end = i + 1 < parts.segments.size()
                                    ? static_cast<std::size_t>(parts.segments[i + 1].first_block)
                                    : tile.blocks.size();
        std::size_t work = i == 0 ? tile.splits.size() : 0;
        for (; block < end; ++block)
            for (std::size_t plane = 0; plane < planes; ++plane)
                work += 1u + tile.planes[block * planes + plane].coded_length;
        most = std::max(most, work);
    }
    EXPECT_EQ(block, tile.blocks.size());
    return most;
}

TEST(TileEntropy, SegmentsKeepTheWorkLimit) {
    Random random(23);
    const TileCoding coding(parameters_with(random, true), SampleType::unorm8, 4);
    for (const double split : {0.5, 0.95}) {
        const RandomTileOptions options{
            .split = split, .density = 0.02, .empty = 0, .full_length = true};
        const TileLevels tile = RandomTile(random, coding, options).make(shape_of(32, 32, 8, 8));
        EXPECT_LE(most_work(tile, coding), static_cast<std::size_t>(max_segment_work));
    }
}

// Nearly all coefficients are coded. Segments of the usual work would exceed the segment table of a
// large tile.
TEST(TileEntropy, SegmentsOfLargeTilesFitTheirTable) {
    Random random(24);
    const TileCoding coding(parameters_with(random, false), SampleType::unorm8, 4);
    const BlockShape shape = shape_of(64, 64, 8, 12);
    TileLevels tile;
    tile.shape = shape;
    add_leaves(Block{{0, 0, 0, 0}, shape, 0, 0}, 512, tile);
    for (const Block& block : tile.blocks) {
        const int last = coding.shape(block.shape).order.length() - 1;
        tile.colours.emplace_back();
        for (int plane = 0; plane < 4; ++plane) {
            tile.planes.push_back({static_cast<std::uint32_t>(tile.nonzeros.size()), 1,
                                   static_cast<std::uint16_t>(last + 1)});
            tile.nonzeros.push_back({static_cast<std::uint16_t>(last), 1});
        }
    }
    const std::size_t most = most_work(tile, coding);
    EXPECT_GT(most, static_cast<std::size_t>(usual_segment_work));
    EXPECT_LE(most, static_cast<std::size_t>(max_segment_work));
}

// One block codes 4096 coefficients in each of four planes. The stream is valid except that a
// segment exceeds the work limit.
TEST(TileEntropy, TooMuchWorkIsRefused) {
    const TileCoding coding(CodingParameters{}, SampleType::unorm8, 4);
    const BlockShape shape = shape_of(16, 16, 8, 2);
    TileLevels tile;
    tile.shape = shape;
    tile.splits = {0};
    tile.blocks = {Block{{0, 0, 0, 0}, shape, 0, 0}};
    tile.colours.resize(1);
    for (std::uint32_t plane = 0; plane < 4; ++plane) {
        tile.nonzeros.push_back({4095, 1});
        PlaneLevels levels;
        levels.first = plane;
        levels.count = 1;
        levels.coded_length = 4096;
        tile.planes.push_back(levels);
    }
    Bytes payload;
    encode_levels(tile, {}, coding, payload);
    PayloadParts parts;
    ASSERT_TRUE(split_payload(payload, shape.texels(), parts));
    ContextGrid grid;
    TileLevels got;
    EXPECT_EQ(decode_levels(parts, shape, coding, grid, got).code(), ErrorCode::invalid_file);
}

TEST(TileEntropy, EmptyPayloadIsBackground) {
    for (int planes = 1; planes <= 4; ++planes) {
        const TileCoding coding(CodingParameters{}, SampleType::unorm8, planes);
        const ColourCoding colour{
            {{7, 5, 3, 2}, SampleType::unorm8, static_cast<std::uint8_t>(planes)},
            planes >= 3 ? ColourTransform::ycocg_r : ColourTransform::none,
            {10, 200, 30, 40}};
        const BlockShape shape = shape_of(7, 5, 3, 2);
        Bytes texels(static_cast<std::size_t>(shape.texels() * planes));
        TileDecoder decoder(coding, colour);
        ASSERT_TRUE(decoder.decode({}, shape, texels));
        for (std::size_t i = 0; i < texels.size(); ++i)
            ASSERT_EQ(std::to_integer<int>(texels[i]),
                      colour.background[i % static_cast<std::size_t>(planes)]);
    }
}

// Runs the whole decoder on a payload: segments, levels, reconstruction and corrections.
class HostileDecoder {
public:
    HostileDecoder(Random& random, int planes, SampleType type)
        : coding_(parameters(random), type, planes),
          colour_{{{1, 1, 1, 1}, type, static_cast<std::uint8_t>(planes)},
                  planes >= 3 ? ColourTransform::ycocg_r : ColourTransform::none,
                  {1, 2, 3, 4},
                  true},
          decoder_(coding_, colour_) {}

    const TileCoding& coding() const { return coding_; }
    bool run(std::span<const std::byte> payload, const BlockShape& shape) {
        // A copy of the exact size lets the address sanitizer detect reads past the end.
        const std::unique_ptr<std::byte[]> exact(new std::byte[payload.size()]);
        std::copy(payload.begin(), payload.end(), exact.get());
        texels_.assign(static_cast<std::size_t>(shape.texels()) * colour_.desc.texel_bytes(),
                       std::byte{});
        const Status status = decoder_.decode({exact.get(), payload.size()}, shape, texels_);
        EXPECT_TRUE(status || status.code() == ErrorCode::invalid_file) << status.message();
        EXPECT_TRUE(status || !status.message().empty());
        return status.ok();
    }

private:
    static CodingParameters parameters(Random& random) {
        CodingParameters p = parameters_with(random, true);
        p.correction_error = 1;
        if (random.chance(0.3))
            p.step.fill({static_cast<std::uint16_t>(((max_step_exponent + 1) << 11) - 1)});
        return p;
    }
    const TileCoding coding_;
    const ColourCoding colour_;
    TileDecoder decoder_;
    Bytes texels_;
};

TEST(HostileTile, RandomBytesAreHandledSafely) {
    Random random(25);
    int accepted = 0;
    for (int round = 0; round < 3000; ++round) {
        HostileDecoder decoder(random, random.range(1, 4),
                               random.chance(0.5) ? SampleType::unorm8 : SampleType::half16);
        const BlockShape& shape = shapes[random() % shapes.size()];
        Bytes payload =
            random.bytes(static_cast<std::size_t>(random.range(0, round % 5 ? 60 : 3000)));
        if (!payload.empty() && random.chance(0.5))
            payload[0] = static_cast<std::byte>(random.chance(0.5) ? 128 : random.range(0, 3));
        if (payload.size() > 4 && random.chance(0.3)) // plausible table entries
            payload[2] = payload[4] = std::byte{0};
        accepted += decoder.run(payload, shape);
    }
    EXPECT_LT(accepted, 1500);
}

TEST(HostileTile, TruncationsAndFlipsAreHandledSafely) {
    Random random(26);
    int flips = 0, missed_flips = 0, cuts = 0, missed_cuts = 0;
    for (int round = 0; round < 8; ++round) {
        HostileDecoder decoder(random, 1 + round % 4,
                               round < 4 ? SampleType::unorm8 : SampleType::half16);
        const BlockShape shape = shape_of(7, 6, 5, 4);
        const int planes = decoder.coding().planes;
        const TileLevels tile = RandomTile(random, decoder.coding(),
                                           {.split = 0.4, .density = 0.05, .magnitude_bits = 12})
                                    .make(shape);
        CorrectionMap map(static_cast<std::size_t>(shape.texels() * planes));
        for (std::int32_t& k : map)
            k = random.chance(0.05) ? random.range(-3, 3) : 0;
        Bytes payload;
        encode_levels(tile, encode_corrections(map, shape, planes, decoder.coding().tables),
                      decoder.coding(), payload);
        ASSERT_TRUE(decoder.run(payload, shape));
        for (std::size_t length = 0; length < payload.size(); ++length) {
            ++cuts;
            missed_cuts += decoder.run(std::span(payload).first(length), shape);
        }
        for (std::size_t bit = 0; bit < payload.size() * 8; bit += 1 + random() % 3) {
            Bytes flipped = payload;
            flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
            ++flips;
            missed_flips += decoder.run(flipped, shape);
        }
    }
    // The final coder state detects nearly all damage. Flips of raw bits only change a level.
    EXPECT_LE(missed_cuts, cuts / 50);
    EXPECT_LE(missed_flips, flips / 4);
}

// Levels of the largest magnitude with the coarsest steps saturate or wrap without undefined
// behaviour.
TEST(HostileTile, LargestLevelsAreDefined) {
    Random random(27);
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        CodingParameters parameters;
        parameters.step.fill({static_cast<std::uint16_t>(((max_step_exponent + 1) << 11) - 1)});
        parameters.rotated_step = parameters.step[0];
        parameters.colour_rotation = true;
        const TileCoding coding(parameters, type, 4);
        for (const BlockShape& shape : {shape_of(32, 32, 8, 8), shape_of(7, 5, 3, 2)}) {
            TileLevels tile =
                RandomTile(random, coding,
                           {.split = 0.3, .density = 1, .empty = 0, .full_length = true})
                    .make(shape);
            for (NonZero& nz : tile.nonzeros)
                nz.level = nz.level < 0 ? -max_level : max_level; // not dependent: all are allowed
            const ColourCoding colour{
                {{1, 1, 1, 1}, type, 4}, ColourTransform::ycocg_r, {0, 0, 0, 0}};
            TileDecoder decoder(coding, colour);
            Bytes texels(static_cast<std::size_t>(shape.texels()) * colour.desc.texel_bytes());
            decoder.render(tile, {}, texels);
            Bytes payload;
            encode_levels(tile, {}, coding, payload);
            Bytes again(texels.size());
            ASSERT_TRUE(decoder.decode(payload, shape, again));
            EXPECT_EQ(texels, again);
        }
    }
}

} // namespace
} // namespace tessera::test
