// Encoding an edited texture again: unedited tiles of the old file are kept.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/container_reader.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/round_trips.h"
#include "tests/support/test_folder.h"
#include "tests/support/tool_words.h"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

using Kind = RateTarget::Kind;

constexpr Extent4 reuse_size{24, 16, 5, 4}, reuse_tile{8, 8, 5, 4}; // 6 tiles

// A file and its decoded texels.
struct Old {
    Old(const TextureDesc& desc, const SwitchedOptions& options, const std::string& name = "smooth")
        : texels(named_texture(desc, name)), encoded(encode(texels, options)),
          bytes(wrap_memory(encoded.file)), decoder(std::move(*Decoder::open(*bytes))) {
        texels.texels = decode_all(encoded.file, desc);
    }
    MemoryTexture texels;
    Encoded encoded;
    std::unique_ptr<ByteSource> bytes;
    Decoder decoder;
};

SwitchedOptions tiled(RateTarget rate, int effort = copies_effort) {
    SwitchedOptions options{options_for(rate, effort), {}};
    options.tile_extent = reuse_tile;
    options.tools = "-align"; // alignment_test.cpp
    return options;
}

EncodeOptions reusing(const Old& old, int effort = copies_effort) {
    EncodeOptions options = options_for({}, effort);
    options.reuse = &old.decoder;
    return options;
}

// Inverts bits of one texel in all views. A smaller change might not be worth any bits, so that the
// tile would not change.
void change(MemoryTexture& texture, std::uint32_t u, std::uint32_t v) {
    const TextureDesc& desc = texture.desc();
    const std::size_t count = desc.size[axis_s] * desc.size[axis_t] * desc.texel_bytes();
    for (std::byte& sample :
         std::span(texture.texels).subspan((v * desc.size[axis_u] + u) * count, count))
        sample ^= std::byte{0x3F};
}

// Compares the tiles of two files: '=' for equal bytes, '!' for different ones.
std::string same_tiles(const Decoder& a, const Decoder& b) {
    std::string same;
    for (std::uint64_t i = 0; i < a.container().tile_count(); ++i) {
        const Bytes ours(a.container().load_tile(i)->bytes.begin(),
                         a.container().load_tile(i)->bytes.end());
        const Bytes theirs(b.container().load_tile(i)->bytes.begin(),
                           b.container().load_tile(i)->bytes.end());
        same += ours == theirs ? '=' : '!';
    }
    return same;
}

TEST(TileReuse, UneditedTexelsGiveTheSameFile) {
    struct Case {
        SampleType type;
        const char* texture;
        RateTarget rate;
        int effort;
        bool layers;
    };
    const SampleType bytes = SampleType::unorm8, halves = SampleType::half16;
    for (const Case& c : {Case{bytes, "smooth", {Kind::quality, 60}, usual_effort, false},
                          Case{halves, "grazing_ramp", {Kind::quality, 60}, copies_effort, false},
                          Case{bytes, "noise", {Kind::quality, 75}, quick_effort, true},
                          Case{bytes, "smooth", {Kind::quality, 90}, 0, true},
                          Case{halves, "smooth", {Kind::max_error, 3}, quick_effort, false},
                          Case{bytes, "noise", {Kind::bpt, 9}, quick_effort, false}}) {
        SwitchedOptions options = tiled(c.rate, c.effort);
        options.layers = c.layers;
        Old old(describe(reuse_size, c.type), options, c.texture);
        EncodeOptions again = reusing(old, c.effort);
        again.layers = c.layers;
        const Encoded second = encode(old.texels, again);
        EXPECT_EQ(second.file, old.encoded.file) << c.texture << " " << c.rate.value;
        EXPECT_EQ(second.report.kept_tiles, 6u);
        EXPECT_EQ(second.report.max_error, 0);
    }
}

TEST(TileReuse, AnEditChangesItsTileOnly) {
    for (const char* name : {"smooth", "noise", "black"}) {
        Old old(describe(reuse_size), tiled({Kind::quality, 70}), name);
        change(old.texels, 9, 3); // in tile 1
        const Encoded second = encode(old.texels, reusing(old, quick_effort));
        EXPECT_EQ(second.report.kept_tiles, 5u) << name;
        const auto bytes = wrap_memory(second.file);
        const auto decoder = Decoder::open(*bytes);
        ASSERT_TRUE(decoder) << decoder.status().message();
        EXPECT_EQ(same_tiles(old.decoder, *decoder), "=!====") << name;
        const Difference d = difference(
            old.texels.texels, decode_all(second.file, old.texels.desc()), SampleType::unorm8);
        EXPECT_NEAR(second.report.psnr, d.psnr, 1e-9);
        EXPECT_GT(d.psnr, 30) << name;
        EXPECT_EQ(second.report.max_error, d.largest);
    }
}

