// Levels and corrections of a tile to bytes and back, and what damaged bytes do.
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/entropy/corrections.h"
#include "codec/fit/table_fit.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/entropy/tile_entropy.h"
#include "codec/entropy/tile_syntax.h"
#include "tests/support/codec_test_support.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

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

CodingParameters parameters_with(Random& random, bool rotation) {
    CodingParameters parameters;
    for (StepCode& step : parameters.step)
        step = StepCode::nearest(1 + 20 * random.unit());
    parameters.rotated_step = parameters.step[0];
    parameters.colour_rotation = rotation;
    parameters.dependent = random.chance(0.5);
    parameters.parameters = random.chance(0.3) ? random_parameters(random) : default_parameters();
    return parameters;
}

const std::vector<BlockShape> shapes = {
    shape_of(1, 1, 1, 1),   shape_of(7, 5, 3, 2),   shape_of(17, 9, 5, 3),
    shape_of(32, 32, 8, 8), shape_of(8, 8, 8, 8),   shape_of(31, 3, 13, 2),
    shape_of(16, 16, 4, 4), shape_of(32, 32, 1, 1), shape_of(2, 1, 31, 32)};

TEST(TileEntropy, RandomTilesRoundTrip) {
    Random random(21);
    std::size_t segments = 0;
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
                const Status status = decode_levels(parts, shape, coding, got);
                ASSERT_TRUE(status) << name_of(shape) << " planes " << planes << " round " << round
                                    << ": " << status.message();
                ASSERT_NO_FATAL_FAILURE(expect_same(got, want))
                    << name_of(shape) << " planes " << planes << " round " << round;
            }
    EXPECT_GE(segments, 5u); // the large tiles exercise the segment table
}

// Every coded length of every block size comes back, those that the scan order cuts above all.
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
            want.colours = {0};
            want.nonzeros = {{static_cast<std::uint16_t>(last), -3}};
            const int length = round_up_coded_length(last + 1, coding.shape(shape).order.length());
            ASSERT_GT(length, last);
            PlaneLevels plane;
            plane.count = 1;
            plane.coded_length = static_cast<std::uint16_t>(length);
            want.planes = {plane};
            Bytes payload;
            encode_levels(want, {}, coding, payload);
            TileLevels got;
            PayloadParts parts;
            ASSERT_TRUE(split_payload(payload, shape.texels(), parts));
            const Status status = decode_levels(parts, shape, coding, got);
            ASSERT_TRUE(status) << name_of(shape) << " last " << last << ": " << status.message();
            ASSERT_NO_FATAL_FAILURE(expect_same(got, want)) << name_of(shape) << " last " << last;
        }
}

TEST(TileEntropy, SegmentsKeepTheWorkLimit) {
    Random random(23);
    const TileCoding coding(parameters_with(random, true), SampleType::unorm8, 4);
    const BlockShape shape = shape_of(32, 32, 8, 8);
    for (const double split : {0.5, 0.95}) {
        const TileLevels tile =
            RandomTile(random, coding,
                       {.split = split, .density = 0.02, .empty = 0, .full_length = true})
                .make(shape);
        Bytes payload;
        encode_levels(tile, {}, coding, payload);
        PayloadParts parts;
        ASSERT_TRUE(split_payload(payload, shape.texels(), parts));
        std::size_t block = 0;
        for (std::size_t i = 0; i < parts.segments.size(); ++i) {
            const std::size_t end =
                i + 1 < parts.segments.size()
                    ? static_cast<std::size_t>(parts.segments[i + 1].first_block)
                    : tile.blocks.size();
            std::size_t work = i == 0 ? tile.splits.size() : 0;
            for (; block < end; ++block)
                for (std::size_t plane = 0; plane < 4; ++plane)
                    work += 1u + tile.planes[block * 4 + plane].coded_length;
            EXPECT_LE(work, static_cast<std::size_t>(max_segment_work)) << "segment " << i;
        }
        EXPECT_EQ(block, tile.blocks.size());
    }
}

