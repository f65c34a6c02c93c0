// The whole encoder: its report, and identical files on every path.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/pass/steps.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/tile_encoder/tile_encoder.h"
#include "format/container_reader.h"
#include "format/tile/features.h"
#include "tests/support/efforts.h"
#include "tests/support/memory_texture.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/random_box.h"
#include "tests/support/round_trips.h"
#include "tests/support/test_folder.h"
#include "tests/support/tool_words.h"

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

using Kind = RateTarget::Kind;

TEST(Codec, ReportMatchesTheDecodedTexelsAndBoxesAreCrops) {
    Random random(31);
    for (const Extent4& size :
         {Extent4{7, 5, 3, 2}, Extent4{1, 1, 1, 1}, Extent4{65, 33, 9, 9}, Extent4{40, 33, 17, 5},
          Extent4{1, 70, 1, 40}, Extent4{2, 1, 33, 1}})
        for (const SampleType type : types)
            for (int channels = 1; channels <= 4; ++channels) {
                const bool large = texel_count(size) > 100000;
                if (large && channels != 1 + 2 * (type == SampleType::unorm8))
                    continue; // one large texture of each type
                const TextureDesc desc = describe(size, type, channels);
                MemoryTexture texture =
                    named_texture(desc, random.chance(0.5) ? "smooth" : "noise");
                const double quality = std::array{20.0, 60.0, 100.0}[random() % 3];
                const int effort = large ? quick_effort : copies_effort;
                const Encoded encoded =
                    encode(texture, options_for({Kind::quality, quality}, effort));
                const std::string where = to_string(size) + " channels " +
                                          std::to_string(channels) + " quality " +
                                          std::to_string(quality);
                ASSERT_EQ(encoded.report.file_bytes, encoded.file.size()) << where;
                ASSERT_EQ(encoded.report.raw_bytes, texture.texels.size()) << where;
                const Bytes all = decode_all(encoded.file, desc);
                const Difference d = difference(texture.texels, all, type);
                ASSERT_NEAR(encoded.report.psnr, d.psnr, 1e-9) << where;
                ASSERT_EQ(encoded.report.max_error, d.largest) << where;
                ASSERT_NEAR(encoded.report.bits_per_texel,
                            8.0 * static_cast<double>(encoded.file.size()) /
                                static_cast<double>(texel_count(size)),
                            1e-9);
                for (int i = 0; i < 6; ++i) {
                    const Box4 box = random_box(random, size);
                    ASSERT_EQ(decode(encoded.file, box, i % 2 ? Integrity::page : Integrity::tile),
                              crop(texture, all, box))
                        << where << " box " << to_string(box);
                }
            }
}

TEST(Codec, HardTexturesRoundTrip) {
    for (const SampleType type : types) {
        const TextureDesc desc = describe({33, 17, 6, 5}, type);
        std::map<std::string, std::size_t> bytes;
        for (const NamedTexture& named : named_textures(desc)) {
            MemoryTexture texture(desc, named.sample);
            const Encoded encoded = encode(texture, options_for({Kind::quality, 75}));
            const Difference d = difference(texture.texels, decode_all(encoded.file, desc), type);
            EXPECT_NEAR(encoded.report.psnr, d.psnr, 1e-9) << named.name;
            EXPECT_GT(d.psnr, type == SampleType::unorm8 ? 34 : 30) << named.name;
            bytes[named.name] = encoded.file.size();
            if (std::string(named.name) == "black" || std::string(named.name) == "constant") {
                EXPECT_EQ(d.largest, 0) << named.name;
                EXPECT_LT(encoded.file.size(), 500u) << named.name;
            }
        }
        EXPECT_LT(bytes["bright_texel"], 1500u);
        EXPECT_LT(bytes["lambert"], bytes["smooth"]); // independent of the angle
        EXPECT_LT(bytes["smooth"], bytes["noise"]);
    }
}

