// The decoder on the device: the same texels as the CPU, bit for bit.
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "format/texture.h"
#include "tests/support/decode_cases.h"
#include "tests/support/gpu_fixture.h"
#ifdef TESSERA_WITH_CORPUS
#include "corpus/bake.h"
#endif

namespace tessera::test {
namespace {

class GpuDecode : public GpuTest {};

// Texels that differ over the whole file, decoded in batches of at most `batch_tiles`.
void expect_decoded_alike(const DecodeCase& test, std::uint32_t batch_tiles) {
    SCOPED_TRACE(test.name);
    const auto source = wrap_memory(test.file);
    const auto decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder) << decoder.status().message();
    const ContainerReader& reader = decoder->container();
    const auto tables = DecodeTables::make(reader);
    ASSERT_TRUE(tables) << tables.status().message();
    const bool half = reader.desc().type == SampleType::half16;
    auto gpu = GlTileDecoder::create(*tables, half);
    ASSERT_TRUE(gpu) << gpu.status().message();

    // A layer a tile.
    const TileGrid& grid = reader.grid();
    const Extent4 most = grid.tile_extent();
    TexelPlan plan;
    plan.stride_s = most[2];
    plan.stride_t = most[3];
    const TextureShape shape{most[0] * most[2], most[1] * most[3], batch_tiles};
    auto texture =
        GlTexture::create(half ? TexelFormat::rgba16f : TexelFormat::rgba8, shape, "tiles");
    ASSERT_TRUE(texture) << texture.status().message();

