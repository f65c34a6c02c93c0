// The decoder's shaders compiled as C++: the same texels as the CPU, bounded work, and sanity on any
// bytes.
#include "codec/memory_source.h"
#include "format/byte_source.h"
#include "tests/decode_cases.h"
#include "tests/shader_machine.h"

namespace tessera::test {
namespace {

using shaders::image;
using shaders::Machine;

constexpr std::uint64_t round_limit = 16384;

// A picture of all tiles of a batch side by side.
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

// Number of texels of the tile in `slot` that differ from the CPU's.
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

// Decodes the whole file by batches of at most 64 tiles.
void expect_same_texels(const DecodeCase& test, Machine& machine) {
    SCOPED_TRACE(test.name);
    const Opened file = open(test.file);
    const ContainerReader& reader = file.decoder->container();
    const Atlas atlas(reader.grid());
    machine.load_tables(file.tables->words());
    BatchBuilder builder(*file.tables, reader.grid(), {.tiles = 64}, atlas.plan, false);
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
        atlas.resize_image(batch.tiles.size());
        machine.run(batch);
        EXPECT_EQ(image.outside, 0u);
        for (std::uint32_t slot = 0; slot < batch.tiles.size(); ++slot) {
            EXPECT_EQ(Machine::damage(slot), 0u) << "tile " << batch.tiles[slot];
            EXPECT_EQ(differing(*file.decoder, batch.tiles[slot], atlas, slot), 0u)
                << "tile " << batch.tiles[slot];
        }
    }
    EXPECT_LE(machine.most_rounds, round_limit);
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

} // namespace
} // namespace tessera::test