// A block of 4096 texels has more coefficients than three planes may code in one segment. The last
// coefficients hold all energy of a checkerboard, so the search must split the block.
TEST(Codec, SplitsBlocksWithCoefficientsBeyondTheLengthLimit) {
    for (const Extent4& size : {Extent4{8, 8, 8, 8}, Extent4{16, 16, 4, 4}, Extent4{17, 20, 3, 4}})
        for (const char* name : {"checkerboard", "noise"}) {
            const TextureDesc desc = describe(size);
            MemoryTexture texture = named_texture(desc, name);
            const Encoded encoded = encode(texture, options_for({Kind::quality, 75}));
            EXPECT_GT(encoded.report.psnr, 34) << name << " " << to_string(size);
        }
}

// One block of all 81,920 texels codes this wave. Positions of its coefficients exceed 16 bits.
TEST(Codec, BlocksMayBeAsLargeAsTiles) {
    const Extent4 size{64, 64, 5, 4};
    MemoryTexture texture({size, SampleType::unorm8, 1}, [](int, int, int, int t, int) {
        return 0.5 + 0.4 * std::cos(3.14159265 * (t + 0.5) / 4);
    });
    EncodeOptions options = options_for({Kind::quality, 60}, quick_effort);
    options.tile_extent = size;
    const Encoded encoded = encode(texture, options);
    EXPECT_GT(encoded.report.psnr, 45);
    const auto source = wrap_memory(encoded.file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    EXPECT_LT(reader->load_tile(0)->bytes.size(), 16u);
}

TEST(Codec, EveryEffortRoundTrips) {
    const TextureDesc desc = describe({17, 10, 7, 5}, SampleType::unorm8, 4);
    MemoryTexture texture = named_texture(desc, "smooth");
    for (int effort = 0; effort <= most_effort; ++effort) {
        const Encoded encoded = encode(texture, options_for({Kind::quality, 80}, effort));
        const Difference d = difference(texture.texels, decode_all(encoded.file, desc), desc.type);
        EXPECT_NEAR(encoded.report.psnr, d.psnr, 1e-9) << effort;
        EXPECT_GT(d.psnr, 38) << effort;
    }
}

TEST(Codec, TileExtentsRoundTripOrAreRefused) {
    const TextureDesc desc = describe({35, 20, 9, 6});
    MemoryTexture texture = named_texture(desc, "smooth");
    for (const Extent4& tile : {Extent4{1, 1, 1, 1}, Extent4{7, 3, 5, 2}, Extent4{32, 1, 32, 32},
                                Extent4{16, 16, 16, 16}}) {
        EncodeOptions options = options_for({Kind::quality, 60});
        options.tile_extent = tile;
        const Encoded encoded = encode(texture, options);
        EXPECT_NEAR(encoded.report.psnr,
                    difference(texture.texels, decode_all(encoded.file, desc), desc.type).psnr,
                    1e-9)
            << to_string(tile);
    }
    for (const Extent4& tile : {Extent4{0, 1, 1, 1}, Extent4{257, 1, 1, 1}, Extent4{1, 1, 33, 1},
                                Extent4{32, 32, 32, 32}}) {
        EncodeOptions options;
        options.tile_extent = tile;
        Bytes out;
        EXPECT_EQ(encode_memory(texture, out, options).status().code(), ErrorCode::bad_argument);
    }
}

TEST(SameBytes, ForAnyNumberOfThreads) {
    for (const SampleType type : types)
        for (const auto& [rate, effort] : {std::pair{RateTarget{Kind::quality, 70}, 0},
                                           {RateTarget{Kind::quality, 90}, 3},
                                           {RateTarget{Kind::quality, 50}, most_effort},
                                           {RateTarget{Kind::max_error, 1}, 1},
                                           {RateTarget{Kind::bytes, 3000}, 2}}) {
            if (type == SampleType::half16 && rate.kind != Kind::quality)
                continue;
            MemoryTexture texture = named_texture(describe({21, 12, 5, 5}, type), "smooth");
            EncodeOptions options = options_for(rate, effort);
            options.tile_extent = {16, 8, 4, 4};
            options.threads = 1;
            const Bytes want = encode(texture, options).file;
            for (const unsigned threads : {2u, 5u}) {
                options.threads = threads;
                ASSERT_EQ(encode(texture, options).file, want)
                    << threads << " threads, effort " << effort;
            }
            options.verify = false;
            ASSERT_EQ(encode(texture, options).file, want);
        }
}

// Tile encoders reuse scratch memory, and the number of threads decides which tile came before. In
// nearly empty tiles some trellis states cannot be reached.
TEST(SameBytes, ForAnyPrecedingTile) {
    const TextureDesc desc = describe({32, 32, 8, 8}, SampleType::half16);
    Random random(3);
    MemoryTexture texture(desc, [&](int u, int v, int s, int t, int c) {
        return 1000 * (0.5 + 0.25 * std::sin((u + 2 * s) * 0.5 + c) * std::cos((v + 2 * t) * 0.4) +
                       0.12 * (random.unit() - 0.5));
    });
    const TileGrid grid(desc.size, {16, 16, 4, 4});
    const EffortSettings effort = EffortSettings::of(usual_effort);
    const ColourCoding colour{desc, ColourTransform::ycocg_r, {}};
    for (const double quality : {35., 36.}) {
        const TileCoding coding(
            parameters_for_step(step_of_quality(quality, desc.type), desc, effort), desc.type, 3);
        const BitCosts costs(coding.tables);
        const auto levels_after = [&](std::uint64_t before, std::uint64_t tile) {
            TileEncoder encoder(coding, costs, colour, effort);
            TileLevels levels;
            for (const std::uint64_t i : {before, tile}) {
                Bytes texels(desc.box_bytes(grid.box(i)));
                EXPECT_TRUE(texture.read(grid.box(i), texels));
                encoder.encode({texels, {}}, tile_shape(grid.box(i)), levels);
            }
            return levels;
        };
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile)
            for (std::uint64_t before = 0; before < grid.tiles(); ++before)
                EXPECT_TRUE(levels_after(before, tile) == levels_after(tile, tile))
                    << quality << ": tile " << tile << " after " << before;
    }
}

