#include "codec/encoder.h"

#include "tests/support/memory_texture.h"
#include "tests/support/meshes.h"
#include "tests/support/test_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

namespace tessera {
namespace {

using Kind = RateTarget::Kind;

const TextureDesc rgb{{40, 20, 6, 5}, SampleType::unorm8, 3};

// The error message for `options`, or "" if they are valid.
std::string objection(const EncodeOptions& options, const TextureDesc& desc = rgb,
                      ErrorCode code = ErrorCode::bad_argument) {
    const Status status = check_options(desc, options);
    EXPECT_TRUE(status.ok() || status.code() == code) << status.message();
    return status.message();
}

std::string rate_objection(RateTarget rate, const TextureDesc& desc = rgb) {
    EncodeOptions options;
    options.rate = rate;
    return objection(options, desc);
}

bool contains(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

TEST(CheckOptions, AcceptDefaults) {
    EXPECT_EQ(objection(EncodeOptions{}), "");
    EXPECT_EQ(objection(EncodeOptions{}, {{1, 1, 1, 1}, SampleType::half16, 1}), "");
}

TEST(CheckOptions, RefuseInvalidTextures) {
    EXPECT_NE(objection(EncodeOptions{}, {{40, 0, 6, 5}, SampleType::unorm8, 3}), "");
    EXPECT_NE(objection(EncodeOptions{}, {{40, 20, 6, 5}, SampleType::unorm8, 5}), "");
    // 2^32 tiles, one more than a file can have.
    const TextureDesc vast{{1u << 20, 1u << 20, 1u << 4, 1u << 4}, SampleType::unorm8, 1};
    EXPECT_TRUE(contains(objection(EncodeOptions{}, vast, ErrorCode::unsupported), "2^32"));
}

TEST(CheckOptions, RefuseRatesOutOfRange) {
    for (const double quality : {0.0, 100.5, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_NE(rate_objection({Kind::quality, quality}), "") << quality;
    EXPECT_EQ(rate_objection({Kind::quality, 1}), "");
    EXPECT_NE(rate_objection({Kind::psnr, 121}), "");
    EXPECT_NE(rate_objection({Kind::max_error, 0.5}), "");
    EXPECT_NE(rate_objection({Kind::max_error, 256}), "");
    EXPECT_EQ(rate_objection({Kind::max_error, 256}, {{4, 4, 4, 4}, SampleType::half16, 3}), "");
    EXPECT_NE(rate_objection({Kind::bpt, -1}), "");
    EXPECT_NE(rate_objection({static_cast<Kind>(77), 1}), "");
}

// The message names the smallest accepted size. One byte less is refused, and no file of the
// texture is smaller.
TEST(CheckOptions, RefuseSizesBelowTheSmallestFile) {
    test::MemoryTexture black(rgb, [](int, int, int, int, int) { return 0.0; });
    std::vector<std::byte> file;
    const auto report = encode_memory(black, file, EncodeOptions());
    ASSERT_TRUE(report) << report.status().message();
    double least = 1;
    while (rate_objection({Kind::bytes, least}) != "")
        ++least;
    EXPECT_GT(least, 100);
    EXPECT_LE(least, static_cast<double>(file.size()));
    EXPECT_TRUE(contains(rate_objection({Kind::bytes, least - 1}),
                         ("smaller than " + std::to_string(static_cast<int>(least))).c_str()));
    const auto texels = static_cast<double>(texel_count(rgb.size));
    EXPECT_EQ(rate_objection({Kind::bpt, 8 * least / texels}), "");
    EXPECT_NE(rate_objection({Kind::bpt, 8 * (least - 1) / texels}), "");
    // More tiles need a larger index.
    EncodeOptions small_tiles;
    small_tiles.rate = {Kind::bytes, least};
    small_tiles.tile_extent = {1, 1, 1, 1};
    EXPECT_NE(objection(small_tiles), "");
}

TEST(CheckOptions, RefuseTilesOutOfRange) {
    for (const Extent4& tile : {Extent4{257, 1, 1, 1}, Extent4{1, 1, 33, 1}, Extent4{8, 8, 0, 8},
                                Extent4{64, 64, 8, 13}}) {
        EncodeOptions options;
        options.tile_extent = tile;
        EXPECT_TRUE(contains(objection(options), "tile")) << to_string(tile);
    }
    EncodeOptions options;
    options.tile_extent = {64, 64, 8, 12};
    EXPECT_EQ(objection(options), "");
    options.rate = {RateTarget::Kind::max_error, 0};
    EXPECT_TRUE(contains(objection(options), "more than 65536 texels, the most with a maximum"));
    options.tile_extent = {64, 32, 32, 1};
    EXPECT_EQ(objection(options), "");
}

TEST(CheckOptions, RefuseAlphaWithoutAlphaChannel) {
    EncodeOptions options;
    options.description.alpha = AlphaMode::straight;
    EXPECT_EQ(objection(options), "alpha is straight with 3 channels");
    EXPECT_EQ(objection(options, {{4, 4, 4, 4}, SampleType::unorm8, 4}), "");
}

TEST(CheckOptions, RefuseInvalidDescriptions) {
    EncodeOptions sphere;
    sphere.description.proxy = Proxy::sphere;
    EXPECT_TRUE(contains(objection(sphere), "sphere_radius"));
    sphere.description.sphere_radius = 2;
    EXPECT_EQ(objection(sphere), "");
    EncodeOptions unknown;
    unknown.description.transfer = static_cast<Transfer>(200);
    EXPECT_EQ(objection(unknown), "transfer 200 is unknown");
}

TEST(CheckOptions, RefuseInvalidMeshes) {
    EncodeOptions options;
    options.description.proxy = Proxy::mesh;
    EXPECT_EQ(objection(options), "the proxy is a mesh, but no mesh is given");
    options.mesh = *encode_mesh(test::six_charts(1, false), {});
    EXPECT_EQ(objection(options), "");
    options.mesh.pop_back();
    EXPECT_TRUE(contains(objection(options), "mesh"));
    options.description.proxy = Proxy::none;
    EXPECT_EQ(objection(options), "a mesh is given, but the proxy is not a mesh");
}

TEST(CheckOptions, RefuseInvalidMetadata) {
    const auto with = [](const std::string& key, const std::string& value) {
        EncodeOptions options;
        options.metadata = {{key, value}};
        return objection(options);
    };
    EXPECT_EQ(with("Title", "M\xC3\xBCnster"), "");
    EXPECT_TRUE(contains(with("Title", "M\xFCnster"), "UTF-8"));
    EXPECT_TRUE(contains(with("T\xFCtle", "x"), "UTF-8"));
    EXPECT_TRUE(contains(with("Title", std::string("a\0b", 3)), "NUL"));
    EXPECT_NE(with("", "x"), "");
    EXPECT_NE(with(std::string(256, 'k'), "x"), "");
    EXPECT_NE(with("Title", std::string((1u << 20) + 1, 'x')), "");
    EncodeOptions much;
    for (int i = 0; i < 17; ++i)
        much.metadata[std::to_string(i)] = std::string(1u << 20, 'x');
    EXPECT_TRUE(contains(objection(much), "2^24"));
}

TEST(CheckOptions, RefuseMasksOfTheWrongSize) {
    test::MemoryTexture wrong({{40, 20, 6, 4}, SampleType::unorm8, 1},
                              [](int, int, int, int, int) { return 1.0; });
    EncodeOptions options;
    options.mask = &wrong;
    EXPECT_TRUE(contains(objection(options), "mask"));
}

// Wrong options are reported before a journal or any other file is created.
TEST(CheckOptions, RunBeforeAnythingIsWritten) {
    const std::filesystem::path folder = test::make_test_folder("check_options");
    test::MemoryTexture texture(rgb, [](int, int, int, int, int) { return 0.5; });
    EncodeOptions options;
    options.rate = {Kind::bytes, 100};
    for (const JournalUse journal : {JournalUse::none, JournalUse::start, JournalUse::resume}) {
        options.journal = journal;
        EXPECT_EQ(encode_file(texture, (folder / "x.tess").string(), options).status().code(),
                  ErrorCode::bad_argument);
        EXPECT_TRUE(std::filesystem::is_empty(folder));
    }
    std::filesystem::remove_all(folder);
}

} // namespace
} // namespace tessera