// Encoding decoded texels again without reuse would lose quality a second time.
TEST(TileReuse, TexelsBesideAnEditLoseLittle) {
    Old old(describe(reuse_size), tiled({Kind::quality, 60}), "noise");
    const Bytes before = old.texels.texels;
    change(old.texels, 9, 3);
    const Bytes again = decode_all(encode(old.texels, reusing(old)).file, old.texels.desc());
    const Bytes all_again =
        decode_all(encode(old.texels, tiled({Kind::quality, 60})).file, old.texels.desc());
    const Box4 beside{{8, 4, 0, 0}, {16, 8, 5, 4}}; // in the edited tile
    const Bytes original = crop(old.texels, before, beside);
    const double kept =
        difference(original, crop(old.texels, again, beside), SampleType::unorm8).psnr;
    EXPECT_GT(
        kept,
        3 + difference(original, crop(old.texels, all_again, beside), SampleType::unorm8).psnr);
}

TEST(TileReuse, KeepsLosslessAndStoredTiles) {
    for (const SampleType type : types) {
        Old old(describe(reuse_size, type), tiled({Kind::max_error, 0}, quick_effort), "noise");
        change(old.texels, 20, 15);
        const Encoded second = encode(old.texels, reusing(old, quick_effort));
        EXPECT_EQ(second.report.psnr, 999);
        EXPECT_EQ(decode_all(second.file, old.texels.desc()), old.texels.texels);
    }
}

TEST(TileReuse, MaskedTexelsMayChange) {
    Old old(describe(reuse_size), tiled({Kind::quality, 60}));
    MemoryTexture mask(describe({24, 16, 1, 1}, SampleType::unorm8, 1),
                       [](int u, int, int, int, int) { return u < 12 ? 1.0 : 0.0; });
    change(old.texels, 13, 0);
    EncodeOptions options = reusing(old);
    options.mask = &mask;
    EXPECT_EQ(encode(old.texels, options).report.kept_tiles, 6u);
    change(old.texels, 2, 0);
    EXPECT_EQ(encode(old.texels, options).report.kept_tiles, 5u);
}

TEST(TileReuse, RefusesFilesThatCannotBeReused) {
    Old old(describe(reuse_size), tiled({Kind::quality, 60}, quick_effort));
    Bytes file;
    for (const TextureDesc& desc :
         {describe({24, 16, 4, 5}), describe(reuse_size, SampleType::half16),
          describe(reuse_size, SampleType::unorm8, 4)}) {
        MemoryTexture other = named_texture(desc, "black");
        const auto report = encode_memory(other, file, reusing(old));
        EXPECT_EQ(report.status().code(), ErrorCode::bad_argument);
        EXPECT_NE(report.status().message().find("another texture: 24x16x5x4, 3 x unorm8"),
                  std::string::npos)
            << report.status().message();
    }
    // A file that is cut off.
    const Bytes beginning(old.encoded.file.begin(), old.encoded.file.end() - 1);
    const auto part = wrap_memory(beginning);
    const auto partial = Decoder::open(*part, {.allow_partial = true});
    ASSERT_TRUE(partial) << partial.status().message();
    EncodeOptions options = reusing(old);
    options.reuse = &*partial;
    EXPECT_EQ(encode_memory(old.texels, file, options).status().code(), ErrorCode::bad_argument);
    // A damaged tile.
    Bytes damaged = old.encoded.file;
    damaged.back() ^= std::byte{1};
    const auto bytes = wrap_memory(damaged);
    const auto broken = Decoder::open(*bytes);
    ASSERT_TRUE(broken);
    options.reuse = &*broken;
    const auto report = encode_memory(old.texels, file, options);
    EXPECT_EQ(report.status().code(), ErrorCode::invalid_file);
    EXPECT_NE(report.status().message().find("tile "), std::string::npos)
        << report.status().message();
}

TEST(TileReuse, WorksWithAJournalAndOverTheReusedFile) {
    const std::filesystem::path folder = make_test_folder("tile_reuse");
    Old old(describe(reuse_size), tiled({Kind::quality, 60}, quick_effort));
    const std::string path = (folder / "old.tess").string();
    ASSERT_TRUE(encode_file(old.texels, path, tiled({Kind::quality, 60}, quick_effort)));
    const auto opened = Decoder::open_file(path);
    ASSERT_TRUE(opened);
    old.texels.texels.clear();
    old.texels.texels.resize(old.texels.desc().box_bytes(Box4::whole(reuse_size)));
    ASSERT_TRUE(
        opened->decode_box(Box4::whole(reuse_size), old.texels.texels, {.threads = 1}).ok());
    change(old.texels, 0, 15); // in tile 3
    EncodeOptions options = reusing(old, quick_effort);
    options.reuse = &*opened;
    const Encoded in_memory = encode(old.texels, options);
    options.journal = JournalUse::start;
    const auto report = encode_file(old.texels, path, options);
    ASSERT_TRUE(report) << report.status().message();
    EXPECT_EQ(report->kept_tiles, 5u);
    const std::string file = slurp(path);
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(file)), in_memory.file));
    EXPECT_FALSE(std::filesystem::exists(journal_path(path)));
    std::filesystem::remove_all(folder);
}

} // namespace
} // namespace tessera::test