// Stored tiles (FORMAT.md 3.2).
TEST(StoredTiles, LosslessNoiseTakesHardlyMoreThanItsTexels) {
    for (const SampleType type : types) {
        MemoryTexture texture(describe({9, 16, 8, 8}, type),
                              [](int, int, int, int, int) { return 0; });
        Random random(3);
        for (std::byte& byte : texture.texels)
            byte = static_cast<std::byte>(random.range(0, 255));
        for (std::size_t i = 1; type == SampleType::half16 && i < texture.texels.size(); i += 2)
            texture.texels[i] &= std::byte{0xFB}; // finite
        const Encoded encoded = encode(texture, options_for({Kind::max_error, 0}, 0));
        EXPECT_LE(encoded.file.size(), texture.texels.size() + 800); // header and index
        EXPECT_EQ(encoded.report.max_error, 0u);
        const auto source = wrap_memory(encoded.file);
        const auto reader = ContainerReader::open(*source);
        ASSERT_TRUE(reader);
        EXPECT_EQ(reader->header().required_features & feature_stored, feature_stored);
    }
}

void put_half(Bytes& texels, std::size_t sample, std::uint16_t half) {
    texels[2 * sample] = static_cast<std::byte>(half & 255);
    texels[2 * sample + 1] = static_cast<std::byte>(half >> 8);
}

