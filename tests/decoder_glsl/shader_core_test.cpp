// Tests the decoder's shaders, compiled as C++: the same texels as the CPU, and tables of bounded size.
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

} // namespace
} // namespace tessera::test