    BatchBuilder builder(*tables, grid, {.tiles = batch_tiles}, plan);
    std::uint64_t tile = 0;
    while (tile < reader.tile_count()) {
        for (std::uint32_t layer = 0; tile < reader.tile_count(); ++layer, ++tile) {
            const auto bytes = reader.load_tile(tile);
            ASSERT_TRUE(bytes);
            if (!builder.add(tile, bytes->bytes, {0, 0, layer, 0, 0}))
                break;
        }
        const DecodeBatch batch = builder.finish();
        const Status status = gpu->decode(batch, *texture);
        ASSERT_TRUE(status) << status.message();
        const auto counts = gpu->counts(batch);
        ASSERT_TRUE(counts);
        const std::size_t sample = half ? 2 : 1;
        Bytes pixels(texture->bytes());
        ASSERT_TRUE(texture->read(0, pixels));
        for (std::size_t layer = 0; layer < batch.tiles.size(); ++layer) {
            EXPECT_EQ((*counts)[layer].damaged, 0u);
            const Box4 box = grid.box(batch.tiles[layer]);
            const auto expected = expected_samples(*decoder, box);
            const Extent4 n = box.extent();
            std::size_t i = 0, differing = 0;
            for (std::uint32_t v = 0; v < n[1]; ++v)
                for (std::uint32_t u = 0; u < n[0]; ++u)
                    for (std::uint32_t t = 0; t < n[3]; ++t)
                        for (std::uint32_t s = 0; s < n[2]; ++s, ++i) {
                            const std::size_t pixel =
                                (layer * shape.height + v * most[3] + t) * shape.width +
                                u * most[2] + s;
                            for (std::size_t c = 0; c < 4; ++c)
                                differing += load_sample(pixels.data() + (pixel * 4 + c) * sample,
                                                         reader.desc().type) != expected[i][c];
                        }
            EXPECT_EQ(differing, 0u) << "tile " << batch.tiles[layer];
        }
    }
}

TEST_F(GpuDecode, EncodedTexturesDecodeAsOnTheCpu) {
    for (const DecodeCase& test : encoded_cases())
        expect_decoded_alike(test, 64);
}

TEST_F(GpuDecode, RandomTreesColoursAndLevelsDecodeAsOnTheCpu) {
    for (const DecodeCase& test : random_cases())
        expect_decoded_alike(test, 3);
}

TEST_F(GpuDecode, PredictedTilesDecodeAsOnTheCpu) {
    for (const DecodeCase& test : predicted_cases())
        expect_decoded_alike(test, 3);
}

#ifdef TESSERA_WITH_CORPUS
TEST_F(GpuDecode, EveryCorpusSceneDecodesAsOnTheCpu) {
    for (const corpus::SceneInfo& scene : corpus::scenes())
        for (const RateTarget rate : {RateTarget{RateTarget::Kind::quality, 55},
                                      RateTarget{RateTarget::Kind::max_error, 8}}) {
            const auto baked = corpus::make_baked_source(scene.name, {34, 9, 9, 5}, 1, 1);
            ASSERT_TRUE(baked) << baked.status().message();
            EncodeOptions options;
            options.rate = rate;
            options.threads = 2;
            // Bounds of error go without copies.
            options.effort = rate.kind == RateTarget::Kind::quality ? copies_effort : quick_effort;
            DecodeCase test;
            test.name = scene.name;
            const auto report = encode_memory(**baked, test.file, options);
            ASSERT_TRUE(report) << report.status().message();
            expect_decoded_alike(test, 64);
        }
}
#endif

// Payloads of random bytes, half of them with a sound start: the device refuses what the CPU refuses,
// draws the background there, and everything else comes out the same.
TEST_F(GpuDecode, AnyBytesAreRefusedOrDecodedAsOnTheCpu) {
    for (const auto& [type, copies] : {std::pair{SampleType::unorm8, 0.},
                                       {SampleType::half16, 0.},
                                       {SampleType::unorm8, 0.5},
                                       {SampleType::half16, 0.5}}) {
        const DecodeCase good =
            random_case(77, type, 3, {96, 48, 16, 8}, {16, 16, 8, 8}, 0.6, 0.1, 3, copies);
        const auto source = wrap_memory(good.file);
        const auto reader = ContainerReader::open(*source);
        ASSERT_TRUE(reader);
        const auto tables = DecodeTables::make(*reader);
        ASSERT_TRUE(tables);
        const auto parameters = read_coding_parameters(reader->codec_parameters());
        ASSERT_TRUE(parameters);
        const TileCoding coding(*parameters, type, 3);
        const ColourCoding colour{reader->desc(), reader->header().colour,
                                  reader->header().background, false, true};
        TileDecoder cpu(coding, colour);
        auto gpu = GlTileDecoder::create(*tables, type == SampleType::half16);
        ASSERT_TRUE(gpu) << gpu.status().message();

        const TileGrid& grid = reader->grid();
        TexelPlan plan;
        plan.stride_s = plan.stride_t = 8;
        const auto tiles = static_cast<std::uint32_t>(grid.tiles());
        const auto texture = GlTexture::create(type == SampleType::half16 ? TexelFormat::rgba16f
                                                                          : TexelFormat::rgba8,
                                               {128, 128, tiles}, "tiles");
        ASSERT_TRUE(texture);
        Random random(9);
        std::vector<Bytes> payloads;
        BatchBuilder builder(*tables, grid, {}, plan);
        for (std::uint32_t tile = 0; tile < tiles; ++tile) {
            Bytes bytes = random.bytes(2 * static_cast<std::size_t>(random.range(1, 400)));
            if (random.chance(0.8)) {
                ASSERT_TRUE(reader->read_tile(tile, bytes));
                if (!bytes.empty() && random.chance(0.5))
                    bytes[bytes.size() / 2] ^= std::byte{4};
            }
            payloads.push_back(bytes);
            ASSERT_TRUE(builder.add(tile, bytes, {0, 0, tile, 0, 0}));
        }
        const DecodeBatch batch = builder.finish();
        ASSERT_TRUE(gpu->decode(batch, *texture));
        const auto counts = gpu->counts(batch);
        ASSERT_TRUE(counts);
        Bytes pixels(texture->bytes());
        ASSERT_TRUE(texture->read(0, pixels));

        const std::size_t sample = sample_bytes(type);
        unsigned refused = 0;
        for (std::uint32_t tile = 0; tile < tiles; ++tile) {
            SCOPED_TRACE(tile);
            const Box4 box = grid.box(tile);
            Bytes expected(reader->desc().box_bytes(box));
            const bool background =
                payloads[tile].empty() || !cpu.decode(payloads[tile], tile_shape(box), expected);
            const bool split_refused =
                std::find(batch.damaged.begin(), batch.damaged.end(), tile) != batch.damaged.end();
            EXPECT_EQ((*counts)[tile].damaged != 0 || split_refused,
                      background && !payloads[tile].empty());
            refused += background;
            if (background) // as the container decodes a tile without bytes
                for (std::size_t i = 0; i < expected.size() / sample; ++i)
                    store_sample(expected.data() + i * sample, reader->header().background[i % 3],
                                 type);
            const Extent4 n = box.extent();
            std::size_t i = 0, differing = 0;
            for (std::uint32_t v = 0; v < n[1]; ++v)
                for (std::uint32_t u = 0; u < n[0]; ++u)
                    for (std::uint32_t t = 0; t < n[3]; ++t)
                        for (std::uint32_t s = 0; s < n[2]; ++s)
                            for (std::size_t c = 0; c < 3; ++c, ++i) {
                                const std::size_t pixel =
                                    (std::size_t{tile} * 128 + v * 8 + t) * 128 + u * 8 + s;
                                differing +=
                                    load_sample(pixels.data() + (pixel * 4 + c) * sample, type) !=
                                    load_sample(expected.data() + i * sample, type);
                            }
            EXPECT_EQ(differing, 0u);
        }
        EXPECT_GT(refused, 2u);
        EXPECT_LT(refused, tiles - 2);
    }
}

} // namespace
} // namespace tessera::test