TEST(SpecialValues, NonFiniteSamplesAreCountedAndReplaced) {
    const TextureDesc desc = describe({9, 7, 3, 4}, SampleType::half16);
    MemoryTexture texture(desc, [](int u, int, int, int, int) { return 0.5 + u; });
    const std::uint16_t specials[] = {0x7C00, 0xFC00, 0x7E00, 0xFE01,
                                      0x7C01, 0x7DFF, 0x8000, 0x0001};
    for (std::size_t i = 0; i < std::size(specials); ++i)
        put_half(texture.texels, 40 * i + 3, specials[i]);
    EncodeOptions options = options_for({Kind::max_error, 0});
    const Encoded encoded = encode(texture, options);
    EXPECT_EQ(encoded.report.nan_count, 4u);
    EXPECT_EQ(encoded.report.infinity_count, 2u);
    Bytes want = texture.texels;
    const std::uint16_t replaced[] = {0x7BFF, 0xFBFF, 0, 0, 0, 0, 0, 0x0001};
    for (std::size_t i = 0; i < std::size(replaced); ++i)
        put_half(want, 40 * i + 3, replaced[i]);
    EXPECT_EQ(decode_all(encoded.file, desc), want);

    options.strict = true;
    Bytes out;
    const Result<EncodeReport> refused = encode_memory(texture, out, options);
    EXPECT_EQ(refused.status().code(), ErrorCode::invalid_file);
    EXPECT_NE(refused.status().message().find("is infinite"), std::string::npos)
        << refused.status().message();
    EXPECT_TRUE(out.empty());
    for (std::size_t i = 0; i < 6; ++i)
        put_half(texture.texels, 40 * i + 3, 0x3C00);
    EXPECT_TRUE(encode_memory(texture, out, options));
}

// Confirmation fails, for instance, if another program changed the input during the encode.
TEST(Encoder, AnErrorOfConfirmationLeavesNoFile) {
    const TextureDesc desc = describe({9, 7, 3, 2}, SampleType::unorm8);
    MemoryTexture texture = named_texture(desc, "smooth");
    const auto folder = test::make_test_folder("confirm");
    const std::string path = (folder / "x.tess").string();
    EncodeOptions options = options_for({Kind::quality, 50});
    options.effort = 0;
    options.confirm = [] { return Status(ErrorCode::io, "it changed"); };
    for (const JournalUse use : {JournalUse::none, JournalUse::start}) {
        options.journal = use;
        const auto report = encode_file(texture, path, options);
        EXPECT_EQ(report.status().message(), "it changed");
        EXPECT_TRUE(std::filesystem::is_empty(folder));
    }
    Bytes out;
    EXPECT_EQ(encode_memory(texture, out, options).status().code(), ErrorCode::io);
    EXPECT_TRUE(out.empty());
    std::filesystem::remove_all(folder);
}

TEST(SpecialValues, NonFiniteCountsDoNotGrowWithPasses) {
    const TextureDesc desc = describe({17, 9, 5, 4}, SampleType::half16);
    MemoryTexture texture = named_texture(desc, "smooth");
    put_half(texture.texels, 1000, 0x7E00);
    put_half(texture.texels, 1500, 0xFC00);
    for (const RateTarget rate : {RateTarget{Kind::psnr, 40}, RateTarget{Kind::bytes, 1500}}) {
        const Encoded encoded = encode(texture, options_for(rate, 2));
        EXPECT_EQ(encoded.report.nan_count, 1u);
        EXPECT_EQ(encoded.report.infinity_count, 1u);
    }
}

TEST(SpecialValues, ExtremeHalvesStayFinite) {
    const TextureDesc desc = describe({16, 16, 4, 4}, SampleType::half16, 4);
    Random random(33);
    MemoryTexture texture(desc, [&](int, int, int, int, int) {
        return random.chance(0.5) ? 65504.0 : random.chance(0.5) ? -65504.0 : 5.96e-8;
    });
    for (const double quality : {1.0, 50.0, 100.0}) {
        const Bytes texels =
            decode_all(encode(texture, options_for({Kind::quality, quality})).file, desc);
        for (std::size_t i = 0; i < texels.size() / 2; ++i)
            ASSERT_LE(std::abs(code_at(texels, i, desc.type)), 0x7BFF);
    }
}

TEST(Mesh, SurvivesInEveryKindOfFile) {
    MemoryTexture texture = named_texture(describe({7, 5, 3, 2}), "smooth");
    EncodeOptions options;
    options.description.proxy = Proxy::mesh;
    options.description.surface_map = SurfaceMap::mesh_uv;
    options.description.angular_map = AngularMap::octahedral_mirrored;
    options.mesh = *encode_mesh(six_charts(2, true), {});
    for (const bool layers : {false, true}) {
        options.layers = layers;
        const Encoded encoded = encode(texture, options);
        const auto source = wrap_memory(encoded.file);
        const Result<ContainerReader> file = ContainerReader::open(*source);
        ASSERT_TRUE(file);
        EXPECT_EQ(file->description(), options.description);
        EXPECT_TRUE(std::ranges::equal(file->proxy_mesh(), options.mesh));
        EXPECT_TRUE(file->validate().empty());
    }
}

