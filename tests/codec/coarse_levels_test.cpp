// Files with coarse levels: the size of the levels, and the agreement of both decoders.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/texels/level_texels.h"
#include "format/container/syntax.h"
#include "format/tile/colour_transform.h"
#include "tests/reference/spec_decoder.h"
#include "tests/support/layered_files.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::layered_files;

using namespace test;
namespace reference = tessera_reference;

TEST(Layers, CostAtMostThreePerCentAndChangeNoTexel) {
    const auto plain = encode_scene("composed", scene_size, false, quick());
    ASSERT_TRUE(plain.ok());
    const Layered& layered = shared_file();
    ASSERT_EQ(layered.report.coarse_levels.size(), 2u);
    EXPECT_LE(static_cast<double>(layered.file.size()),
              1.03 * static_cast<double>(plain->file.size()));
    const auto a = wrap_memory(plain->file), b = wrap_memory(layered.file);
    const auto da = Decoder::open(*a), db = Decoder::open(*b);
    ASSERT_TRUE(da.ok() && db.ok());
    EXPECT_EQ(texels_of(*da, Box4::whole(scene_size)), texels_of(*db, Box4::whole(scene_size)));
}

TEST(Layers, SameBytesOnAnyNumberOfThreads) {
    const auto one = encode_scene("composed", scene_size, true, quick(60, 1));
    const auto five = encode_scene("composed", scene_size, true, quick(60, 5));
    ASSERT_TRUE(one.ok() && five.ok());
    EXPECT_EQ(one->file, shared_file().file);
    EXPECT_EQ(five->file, shared_file().file);
}

TEST(Layers, SizeTargetsIncludeCoarseLevels) {
    EncodeOptions options = quick();
    options.rate = {RateTarget::Kind::bytes, 30000};
    const auto file = encode_scene("composed", scene_size, true, options);
    ASSERT_TRUE(file.ok()) << file.status().message();
    EXPECT_LE(file->file.size(), 30000u);
    EXPECT_GE(file->file.size(), 29000u);
    EXPECT_EQ(file->report.file_bytes, file->file.size());
}

TEST(Layers, WorkForHalfFloatsOneChannelAndLosslessFiles) {
    const auto lamps = encode_scene("lamps", {32, 32, 8, 8}, true, quick());
    ASSERT_TRUE(lamps.ok()) << lamps.status().message();
    EXPECT_FALSE(lamps->report.coarse_levels.empty());
    EncodeOptions exact = quick();
    exact.rate = {RateTarget::Kind::max_error, 0};
    const auto lossless = encode_scene("gallery", {32, 32, 8, 8}, true, exact);
    ASSERT_TRUE(lossless.ok()) << lossless.status().message();
    EXPECT_FALSE(lossless->report.coarse_levels.empty());
    EXPECT_EQ(lossless->report.max_error, 0);
    for (const Layered* file : {&*lamps, &*lossless}) {
        std::string error;
        EXPECT_TRUE(reference::decode(file->file, error)) << error;
    }
    const TextureDesc grey{{40, 17, 5, 4}, SampleType::unorm8, 1};
    for (const NamedTexture& named : named_textures(grey)) {
        MemoryTexture texture(grey, named.sample);
        Bytes file;
        EncodeOptions options = quick();
        options.layers = true;
        const auto report = encode_memory(texture, file, options);
        ASSERT_TRUE(report.ok()) << named.name << report.status().message();
        std::string error;
        const auto decoded = reference::decode(file, error);
        ASSERT_TRUE(decoded) << named.name << error;
        EXPECT_EQ(decoded->coarse.size(), report->coarse_levels.size());
    }
}

TEST(Layers, BothDecodersAgreeOnEveryLevel) {
    const Layered& layered = shared_file();
    std::string error;
    const auto decoded = reference::decode(layered.file, error);
    ASSERT_TRUE(decoded) << error;
    const auto source = wrap_memory(layered.file);
    const auto decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder.ok());
    EXPECT_EQ(texels_of(*decoder, Box4::whole(scene_size)), decoded->texels);
    // If no tile of level 0 has been received, the library interpolates level 1.
    const ContainerReader& container = decoder->container();
    ASSERT_EQ(container.levels().size(), 3u);
    ASSERT_EQ(decoded->coarse.size(), 2u);
    const std::uint64_t end = container.locate(0)->offset;
    const auto part = wrap_memory(std::span(layered.file).first(end));
    const auto partial = Decoder::open(*part, {true, false});
    ASSERT_TRUE(partial.ok()) << partial.status().message();
    Bytes expected(decoded->texels.size());
    const Level &full = container.levels()[0], &coarse = container.levels()[1];
    const Box4 whole = Box4::whole(scene_size), support = support_of(whole, full, coarse);
    ASSERT_EQ(support, Box4::whole(coarse.size));
    interpolate_level(decoded->coarse[0], support, whole, full, coarse, container.desc(), expected);
    // Empty tiles of level 0 count as received and show the background.
    const Bytes shown = texels_of(*partial, whole);
    for (std::uint64_t tile = 0; tile < container.grid().tiles(); ++tile) {
        const Box4 box = container.grid().box(tile);
        const Bytes& from = container.locate(tile)->length == 0 ? decoded->texels : expected;
        Bytes a(container.desc().box_bytes(box)), b(a.size());
        copy_box(box, whole, shown, box, a, 3);
        copy_box(box, whole, from, box, b, 3);
        ASSERT_EQ(a, b) << tile;
    }
}

} // namespace
} // namespace tessera
