// Tests that the GPU decodes the same texels as the CPU, bit for bit.
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "format/container/file_coding.h"
#include "format/texture.h"
#include "tests/support/decode_cases.h"
#include "tests/support/gpu_fixture.h"
#ifdef TESSERA_WITH_CORPUS
#include "corpus/bake.h"
#endif

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace tessera::test {
namespace {

class GpuDecode : public GpuTest {};

// Decodes a whole file in batches of at most `batch_tiles` and expects no different texel.
void expect_decoded_alike(const DecodeCase& test, std::uint32_t batch_tiles) {
    SCOPED_TRACE(test.name);
    const auto source = wrap_memory(test.file);
    const auto decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder) << decoder.status().message();
    const ContainerReader& reader = decoder->container();
    auto tables = DecodeTables::make(reader);
    ASSERT_TRUE(tables) << tables.status().message();
    const bool half = reader.desc().type == SampleType::half16;
    auto gpu = GlTileDecoder::create(*tables, half);
    ASSERT_TRUE(gpu) << gpu.status().message();

    // One layer per tile.
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
        const Status status = gpu->decode(*tables, batch, *texture);
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

TEST_F(GpuDecode, PicturesDecodeAsOnTheCpu) {
    for (const DecodeCase& test : picture_cases())
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
            // Bounded errors are coded without copies.
            options.effort = rate.kind == RateTarget::Kind::quality ? copies_effort : quick_effort;
            DecodeCase test;
            test.name = scene.name;
            const auto report = encode_memory(**baked, test.file, options);
            ASSERT_TRUE(report) << report.status().message();
            expect_decoded_alike(test, 64);
        }
}
#endif

// A damaged or forged payload, made from two payloads of the file.
Bytes mutant(Random& random, Bytes sound, const Bytes& other) {
    const auto any = [&random](std::size_t size) {
        return static_cast<std::size_t>(random.range(0, static_cast<int>(size) - 1));
    };
    const int kind = sound.empty() ? 0 : random.range(0, 7);
    switch (kind) {
    case 0:
        return random.bytes(2 * static_cast<std::size_t>(random.range(1, 400)));
    case 1: // valid: damage to its neighbours must not affect it
        return sound;
    case 2:
        sound[any(sound.size())] ^= static_cast<std::byte>(1 << random.range(0, 7));
        return sound;
    case 3:
        for (int n = random.range(2, 30); n > 0; --n)
            sound[any(sound.size())] = static_cast<std::byte>(random.range(0, 255));
        return sound;
    case 4: // sizes of streams and initial states
        for (std::size_t at = 0; at < std::min<std::size_t>(sound.size(), 16); ++at)
            if (random.chance(0.3))
                sound[at] = static_cast<std::byte>(random.chance(0.5) ? random.range(0, 255) : 255);
        return sound;
    case 5:
        sound.resize(any(sound.size()));
        return sound;
    case 6: {
        const Bytes more = random.bytes(static_cast<std::size_t>(random.range(1, 64)));
        sound.insert(sound.begin() + static_cast<std::ptrdiff_t>(any(sound.size())), more.begin(),
                     more.end());
        return sound;
    }
    default: // the end of another payload
        if (!other.empty()) {
            const std::size_t at = any(std::min(sound.size(), other.size()));
            sound.resize(at);
            sound.insert(sound.end(), other.begin() + static_cast<std::ptrdiff_t>(at), other.end());
        }
        return sound;
    }
}

struct Mutants {
    unsigned long tried = 0, refused = 0;
};

// Decodes a file of random tiles with mutants in place of its payloads. The GPU must refuse exactly
// the payloads that the CPU refuses, draw the background there, decode all other tiles equally, and
// write nothing outside the tiles.
Mutants expect_mutants_alike(std::uint32_t seed, SampleType type, double copies) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    // At some edges tiles are shorter than their slots.
    const DecodeCase good =
        random_case(seed, type, 3, {94, 45, 15, 8}, {16, 16, 8, 8}, 0.6, 0.1, 3, copies);
    const auto source = wrap_memory(good.file);
    const auto reader = ContainerReader::open(*source);
    auto tables = reader ? DecodeTables::make(*reader, ScanMemory::unbounded) : reader.status();
    if (!tables) {
        ADD_FAILURE() << tables.status().message();
        return {};
    }
    const auto parameters = coding_of(*reader);
    const TileCoding coding(*parameters, type, 3);
    const ColourCoding colour{reader->desc(), reader->header().colour, reader->header().background,
                              false, true};
    TileDecoder cpu(coding, colour);
    const bool half = type == SampleType::half16;
    const TileGrid& grid = reader->grid();
    TexelPlan plan;
    plan.stride_s = plan.stride_t = 8;
    const auto tiles = static_cast<std::uint32_t>(grid.tiles());
    const std::uint32_t layers = tiles + 1; // the last layer must stay unchanged
    auto texture =
        GlTexture::create(half ? TexelFormat::rgba16f : TexelFormat::rgba8, {128, 128, layers}, "");
    if (!texture) {
        ADD_FAILURE() << texture.status().message();
        return {};
    }
    const std::size_t sample = sample_bytes(type);
    const Bytes untouched(4 * sample, std::byte{0x3B});
    EXPECT_TRUE(texture->clear(untouched));

    Random random(seed);
    std::vector<Bytes> payloads;
    BatchBuilder builder(*tables, grid, {}, plan);
    for (std::uint32_t tile = 0; tile < tiles; ++tile) {
        Bytes sound, other;
        EXPECT_TRUE(reader->read_tile(tile, sound));
        EXPECT_TRUE(reader->read_tile(
            static_cast<std::uint64_t>(random.range(0, static_cast<int>(tiles) - 1)), other));
        payloads.push_back(mutant(random, std::move(sound), other));
        EXPECT_TRUE(builder.add(tile, payloads.back(), {0, 0, tile, 0, 0}));
    }
    const DecodeBatch batch = builder.finish();
    auto gpu = GlTileDecoder::create(*tables, half); // the batch has completed the tables
    if (!gpu) {
        ADD_FAILURE() << gpu.status().message();
        return {};
    }
    EXPECT_TRUE(gpu->decode(*tables, batch, *texture));
    const auto counts = gpu->counts(batch);
    Bytes pixels(texture->bytes());
    EXPECT_TRUE(texture->read(0, pixels));
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    if (!counts) {
        ADD_FAILURE() << counts.status().message();
        return {};
    }

    unsigned refused = 0;
    std::vector<bool> is_of_a_tile(std::size_t{layers} * 128 * 128);
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
        if (background) // a tile without bytes is background
            for (std::size_t i = 0; i < expected.size() / sample; ++i)
                store_sample(expected.data() + i * sample, reader->header().background[i % 3],
                             type);
        const Extent4 n = box.extent();
        std::size_t i = 0, differing = 0;
        for (std::uint32_t v = 0; v < n[1]; ++v)
            for (std::uint32_t u = 0; u < n[0]; ++u)
                for (std::uint32_t t = 0; t < n[3]; ++t)
                    for (std::uint32_t s = 0; s < n[2]; ++s) {
                        const std::size_t pixel =
                            (std::size_t{tile} * 128 + v * 8 + t) * 128 + u * 8 + s;
                        is_of_a_tile[pixel] = true;
                        for (std::size_t c = 0; c < 3; ++c, ++i)
                            differing +=
                                load_sample(pixels.data() + (pixel * 4 + c) * sample, type) !=
                                load_sample(expected.data() + i * sample, type);
                    }
        EXPECT_EQ(differing, 0u);
    }
    std::size_t touched = 0;
    for (std::size_t pixel = 0; pixel < is_of_a_tile.size(); ++pixel)
        touched += !is_of_a_tile[pixel] && std::memcmp(pixels.data() + pixel * 4 * sample,
                                                       untouched.data(), 4 * sample) != 0;
    EXPECT_EQ(touched, 0u);
    return {tiles, refused};
}

// TESSERA_GPU_MUTANTS sets the number of mutants, 100 by default.
TEST_F(GpuDecode, AnyBytesAreRefusedOrDecodedAsOnTheCpu) {
    const char* const asked = std::getenv("TESSERA_GPU_MUTANTS");
    const unsigned long most = asked != nullptr ? std::strtoul(asked, nullptr, 10) : 100;
    Mutants all;
    for (std::uint32_t seed = 77; all.tried < most && !HasFailure(); ++seed)
        for (const auto& [type, copies] : {std::pair{SampleType::unorm8, 0.},
                                           {SampleType::half16, 0.},
                                           {SampleType::unorm8, 0.5},
                                           {SampleType::half16, 0.5}}) {
            const Mutants some = expect_mutants_alike(seed, type, copies);
            all.tried += some.tried;
            all.refused += some.refused;
        }
    EXPECT_GT(all.refused, all.tried / 10);
    EXPECT_LT(all.refused, all.tried * 9 / 10);
    if (asked != nullptr)
        std::printf("%lu mutants, %lu refused\n", all.tried, all.refused);
}

} // namespace
} // namespace tessera::test