// A tile made to be long: every leaf of 16 texels is coded in full. Merging its segments into one
// gives a valid stream that only its length makes invalid.
TEST(TileEntropy, TooMuchWorkIsRefused) {
    const TileCoding coding(CodingParameters{}, SampleType::unorm8, 4);
    const BlockShape shape = shape_of(16, 16, 8, 2);
    TileLevels tile;
    tile.shape = shape;
    tile.splits = {0};
    tile.blocks = {Block{{0, 0, 0, 0}, shape, 0, 0}};
    tile.colours = {0};
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
    TileLevels got;
    EXPECT_EQ(decode_levels(parts, shape, coding, got).code(), ErrorCode::invalid_file);
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

TEST(TableFit, FittedTablesBeatOthers) {
    Random random(24);
    CodingParameters parameters = parameters_with(random, false);
    parameters.parameters = default_parameters();
    const TileCoding before(parameters, SampleType::unorm8, 3);
    const TileLevels tile =
        RandomTile(random, before, {.split = 0.7, .density = 0.1}).make(shape_of(32, 32, 8, 8));
    Statistics statistics;
    count_symbols(tile, before, statistics);
    const auto size_with = [&](const Parameters& tables) {
        parameters.parameters = tables;
        Bytes payload;
        encode_levels(tile, {}, TileCoding(parameters, SampleType::unorm8, 3), payload);
        return payload.size();
    };
    const std::size_t fitted = size_with(fit_parameters(statistics));
    EXPECT_LT(fitted, size_with(default_parameters()));
    EXPECT_LT(fitted, size_with(random_parameters(random)));
}

// ---------------------------------------------------------------- damage

// ---------------------------------------------------------------- choosing levels

// Adds up the ideal bits of what a walk codes.
struct BitCounter {
    const BitCosts& costs;
    double bits = 0;

    void split(int, int, int) {}
    void first_length(int size, int token) {
        bits += costs.first_length[static_cast<std::size_t>(size)][static_cast<std::size_t>(token)];
    }
    void other_length(int previous, int token) {
        bits +=
            costs.other_length[static_cast<std::size_t>(previous)][static_cast<std::size_t>(token)];
    }
    void colour(bool, int) {}
    void zero(int parameter, bool is_zero) {
        bits += costs.zero[static_cast<std::size_t>(parameter)][is_zero ? 0 : 1];
    }
    void magnitude(int table, int token) {
        bits += costs.magnitude[static_cast<std::size_t>(table)][static_cast<std::size_t>(token)];
    }
    void raw(std::uint32_t, int) {} // in the costs of what they belong to
};

// One block and one way to quantise it.
class QuantizerTrial {
public:
    QuantizerTrial(const BlockShape& shape, int planes, bool dependent)
        : coding_(parameters(dependent), SampleType::unorm8, planes), costs_(coding_.tables) {
        block_.shape = shape;
        for (auto& plane : block_.plane)
            plane.resize(static_cast<std::size_t>(shape.texels()));
    }

    // Falling with the frequency, Laplacian; in sample units with a step of 8.
    void fill(Random& random, double gain) {
        const ScanOrder& order = coding_.shape(block_.shape).order;
        const auto& n = block_.shape.n;
        for (int plane = 0; plane < coding_.planes; ++plane)
            for (int i = 0; i < order.length(); ++i) {
                const auto& k = order.entry[static_cast<std::size_t>(i)].k;
                const double x = gain * std::log(1 - random.unit()) / (1 + 0.2 * i);
                block_.plane[static_cast<std::size_t>(plane)][static_cast<std::size_t>(
                    ((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] =
                    static_cast<float>(random.chance(0.5) ? x : -x);
            }
    }

    // Quantises; the cost that the quantiser reports.
    double run() {
        tile_.clear();
        tile_.shape = block_.shape;
        tile_.splits = {0};
        tile_.blocks = {Block{{0, 0, 0, 0}, block_.shape, 0, 0}};
        return BlockQuantizer(coding_, costs_, {}).quantize(block_, tile_);
    }
    // Squared error against that of zeros, plus lambda times the bits, of the tile's levels.
    double cost_of(const TileLevels& tile) const {
        BitCounter counter{costs_};
        TileWalker(coding_, counter).walk_block(tile, 0);
        double cost = QuantizerOptions{}.lambda * counter.bits;
        const ScanOrder& order = coding_.shape(block_.shape).order;
        const auto& n = block_.shape.n;
        for (int plane = 0; plane < coding_.planes; ++plane)
            for (const NonZero& nz : tile.levels(tile.planes[static_cast<std::size_t>(plane)])) {
                const auto& k = order.entry[nz.index].k;
                const double x =
                    block_.plane[static_cast<std::size_t>(plane)][static_cast<std::size_t>(
                        ((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] /
                    8;
                const double value = nz.level * (coding_.parameters.dependent ? 0.5 : 1.0);
                cost += (x - value) * (x - value) - x * x;
            }
        return cost;
    }
    const TileLevels& tile() const { return tile_; }
    TileLevels no_levels() const {
        TileLevels none = tile_;
        none.nonzeros.clear();
        for (PlaneLevels& plane : none.planes)
            plane = {};
        return none;
    }
    // Of the first plane, as far as the chosen ones go: what dependent levels are without a plan.
    TileLevels nearest_levels() const {
        TileLevels tile = no_levels();
        const ScanOrder& order = coding_.shape(block_.shape).order;
        const auto& n = block_.shape.n;
        int state = 0;
        for (int i = 0; i < tile_.planes[0].coded_length; ++i) {
            const auto& k = order.entry[static_cast<std::size_t>(i)].k;
            const double x = block_.plane[0][static_cast<std::size_t>(
                                 ((k[3] * n[2] + k[2]) * n[1] + k[1]) * n[0] + k[0])] /
                             4; // half steps
            const int quantiser = quantiser_of(state);
            const int magnitude =
                static_cast<int>(std::max(0.0, (std::fabs(x) + quantiser) / 2 + 0.4));
            if (magnitude > 0) {
                const int level = 2 * magnitude - quantiser;
                tile.nonzeros.push_back({static_cast<std::uint16_t>(i), x < 0 ? -level : level});
            }
            state = next_state[static_cast<std::size_t>(state)]
                              [static_cast<std::size_t>(magnitude & 1)];
        }
        tile.planes[0].count = static_cast<std::uint16_t>(tile.nonzeros.size());
        if (!tile.nonzeros.empty())
            tile.planes[0].coded_length = static_cast<std::uint16_t>(
                round_up_coded_length(tile.nonzeros.back().index + 1, order.length()));
        return tile;
    }

private:
    static CodingParameters parameters(bool dependent) {
        CodingParameters p;
        p.step.fill(StepCode::nearest(8));
        p.rotated_step = p.step[0];
        p.dependent = dependent;
        return p;
    }
    const TileCoding coding_;
    const BitCosts costs_;
    BlockCoefficients block_;
    TileLevels tile_;
};

// What the quantiser believes its levels cost is what they cost.
TEST(BlockQuantizer, ReportsTheCostOfItsLevels) {
    for (const bool dependent : {false, true}) {
        Random random(31);
        double reported = 0, real = 0;
        for (int round = 0; round < 60; ++round) {
            QuantizerTrial trial(shape_of(8, 6, 4, 3), 1 + round % 4, dependent);
            trial.fill(random, 4 << (round % 6));
            const double now = trial.run();
            const double cost = trial.cost_of(trial.tile());
            reported += now;
            real += cost;
            // Paths that meet later than the window have seen each other's contexts, and a coded
            // length may end behind levels that turned out to be zeros.
            ASSERT_NEAR(now, cost, (dependent ? 0.01 : 1e-3) * std::fabs(cost) + 0.5) << round;
        }
        EXPECT_NEAR(reported, real, 2e-3 * std::fabs(real));
    }
}

// Looking ahead costs less than taking, coefficient by coefficient, the nearest level that the state
// allows, and than nothing.
TEST(BlockQuantizer, LookingAheadPays) {
    Random random(32);
    double ahead = 0, nearest = 0;
    for (int round = 0; round < 60; ++round) {
        const BlockShape shape = round % 2 == 0 ? shape_of(8, 8, 4, 4) : shape_of(16, 4, 3, 5);
        QuantizerTrial trial(shape, 1, true);
        trial.fill(random, 8 << (round % 5));
        trial.run();
        const double cost = trial.cost_of(trial.tile());
        const double greedy = trial.cost_of(trial.nearest_levels());
        ASSERT_LE(cost, greedy + 0.3) << round; // what choices do to later contexts is not foreseen
        ASSERT_LE(cost, trial.cost_of(trial.no_levels()) + 1e-3) << round;
        ahead += cost;
        nearest += greedy;
    }
    EXPECT_LT(ahead, nearest - 60 * 0.5);
}

// Every level sequence of a few coefficients, against the one chosen.
TEST(BlockQuantizer, IsNearTheBestSequenceOfSmallBlocks) {
    Random random(33);
    for (const bool dependent : {false, true})
        for (int round = 0; round < 40; ++round) {
            QuantizerTrial trial(shape_of(2, 2, 1, 1), 1, dependent);
            trial.fill(random, 24);
            trial.run();
            const double chosen = trial.cost_of(trial.tile());
            double best = 1e30;
            constexpr int most = 4; // magnitudes
            const int signs = 2 * most + 1;
            for (int code = 0; code < signs * signs * signs * signs; ++code) {
                TileLevels tile = trial.tile();
                tile.nonzeros.clear();
                int state = 0, rest = code;
                for (int i = 0; i < 4; ++i, rest /= signs) {
                    const int x = rest % signs - most, magnitude = std::abs(x);
                    const int level = dependent ? 2 * magnitude - quantiser_of(state) : magnitude;
                    if (x != 0)
                        tile.nonzeros.push_back(
                            {static_cast<std::uint16_t>(i), x < 0 ? -level : level});
                    if (dependent)
                        state = next_state[static_cast<std::size_t>(state)]
                                          [static_cast<std::size_t>(magnitude & 1)];
                }
                tile.planes[0].count = static_cast<std::uint16_t>(tile.nonzeros.size());
                tile.planes[0].coded_length = static_cast<std::uint16_t>(
                    tile.nonzeros.empty() ? 0 : tile.nonzeros.back().index + 1);
                best = std::min(best, trial.cost_of(tile));
            }
            // Only contexts that a choice changes for later ones are not looked ahead for; and
            // candidates below 0.55 steps are zeros.
            EXPECT_LE(chosen, best + 0.35) << round;
        }
}

// Everything a payload can reach: splitting, levels, reconstruction, texels, corrections.
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
        // A copy of exactly the right size, so that the address sanitizer sees a read past its end.
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

TEST(HostileTile, RandomBytesEndInBounds) {
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

TEST(HostileTile, TruncationsAndFlipsEndInBounds) {
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
    // The end state finds nearly all; flips inside raw bits change nothing but a level.
    EXPECT_LE(missed_cuts, cuts / 50);
    EXPECT_LE(missed_flips, flips / 4);
}

// Levels of the largest magnitude everywhere, in the coarsest steps: saturates, wraps, is defined.
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
                nz.level = nz.level < 0 ? -max_level : max_level; // not dependent: any may follow
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

// ---------------------------------------------------------------- corrections

Bytes random_samples(Random& random, std::size_t count, SampleType type) {
    Bytes bytes;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint16_t sample =
            type == SampleType::unorm8
                ? static_cast<std::uint16_t>(random.range(0, 255))
                : static_cast<std::uint16_t>(random.range(0, 0x7BFF) |
                                             (random.chance(0.5) ? 0x8000 : 0));
        bytes.push_back(static_cast<std::byte>(sample & 255));
        if (type == SampleType::half16)
            bytes.push_back(static_cast<std::byte>(sample >> 8));
    }
    return bytes;
}

std::int32_t code_at(const Bytes& texels, std::size_t i, SampleType type) {
    if (type == SampleType::unorm8)
        return std::to_integer<std::int32_t>(texels[i]);
    return sample_code(
        static_cast<std::uint16_t>(std::to_integer<unsigned>(texels[2 * i]) |
                                   std::to_integer<unsigned>(texels[2 * i + 1]) << 8),
        type);
}

TEST(Corrections, KeepTheirGuaranteeAndRoundTrip) {
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

TEST(SampleCodes, AreMonotoneAndInvertible) {
    for (int code = -31743; code <= 31743; ++code) {
        const std::uint16_t half = code_sample(code, SampleType::half16);
        ASSERT_EQ(sample_code(half, SampleType::half16), code);
        if (code > -31743) {
            ASSERT_GT(half_to_float(half),
                      half_to_float(code_sample(code - 1, SampleType::half16)));
        }
    }
    EXPECT_EQ(sample_code(0x8000, SampleType::half16), 0);
    EXPECT_EQ(code_sample(1 << 30, SampleType::half16), 0x7BFF);
    EXPECT_EQ(code_sample(-(1 << 30), SampleType::half16), 0xFBFF);
    EXPECT_EQ(code_sample(-5, SampleType::unorm8), 0);
    EXPECT_EQ(code_sample(300, SampleType::unorm8), 255);
}

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
                Bytes again(texels.size());
                texels_from_planes(planes, colour, again);
                EXPECT_EQ(again, texels) << channels;
            }
}

} // namespace
} // namespace tessera::test
