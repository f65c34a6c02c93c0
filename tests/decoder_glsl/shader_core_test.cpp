// Tests the decoder's shaders, compiled as C++: the same texels as the CPU, bounded work, and
// safety with arbitrary bytes.
#include "format/byte_source.h"
#include "format/texture.h"
#include "format/tile/dct_basis.h"
#include "format/tile/sine_basis.h"
#include "tests/support/decode_cases.h"
#include "tests/support/shader_oracle.h"

namespace tessera::test {
namespace {

using shaders::image;
using shaders::Machine;

// The layout of a batch's tiles side by side in one picture.
struct Atlas {
    Extent4 largest;
    TexelPlan plan;
    int columns = 8;

    explicit Atlas(const TileGrid& grid) : largest(grid.tile_extent()) {
        plan.stride_s = largest[2] + 1;
        plan.stride_t = largest[3] + 1;
    }
    TexelPlace place(std::uint32_t slot) const {
        return {slot % columns * largest[0] * plan.stride_s,
                slot / columns * largest[1] * plan.stride_t, 0, 0, 0};
    }
    void resize_image(std::size_t tiles) const {
        const auto rows = static_cast<int>((tiles + columns - 1) / columns);
        image.resize(columns * static_cast<int>(largest[0] * plan.stride_s),
                     rows * static_cast<int>(largest[1] * plan.stride_t), 1);
    }
};

struct Opened {
    std::unique_ptr<ByteSource> source;
    std::unique_ptr<Decoder> decoder;
    std::unique_ptr<DecodeTables> tables;
};

Opened open(const Bytes& file) {
    Opened opened;
    opened.source = wrap_memory(file);
    auto decoder = Decoder::open(*opened.source);
    EXPECT_TRUE(decoder) << decoder.status().message();
    opened.decoder = std::make_unique<Decoder>(std::move(*decoder));
    auto tables = DecodeTables::make(opened.decoder->container());
    EXPECT_TRUE(tables) << tables.status().message();
    opened.tables = std::make_unique<DecodeTables>(std::move(*tables));
    return opened;
}

// The number of texels of the tile in `slot` that differ from the CPU's.
std::uint64_t differing(const Decoder& decoder, std::uint64_t tile, const Atlas& atlas,
                        std::uint32_t slot) {
    const Box4 box = decoder.container().grid().box(tile);
    const auto expected = expected_samples(decoder, box);
    const Extent4 n = box.extent();
    const TexelPlace place = atlas.place(slot);
    std::uint64_t count = 0;
    std::size_t i = 0;
    for (std::uint32_t v = 0; v < n[1]; ++v)
        for (std::uint32_t u = 0; u < n[0]; ++u)
            for (std::uint32_t t = 0; t < n[3]; ++t)
                for (std::uint32_t s = 0; s < n[2]; ++s, ++i) {
                    const auto& got =
                        image.at(static_cast<int>(place.x + u * atlas.plan.stride_s + s),
                                 static_cast<int>(place.y + v * atlas.plan.stride_t + t), 0);
                    for (int c = 0; c < 4; ++c)
                        if (got[c] != expected[i][static_cast<std::size_t>(c)]) {
                            ++count;
                            break;
                        }
                }
    return count;
}

// Decodes the whole file in batches of at most 64 tiles.
void expect_same_texels(const DecodeCase& test, Machine& machine) {
    SCOPED_TRACE(test.name);
    const Opened file = open(test.file);
    const ContainerReader& reader = file.decoder->container();
    const Atlas atlas(reader.grid());
    BatchBuilder builder(*file.tables, reader.grid(), {.tiles = 64}, atlas.plan);
    std::uint64_t tile = 0;
    while (tile < reader.tile_count()) {
        for (std::uint32_t slot = 0; tile < reader.tile_count(); ++slot, ++tile) {
            const auto bytes = reader.load_tile(tile);
            ASSERT_TRUE(bytes);
            if (!builder.add(tile, bytes->bytes, atlas.place(slot)))
                break;
        }
        const DecodeBatch batch = builder.finish();
        EXPECT_TRUE(batch.damaged.empty());
        machine.load_tables(file.tables->words());
        atlas.resize_image(batch.tiles.size());
        machine.run(batch);
        EXPECT_EQ(image.outside, 0u);
        EXPECT_TRUE(Machine::guards_hold(batch));
        for (std::uint32_t slot = 0; slot < batch.tiles.size(); ++slot) {
            EXPECT_EQ(Machine::damage(slot), 0u) << "tile " << batch.tiles[slot];
            EXPECT_EQ(differing(*file.decoder, batch.tiles[slot], atlas, slot), 0u)
                << "tile " << batch.tiles[slot];
        }
    }
    EXPECT_LE(machine.most_rounds, shader_round_limit);
}

TEST(ShaderCore, EncodedTexturesDecodeAsOnTheCpu) {
    Machine machine;
    for (const DecodeCase& test : encoded_cases())
        expect_same_texels(test, machine);
    RecordProperty("most_rounds", static_cast<int>(machine.most_rounds));
}

TEST(ShaderCore, RandomTreesColoursAndLevelsDecodeAsOnTheCpu) {
    Machine machine;
    for (const DecodeCase& test : random_cases())
        expect_same_texels(test, machine);
    RecordProperty("most_rounds", static_cast<int>(machine.most_rounds));
}

TEST(ShaderCore, PredictedTilesDecodeAsOnTheCpu) {
    Machine machine;
    for (const DecodeCase& test : predicted_cases())
        expect_same_texels(test, machine);
    EXPECT_EQ(machine.most_waves, 16u);
    RecordProperty("most_rounds", static_cast<int>(machine.most_rounds));
}

TEST(ShaderCore, PicturesDecodeAsOnTheCpu) {
    Machine machine;
    for (const DecodeCase& test : picture_cases())
        expect_same_texels(test, machine);
    EXPECT_GT(machine.most_steps, 50u);
    RecordProperty("most_rounds", static_cast<int>(machine.most_rounds));
    RecordProperty("most_steps", static_cast<int>(machine.most_steps));
}

TEST(ShaderCore, BasisMatchesTheFormat) {
    const DecodeCase test = encoded_case("constant", {{1, 1, 1, 1}, SampleType::unorm8, 1},
                                         {RateTarget::Kind::quality, 50});
    Machine().load_tables(open(test.file).tables->words());
    for (int n = 1; n <= max_block_side; ++n)
        for (int k = 0; k < std::min(n, max_frequencies); ++k)
            for (int x = 0; x < n; ++x)
                ASSERT_EQ(
                    static_cast<int>(shaders::tsr_table(shaders::tsr_basis_of(n) + k * n + x)),
                    basis(n)[k * n + x])
                    << n << " " << k << " " << x;
    for (int n = 1; n <= max_sine_side; ++n)
        for (int i = 0; i < n * n; ++i)
            ASSERT_EQ(static_cast<int>(shaders::tsr_table(shaders::tsr_sine_basis_of(n) + i)),
                      sine_basis(n)[i])
                << n << " " << i;
    // The tables lie one behind the other.
    EXPECT_EQ(shaders::tsr_t_mode + mode_contexts * shaders::tsr_symbol_words,
              shaders::tsr_t_transform);
    EXPECT_EQ(shaders::tsr_t_transform + transform_contexts * shaders::tsr_symbol7_words,
              shaders::tsr_t_rotation);
    EXPECT_EQ(shaders::tsr_t_direction + border_directions, shaders::tsr_t_filter);
    EXPECT_EQ(shaders::tsr_t_filter + 4 * filter_rings, shaders::tsr_t_basis);
    EXPECT_EQ(shaders::tsr_basis_of(max_frequencies) + max_frequencies * max_frequencies,
              shaders::tsr_t_wide_basis);
    EXPECT_EQ(shaders::tsr_basis_of(max_block_side) + max_frequencies * max_block_side,
              shaders::tsr_t_sine_basis);
    EXPECT_EQ(shaders::tsr_sine_basis_of(max_sine_side) + max_sine_side * max_sine_side,
              shaders::tsr_t_end);
}

// Adds shapes until there is no room left. The shapes of any tile must fit after that.
TEST(ShaderCore, ScanTablesTakeBoundedMemory) {
    const Extent4 size{40, 40, 8, 8};
    const ShaderOracle file(empty_file({size, SampleType::unorm8, 3}, size, {}, false));
    auto tables = DecodeTables::make(file.reader());
    ASSERT_TRUE(tables);
    std::set<BlockShape> shapes{shape_of(40, 40, 8, 8)};
    for (bool grows = true; grows;) {
        const std::size_t before = shapes.size();
        for (const BlockShape& shape : std::set(shapes))
            for (const Split split : {Split::spatial, Split::angular, Split::u, Split::v})
                if (can_split(shape, split)) {
                    const Children children = children_of(Block{{}, shape, 0, 0}, split);
                    for (int i = 0; i < children.count; ++i)
                        shapes.insert(children.block[static_cast<std::size_t>(i)].shape);
                }
        grows = shapes.size() > before;
    }
    std::size_t refused = 0;
    for (const BlockShape& shape : shapes) {
        const std::array one{shape};
        if (!tables->add_scans(one)) {
            ++refused;
            tables->forget_scans();
            EXPECT_TRUE(tables->add_scans(one));
        }
        EXPECT_LE(tables->words().size(), tables->most_words());
    }
    EXPECT_GT(refused, 0u);
    EXPECT_EQ(tables->generation(), refused);
    // The bound is what the largest tile can need.
    EXPECT_LE(tables->most_words() - tables->words_before_scans(),
              std::size_t{40 * 40 * 8 * 8} * shaders::tsr_scan_words);
}

// ---- Arbitrary bytes.

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

std::string check_one(ShaderOracle& file, const Bytes& payload,
                      const ShaderOracle::Layout& layout) {
    return file.check(std::vector<Bytes>{payload}, layout);
}

TEST(ShaderCore, RandomBytesAreRefusedOrDecodedAsOnTheCpu) {
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

TEST(ShaderCore, CutOffPayloadsAreRefusedOrDecodedAsOnTheCpu) {
    Random random(12);
    for (const auto& file : small_files()) {
        const Bytes whole = random_payload(random, *file);
        ASSERT_EQ(check_one(*file, whole, {}), "");
        EXPECT_EQ(file->accepted(), 1u);
        for (std::size_t length = 0; length < whole.size(); ++length) {
            const auto end = whole.begin() + static_cast<std::ptrdiff_t>(length);
            ASSERT_EQ(check_one(*file, Bytes(whole.begin(), end), {}), "") << length;
        }
    }
}

TEST(ShaderCore, EveryFlippedBitIsRefusedOrDecodedAsOnTheCpu) {
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
TEST(ShaderCore, ChangedBatchesEndAndStayInsideTheirBuffers) {
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

// ---- Tiles built by hand at the limits of the format.

class HandMadeTile {
public:
    explicit HandMadeTile(const BlockShape& shape)
        : nodes_{{Block{{0, 0, 0, 0}, shape, 0, 0}, Split::none, 0, 0}} {}

    // Splits `count` nodes, oldest first, into `children` parts. Nodes wider than `widest` are
    // skipped. Returns the number of splits for which no node was left.
    int split(int count, int children, Split kind, int widest = max_tile_side) {
        for (std::size_t i = 0; i < nodes_.size() && count > 0; ++i) {
            if (nodes_[i].split != Split::none || nodes_[i].block.shape.n[0] > widest ||
                !can_split(nodes_[i].block.shape, kind))
                continue;
            const Children made = children_of(nodes_[i].block, kind);
            if (made.count != children)
                continue;
            nodes_[i].split = kind;
            nodes_[i].first = nodes_.size();
            nodes_[i].count = made.count;
            for (int child = 0; child < made.count; ++child)
                nodes_.push_back({made.block[static_cast<std::size_t>(child)], Split::none, 0, 0});
            --count;
        }
        return count;
    }

    // Splits the node that holds the tile's first texel.
    void split_first(Split kind) {
        std::size_t at = 0;
        while (nodes_[at].split != Split::none)
            at = nodes_[at].first;
        const Children made = children_of(nodes_[at].block, kind);
        nodes_[at].split = kind;
        nodes_[at].first = nodes_.size();
        nodes_[at].count = made.count;
        for (int child = 0; child < made.count; ++child)
            nodes_.push_back({made.block[static_cast<std::size_t>(child)], Split::none, 0, 0});
    }

    struct Run {
        int length = 0;     // number of coded levels
        bool dense = false; // all levels are nonzero, otherwise only the last
    };
    // run(block, plane) returns the Run of one block and plane.
    template <class Function> TileLevels levels(int planes, Function run) const {
        TileLevels tile;
        tile.shape = nodes_[0].block.shape;
        append(0, tile);
        tile.colours.assign(tile.blocks.size(), BlockColour{});
        for (std::size_t block = 0; block < tile.blocks.size(); ++block)
            for (int plane = 0; plane < planes; ++plane) {
                const Run wanted = run(block, plane);
                PlaneLevels made;
                made.first = static_cast<std::uint32_t>(tile.nonzeros.size());
                made.coded_length = static_cast<std::uint16_t>(wanted.length);
                for (int i = 0; i < wanted.length; ++i)
                    if (wanted.dense || i + 1 == wanted.length)
                        tile.nonzeros.push_back(
                            {static_cast<std::uint16_t>(i), i % 3 == 0 ? -1 : 1});
                made.count = static_cast<std::uint16_t>(tile.nonzeros.size() - made.first);
                tile.planes.push_back(made);
            }
        return tile;
    }

private:
    struct Node {
        Block block;
        Split split;
        std::size_t first;
        int count;
    };
    void append(std::size_t at, TileLevels& tile) const {
        const Node& node = nodes_[at];
        tile.splits.push_back(static_cast<std::uint8_t>(node.split));
        if (node.split == Split::none)
            tile.blocks.push_back(node.block);
        for (int i = 0; i < node.count; ++i)
            append(node.first + static_cast<std::size_t>(i), tile);
    }
    std::vector<Node> nodes_;
};

ShaderOracle file_of_one_tile(const Extent4& size, std::uint8_t channels, bool predicts = false) {
    CodingParameters parameters;
    parameters.step.fill(StepCode::nearest(30));
    parameters.prediction = predicts;
    return ShaderOracle(
        empty_file({size, SampleType::unorm8, channels}, size, parameters, !predicts));
}

TEST(ShaderCore, TheLargestWorkOfASegmentStaysBelowTheBoundOnRounds) {
    ShaderOracle file = file_of_one_tile({32, 32, 8, 8}, 4);
    HandMadeTile tile(shape_of(32, 32, 8, 8));
    ASSERT_EQ(tile.split(1, 4, Split::spatial), 0);
    // Blocks of 16,384 texels. The second has as many levels as a segment of 16,000 allows, all of
    // them nonzero in three planes. The last two fill the segment.
    const TileLevels levels = tile.levels(4, [](std::size_t block, int plane) {
        if (block >= 2)
            return HandMadeTile::Run{plane > 0 ? 0 : block == 2 ? 112 : 4, false};
        return HandMadeTile::Run{plane < 3 ? 4096 : 3584, block == 1};
    });
    std::vector<Bytes> payload(1);
    encode_levels(levels, {}, file.coding(), payload[0], max_segment_work);
    EXPECT_EQ(std::to_integer<int>(payload[0][0]), 1); // one further segment
    EXPECT_EQ(file.check(payload, {}), "");
    EXPECT_EQ(file.accepted(), 1u);
    EXPECT_EQ(file.most_rounds(), 16000u);
    EXPECT_LT(file.most_rounds(), shader_round_limit);
}

// As many blocks with shares as a segment allows, each with a single coefficient.
TEST(ShaderCore, SharesStayBelowTheBoundOnRounds) {
    CodingParameters parameters;
    parameters.step.fill(StepCode::nearest(30));
    parameters.colour_rotation = true;
    const Extent4 size{64, 64, 1, 1};
    ShaderOracle file(empty_file({size, SampleType::unorm8, 3}, size, parameters, true));
    HandMadeTile tile(shape_of(64, 64, 1, 1));
    tile.split(1365, 4, Split::spatial);
    TileLevels levels = tile.levels(3, [](std::size_t, int plane) {
        return HandMadeTile::Run{plane == 0 ? 1 : 0, true};
    });
    for (std::size_t i = 0; i < levels.colours.size(); ++i)
        levels.colours[i].share = {static_cast<std::int8_t>(1 + i % 2), 1};
    Bytes payload;
    encode_levels(levels, {}, file.coding(), payload, max_segment_work);
    EXPECT_EQ(check_one(file, payload, {}), "");
    EXPECT_EQ(file.accepted(), 1u);
    EXPECT_GT(file.most_rounds(), 15000u);
    EXPECT_LT(file.most_rounds(), shader_round_limit);
}

// Blocks without levels take no bytes, so that the stream contains only the tree.
Bytes payload_of_tree(const HandMadeTile& tile, const ShaderOracle& file) {
    TileLevels levels =
        tile.levels(file.coding().planes, [](std::size_t, int) { return HandMadeTile::Run{}; });
    Bytes payload;
    encode_levels(levels, {}, file.coding(), payload);
    if (payload.size() % 2 != 0) // cut off the table of the further segments, which are empty
        payload.erase(payload.begin(), payload.begin() + 1 + 4 * std::to_integer<int>(payload[0]));
    return payload;
}

TEST(ShaderCore, WorkIsCountedAsOnTheCpu) {
    struct Splits {
        int four, two;
        bool accepted;
    };
    // 4 n + 1 + 2 m nodes and 3 n + 1 + m blocks of 3 planes.
    for (const Splits splits : {Splits{1227, 9, true}, Splits{1229, 4, false}}) {
        ShaderOracle file = file_of_one_tile({24, 24, 8, 8}, 3);
        HandMadeTile tile(shape_of(24, 24, 8, 8));
        const int left = tile.split(splits.four, 4, Split::spatial);
        ASSERT_EQ(tile.split(left, 4, Split::angular), 0);
        ASSERT_EQ(tile.split(splits.two, 2, Split::spatial), 0);
        EXPECT_EQ(4 * splits.four + 1 + 2 * splits.two + 3 * (3 * splits.four + 1 + splits.two),
                  splits.accepted ? 16000 : 16001);
        EXPECT_EQ(check_one(file, payload_of_tree(tile, file), {}), "");
        EXPECT_EQ(file.accepted(), splits.accepted ? 1u : 0u);
    }
}

TEST(ShaderCore, BlocksAreCountedAsOnTheCpu) {
    for (const bool too_many : {false, true}) {
        ShaderOracle file = file_of_one_tile({31, 31, 8, 8}, 1);
        HandMadeTile tile(shape_of(31, 31, 8, 8));
        const int left = tile.split(1365, 4, Split::spatial);
        ASSERT_EQ(tile.split(left, 4, Split::angular), 0);
        ASSERT_EQ(tile.split(too_many, 2, Split::spatial), 0);
        EXPECT_EQ(check_one(file, payload_of_tree(tile, file), {}), "");
        EXPECT_EQ(file.accepted(), too_many ? 0u : 1u);
    }
}

// Holds for any number of blocks that a batch claims to have room for.
TEST(ShaderCore, BlocksAreNoMoreThanTheFormatAllows) {
    ShaderOracle file = file_of_one_tile({31, 31, 8, 8}, 1);
    HandMadeTile tile(shape_of(31, 31, 8, 8));
    const int left = tile.split(1365, 4, Split::spatial);
    ASSERT_EQ(tile.split(left, 4, Split::angular), 0);
    ASSERT_EQ(tile.split(1, 2, Split::spatial), 0); // 4,097 blocks
    const std::vector<Bytes> payload{payload_of_tree(tile, file)};
    const auto make_room = [](auto words) {
        words[words[shaders::tsr_b_tile_at] + shaders::tsr_tile_block_room] = 0xFFFFFFFFu;
    };
    EXPECT_EQ(file.check_changed(payload, {}, make_room, 300000), "");
    EXPECT_NE(Machine::damage(0), 0u);
}

// Uses blocks larger than any file can have, in a tile with the largest number of blocks.
TEST(ShaderCore, AnInvocationCutsNoMoreItemsThanATileHas) {
    using namespace shaders;
    const ShaderOracle file = file_of_one_tile({8, 8, 8, 8}, 4);
    auto tables = DecodeTables::make(file.reader());
    ASSERT_TRUE(tables);
    BatchBuilder builder(*tables, file.reader().grid(), {}, {});
    ASSERT_TRUE(builder.add(0, Bytes{}, {}));
    const DecodeBatch batch = builder.finish();
    std::vector<std::uint32_t> words(tables->words().begin(), tables->words().end());
    words[words[tsr_t_shapes] + tsr_s_sides] = 64u | 64u << 9 | 32u << 18 | 32u << 24;
    Machine machine;
    machine.load_tables(words);
    machine.decode_levels(batch);
    const std::uint32_t state = tsr_state_at(0), blocks = tsr_max_blocks;
    tsr_work.assign(tsr_batch[tsr_b_blocks_at] + blocks * tsr_block_words, 0);
    tsr_batch[tsr_batch[tsr_b_tile_at] + tsr_tile_block_room] = blocks;
    for (const std::uint32_t said : {blocks, 0xFFFFFFFFu}) {
        tsr_work[state + tsr_st_blocks] = said;
        for (std::uint32_t block = 0; block < blocks; ++block)
            tsr_work[tsr_block_at(0, block) + tsr_k_rest] = 31u << 8 | 31u << 16;
        tsr_work[tsr_w_items] = 0;
        machine.invoke([] { tsr_cut_tile(0, 63); });
        EXPECT_EQ(tsr_work[tsr_w_items], static_cast<std::uint32_t>(tsr_max_items));
    }
    EXPECT_LE(machine.most_rounds, shader_round_limit);
}

// Splits every side until all blocks are single texels, which takes 11 levels; and one path down to a
// texel along u and along v separately, which takes 14 levels.
TEST(ShaderCore, TheDeepestTreeIsDecodedAsOnTheCpu) {
    for (const bool spatial_first : {true, false}) {
        ShaderOracle file = file_of_one_tile({1, 64, 1, 32}, 1);
        HandMadeTile tile(shape_of(1, 64, 1, 32));
        const Split first = spatial_first ? Split::spatial : Split::angular;
        const Split second = spatial_first ? Split::angular : Split::spatial;
        ASSERT_EQ(tile.split(spatial_first ? 63 : 31, 2, first), 0);
        tile.split(4096, 2, second);
        EXPECT_EQ(check_one(file, payload_of_tree(tile, file), {}), "");
        EXPECT_EQ(file.accepted(), 1u);
    }
    ShaderOracle file = file_of_one_tile({256, 256, 1, 1}, 1);
    HandMadeTile tile(shape_of(256, 256, 1, 1));
    ASSERT_EQ(tile.split(5, 4, Split::spatial), 0); // which have no symbols
    for (int level = 0; level < 6; ++level)
        for (const Split kind : {Split::u, Split::v})
            tile.split_first(kind);
    EXPECT_EQ(check_one(file, payload_of_tree(tile, file), {}), "");
    EXPECT_EQ(file.accepted(), 1u);
}

// Sides of 9 and 17 give the longest queue of siblings.
TEST(ShaderCore, TheWidestTreeIsDecodedAsOnTheCpu) {
    ShaderOracle file = file_of_one_tile({9, 17, 17, 17}, 1);
    HandMadeTile tile(shape_of(9, 17, 17, 17));
    for (int level = 0; level < 5; ++level) // follows the first child at each level
        for (const Split kind : {Split::spatial, Split::angular})
            tile.split_first(kind);
    EXPECT_EQ(check_one(file, payload_of_tree(tile, file), {}), "");
    EXPECT_EQ(file.accepted(), 1u);
}

// Views that copy each other in a row or in a plane, at most 15 deep. Their values reach the limits
// of a predicted tile.
TEST(ShaderCore, CopiesAreAsDeepAsOnTheCpu) {
    struct Views {
        int s, t;
        bool accepted;
    };
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const Views views :
             {Views{16, 1, true}, Views{17, 1, false}, Views{1, 16, true}, Views{1, 17, false},
              Views{8, 8, true}, Views{9, 9, false}, Views{2, 15, true}, Views{32, 32, false}}) {
            SCOPED_TRACE(std::to_string(views.s) + "x" + std::to_string(views.t));
            const Extent4 size{6, 5, static_cast<std::uint32_t>(views.s),
                               static_cast<std::uint32_t>(views.t)};
            CodingParameters parameters;
            parameters.step.fill(StepCode::nearest(30000));
            parameters.prediction = true;
            parameters.smooth_copies = views.s % 2 == 1;
            if (views.t % 2 == 1)
                parameters.filter.ring[0][2] = {100, 255};
            ShaderOracle file(empty_file({size, type, 3}, size, parameters, false));
            HandMadeTile tile(shape_of(6, 5, views.s, views.t));
            tile.split(4096, 4, Split::angular);
            tile.split(4096, 2, Split::angular);
            TileLevels levels = tile.levels(3, [](std::size_t block, int) {
                return HandMadeTile::Run{block % 3 != 1 ? 4 : 0, true};
            });
            ASSERT_EQ(levels.blocks.size(), static_cast<std::size_t>(views.s * views.t));
            for (const Block& block : levels.blocks) {
                // Along either axis, the depth of a view is its number of steps from the first
                // view.
                const int s = block.origin[2], t = block.origin[3];
                BlockPrediction p;
                if (s > 0 && (t == 0 || (s + t) % 2 == 0))
                    p = {CopyFrom::along_s, {3, static_cast<std::int8_t>(-s)}, mode_none};
                else if (t > 0)
                    p = {CopyFrom::along_t, {static_cast<std::int8_t>(t), -1}, mode_none};
                levels.predictions.push_back(p);
            }
            Bytes payload;
            encode_levels(levels, {}, file.coding(), payload);
            EXPECT_EQ(check_one(file, payload, {}), "");
            EXPECT_EQ(file.accepted(), views.accepted ? 1u : 0u);
        }
}

// A picture with as many blocks as a tile may have, all of them predicted from their border: squares
// of 4x4 and strips of 1x16.
TEST(ShaderCore, PredictionsFromBordersStayBelowTheBoundOnRounds) {
    for (const bool strips : {false, true})
        for (const BorderMode mode : {mode_mean, mode_planar, BorderMode{5}, mode_vertical}) {
            SCOPED_TRACE(int{mode});
            ShaderOracle file = file_of_one_tile({256, 256, 1, 1}, 1, true);
            HandMadeTile tile(shape_of(256, 256, 1, 1));
            ASSERT_EQ(tile.split(strips ? 5 : 1365, 4, Split::spatial), 0);
            if (strips) {
                ASSERT_EQ(tile.split(16 + 32, 2, Split::v), 0);
                tile.split(4096, 2, Split::u);
            }
            TileLevels levels = tile.levels(1, [](std::size_t block, int) {
                return HandMadeTile::Run{block % 5 == 0 ? 2 : 0, true};
            });
            ASSERT_EQ(levels.blocks.size(), static_cast<std::size_t>(max_leaves));
            levels.predictions.assign(levels.blocks.size(),
                                      {CopyFrom::nothing, Displacement{}, mode});
            Bytes payload;
            encode_levels(levels, {}, file.coding(), payload);
            EXPECT_EQ(check_one(file, payload, {}), "");
            EXPECT_EQ(file.accepted(), 1u);
            EXPECT_LT(file.most_rounds(), shader_round_limit);
            EXPECT_GT(file.most_steps(), 200u);
        }
}

// Large flat blocks, each divided into many items, beside the largest number of small blocks. Only
// the first and the last chunk have corrections, which follow the items in the work buffer.
TEST(ShaderCore, ATileOfManyItemsKeepsItsCorrections) {
    ShaderOracle file = file_of_one_tile({32, 32, 8, 8}, 3);
    HandMadeTile tile(shape_of(32, 32, 8, 8));
    ASSERT_EQ(tile.split(21, 4, Split::angular), 0);
    ASSERT_EQ(tile.split(4, 4, Split::spatial), 0);
    ASSERT_EQ(tile.split(1340, 4, Split::spatial, 16), 0); // 4,096 blocks in all
    const BlockShape shape = file.shape_of_tile(0);
    CorrectionMap map(static_cast<std::size_t>(shape.texels()) * 3);
    for (std::size_t i = 0; i < 12288; ++i)
        map[i] = static_cast<int>(i % 5) - 2, map[map.size() - 1 - i] = static_cast<int>(i % 3);
    const auto corrections = encode_corrections(map, shape, 3, file.coding().tables);
    ASSERT_TRUE(corrections[1].empty());
    std::vector<Bytes> payload(1);
    encode_levels(tile.levels(3,
                              [](std::size_t block, int) {
                                  return HandMadeTile::Run{block % 7 == 0 ? 1 : 0, false};
                              }),
                  corrections, file.coding(), payload[0]);
    EXPECT_EQ(file.check(payload, {}), "");
    EXPECT_EQ(file.accepted(), 1u);
}

} // namespace
} // namespace tessera::test