TEST(Metadata, RoundTripsWithTheDescription) {
    MemoryTexture texture = named_texture(describe({7, 5, 3, 2}), "smooth");
    EncodeOptions options;
    options.metadata = {{"Author", "Lëa"}, {"empty", ""}};
    Description& d = options.description;
    d.proxy = Proxy::sphere;
    d.surface_map = SurfaceMap::sphere_longitude_latitude;
    d.angular_map = AngularMap::hemisphere_alpha_beta;
    d.transfer = Transfer::srgb;
    d.primaries = Primaries::bt709;
    d.sphere_centre[1] = 2.5f;
    d.sphere_radius = 1.25f;
    d.viewing_radius[0] = 2;
    d.viewing_radius[1] = 9;
    const Encoded encoded = encode(texture, options);
    const auto source = wrap_memory(encoded.file);
    const Result<Decoder> decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder);
    EXPECT_EQ(decoder->container().description(), d);
    // The encoder's own entries would take more than 1 % of this file.
    EXPECT_EQ(decoder->container().metadata(), options.metadata);
    EXPECT_TRUE(decoder->container().validate().empty());
}

TEST(Metadata, RecordsTheSettingsThatDetermineTheFile) {
    MemoryTexture texture = named_texture(describe({96, 96, 2, 2}), "noise");
    SwitchedOptions options;
    options.effort = 1;
    // Metadata of an earlier encode, as copied from a file that is encoded again.
    options.metadata = {{"Software", "other"}, {"tessera:tools", "-half"}, {"tessera:x", "y"}};
    const auto recorded = [&](RateTarget rate, unsigned threads) {
        options.rate = rate;
        options.threads = threads;
        const Encoded encoded = encode(texture, options);
        const auto source = wrap_memory(encoded.file);
        const Result<Decoder> decoder = Decoder::open(*source);
        return decoder ? decoder->container().metadata() : Metadata();
    };
    for (const auto& [rate, text] :
         {std::pair(RateTarget{Kind::psnr, 40}, "psnr 40"),
          std::pair(RateTarget{Kind::bpt, 24.25}, "bpt 24.25"),
          std::pair(RateTarget{Kind::bytes, 100000}, "bytes 100000"),
          std::pair(RateTarget{Kind::max_error, 2}, "max-error 2"),
          std::pair(RateTarget{Kind::quality, 0.1 + 50}, "quality 50.1")})
        EXPECT_EQ(
            recorded(rate, 1),
            (Metadata{{"Software", "other"}, {"tessera:rate", text}, {"tessera:effort", "1"}}));
    options.tools = "-copies";
    const Metadata switched = recorded({Kind::quality, 50}, 1);
    EXPECT_EQ(switched.at("tessera:tools"), "-copies");
    EXPECT_EQ(recorded({Kind::quality, 50}, 2), switched);
}

// The encoder's own entries take at most 1 % of the file.
TEST(Metadata, SmallFilesDoNotRecordTheSettings) {
    for (const std::uint32_t side : {8u, 32u, 64u, 96u}) {
        MemoryTexture texture = named_texture(describe({side, side, 2, 1}), "noise");
        EncodeOptions options;
        options.effort = 0;
        options.metadata = {{"Author", "someone"}};
        const Encoded encoded = encode(texture, options);
        const auto source = wrap_memory(encoded.file);
        const Result<Decoder> decoder = Decoder::open(*source);
        ASSERT_TRUE(decoder);
        const Metadata& metadata = decoder->container().metadata();
        EXPECT_EQ(metadata.at("Author"), "someone");
        EXPECT_EQ(metadata.size() == 4, encoded.file.size() >= 8192) << encoded.file.size();
        EXPECT_TRUE(metadata.size() == 4 || metadata.size() == 1);
    }
}

} // namespace
} // namespace tessera::test
