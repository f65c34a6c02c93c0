// Tests views in pictures of every kind, and pictures with false claims.
#include "tests/support/test_folder.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/picture_layout.h"
#include "tools/texture_io/texture_io.h"
#include "tools/texture_io/views_io.h"

#include <bit>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/stat.h>

namespace tessera {
namespace {

using test::slurp;
using test::spit;

namespace fs = std::filesystem;

class ViewsIo : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("views");
        fs::create_directories(folder_ / "v");
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string at(const std::string& name) const { return (folder_ / name).string(); }

    // Writes a picture whose samples are 10 times its number, plus a small offset per pixel.
    void put(const std::string& name, unsigned number, std::uint32_t width = 4,
             std::uint8_t channels = 3) const {
        std::vector<std::byte> samples(std::size_t{width} * 3 * channels);
        for (std::size_t i = 0; i < samples.size(); ++i)
            samples[i] = static_cast<std::byte>(10 * number + i / channels);
        const auto file = encode_picture(picture_kind_of_name(name), {width, 3, channels},
                                         SampleType::unorm8, samples);
        ASSERT_TRUE(file.ok()) << file.status().message();
        spit(at(name), {reinterpret_cast<const char*>(file->data()), file->size()});
    }
    void put_png(const std::string& name, png_uint_32 format, const void* pixels,
                 const void* colours = nullptr) const {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = 4;
        image.height = 3;
        image.format = format;
        image.colormap_entries = colours != nullptr ? 4 : 0;
        ASSERT_TRUE(png_image_write_to_file(&image, at(name).c_str(), 0, pixels, 0, colours));
    }

    // The texels of the folder v. Sets error_ and desc_.
    std::vector<std::byte> texels(const TextureHints& hints = {}, const std::string& name = "v") {
        const auto opened = open_texture(at(name), hints);
        error_ = opened.status();
        if (!opened.ok())
            return {};
        desc_ = opened->source->desc();
        planar_ = opened->planar;
        const Box4 whole = Box4::whole(desc_.size);
        std::vector<std::byte> out(desc_.box_bytes(whole));
        error_ = opened->source->begin_slab(whole);
        if (error_.ok())
            error_ = opened->source->read(whole, out);
        return out;
    }
    void refused(ErrorCode code, const std::string& words, const TextureHints& hints = {},
                 const std::string& name = "v") {
        texels(hints, name);
        EXPECT_EQ(error_.code(), code) << words << ": " << error_.message();
        EXPECT_NE(error_.message().find(words), std::string::npos) << error_.message();
    }

    fs::path folder_;
    Status error_;
    TextureDesc desc_;
    bool planar_ = false;
};

TEST_F(ViewsIo, ReadsPngJpegAndExr) {
    for (const std::string ending : {".png", ".PNG", ".jpg", ".exr"}) {
        for (unsigned n = 0; n < 4; ++n)
            put("v/x_" + std::to_string(n) + ending, n);
        TextureHints hints;
        hints.type = SampleType::unorm8;
        const auto found = texels(hints);
        ASSERT_TRUE(error_.ok()) << ending << error_.message();
        EXPECT_EQ(desc_.size, (Extent4{4, 3, 2, 2}));
        EXPECT_TRUE(planar_);
        // In the order v, u, t, s: the first texel of all four views, then the second.
        for (std::size_t i = 0; i < 8; ++i)
            EXPECT_NEAR(std::to_integer<int>(found[3 * i]), 10.0 * (i % 4) + i / 4,
                        ending == ".jpg" ? 2 : 0)
                << ending << i;
        if (ending == ".exr") {
            texels();
            EXPECT_EQ(desc_.type, SampleType::half16);
        }
        fs::remove_all(at("v"));
        fs::create_directories(at("v"));
    }
}

TEST_F(ViewsIo, ReadsEveryKindOfPng) {
    std::vector<std::uint16_t> deep(4 * 3 * 3);
    for (std::size_t i = 0; i < deep.size(); ++i)
        deep[i] = static_cast<std::uint16_t>(257 * i + (i % 2 ? 100 : -100));
    deep[0] = 1;
    put_png("v/a0.png", PNG_FORMAT_LINEAR_RGB, deep.data());
    auto found = texels();
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.channels, 3);
    for (std::size_t i = 0; i < deep.size(); ++i) // rounded to 8 bits
        EXPECT_EQ(std::to_integer<std::size_t>(found[i]), i);
    TextureHints hints;
    hints.type = SampleType::half16;
    found = texels(hints);
    ASSERT_TRUE(error_.ok()) << error_.message();
    std::uint16_t half = 0;
    std::memcpy(&half, found.data() + 2 * 35, 2);
    EXPECT_EQ(half, 0x3071); // 9095 / 65535 = 0.1388
    fs::remove(at("v/a0.png"));

    const unsigned char colours[] = {1, 2, 3, 40, 50, 60, 7, 8, 9, 100, 110, 120};
    const unsigned char places[12] = {0, 1, 2, 3, 3, 2, 1, 0, 0, 0, 0, 1};
    put_png("v/a0.png", PNG_FORMAT_RGB_COLORMAP, places, colours);
    found = texels();
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.channels, 3);
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_EQ(std::to_integer<unsigned>(found[3 * i + 1]), colours[3 * places[i] + 1]);
    for (std::uint8_t channels : {1, 2, 4}) {
        put("v/a0.png", 2, 4, channels);
        found = texels();
        ASSERT_TRUE(error_.ok()) << error_.message();
        EXPECT_EQ(desc_.channels, channels);
        EXPECT_EQ(std::to_integer<int>(found[0]), 20);
    }
}

TEST_F(ViewsIo, ReadsQuiltsAndMosaics) {
    // Eight views in two columns, with a row and a column of pixels left over.
    std::vector<std::byte> samples(9 * 13, std::byte{255});
    for (std::uint32_t y = 1; y < 13; ++y) // views begin at the bottom left
        for (std::uint32_t x = 0; x < 8; ++x)
            samples[y * 9 + x] = static_cast<std::byte>((12 - y) / 3 * 2 + x / 4);
    const auto file = encode_png({9, 13, 1}, samples);
    ASSERT_TRUE(file.ok());
    spit(at("a_qs2x4a0.75.png"), {reinterpret_cast<const char*>(file->data()), file->size()});
    auto found = texels({}, "a_qs2x4a0.75.png");
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{4, 3, 8, 1}));
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_EQ(std::to_integer<std::size_t>(found[i]), i % 8);
    TextureHints hints;
    hints.views.grid = ViewGrid{2, 4};
    hints.views.order = ViewOrder{false, false, true, false};
    found = texels(hints, "a_qs2x4a0.75.png"); // t runs downwards, numbers run upwards
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{4, 3, 2, 4}));
    hints = {};
    hints.views.mosaic = ViewGrid{3, 13};
    found = texels(hints, "a_qs2x4a0.75.png");
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{3, 1, 3, 13}));
    EXPECT_EQ(found[13 * 3 + 3 * 2 + 1], samples[2 * 9 + 4]); // u 1, t 2, s 1
    hints.views.mosaic = ViewGrid{2, 2};
    refused(ErrorCode::bad_argument, "9x13 pixels are no mosaic of angular images of 2x2", hints,
            "a_qs2x4a0.75.png");
    hints = {};
    hints.views.quilt = ViewGrid{10, 1};
    refused(ErrorCode::bad_argument, "no quilt of 10x1", hints, "a_qs2x4a0.75.png");
}

// A box needs all rows with texels of its cameras. Of other cameras in these rows it needs none.
TEST(PictureLayout, KnowsTheRowsOfAQuiltThatABoxNeeds) {
    const Extent4 size{4, 3, 5, 2}; // ten cameras in twelve cells, and two spare rows of pixels
    for (const bool along_columns : {false, true})
        for (const bool bottom_up : {false, true}) {
            ViewLayout quilt;
            quilt.quilt = ViewGrid{3, 4};
            quilt.order = ViewOrder{along_columns, true, bottom_up, false};
            const PictureLayout layout(size, quilt, 14);
            for (std::uint32_t t = 0; t < size[3]; ++t)
                for (std::uint32_t s = 0; s < size[2]; ++s) {
                    const Box4 box{{0, 0, s, t}, {4, 3, s + 1, t + 1}};
                    const auto [first, last] = layout.rows_of(box);
                    EXPECT_EQ(last - first, 3u);
                    unsigned runs = 0;
                    for (std::uint32_t y = first; y < last; ++y)
                        layout.visit_row(y, box, [&](const Box4& run, std::uint32_t) {
                            runs += run.begin[axis_s] == s && run.begin[axis_t] == t &&
                                    run.texels() == 4;
                        });
                    EXPECT_EQ(runs, 3u) << s << " " << t;
                }
            const auto [first, last] = layout.rows_of(Box4::whole(size));
            EXPECT_EQ(last - first, 12u);
        }
}

// What is read from such names is written with the same names.
TEST_F(ViewsIo, KeepsNamesThatBeginAtOne) {
    for (unsigned n = 1; n <= 4; ++n)
        put("v/b\303\274hne_000" + std::to_string(n) + ".png", n);
    ViewsFacts facts;
    ASSERT_TRUE(open_views(at("v"), {}, facts).ok());
    EXPECT_EQ(facts.layout.pattern, "b\303\274hne_{n:4+1}.png");
    // A .tess keeps them, unless they are not UTF-8.
    EXPECT_EQ(open_texture(at("v"), {})->metadata.at(views_key), "names:b\303\274hne_{n:4+1}.png");
    fs::create_directories(at("latin"));
    for (unsigned n = 1; n <= 4; ++n)
        put("latin/b\374hne_" + std::to_string(n) + ".png", n);
    EXPECT_FALSE(open_texture(at("latin"), {})->metadata.contains(views_key));
    const auto found = texels();
    ASSERT_TRUE(error_.ok()) << error_.message();
    const auto sink = create_views(at("w"), desc_, {}, facts.layout, 1);
    ASSERT_TRUE(sink.ok()) << sink.status().message();
    const Box4 whole = Box4::whole(desc_.size);
    ASSERT_TRUE((*sink)->begin_slab(whole).ok());
    ASSERT_TRUE((*sink)->write(whole, found).ok());
    ASSERT_TRUE((*sink)->end_slab().ok());
    ASSERT_TRUE((*sink)->finish().ok());
    for (unsigned n = 1; n <= 4; ++n)
        EXPECT_TRUE(fs::exists(at("w/b\303\274hne_000" + std::to_string(n) + ".png"))) << n;
    EXPECT_EQ(texels({}, "w"), found);
}

// Kinds that are read and not written: their views have the same names with another ending.
TEST_F(ViewsIo, ReadsKindsThatAreNotWritten) {
    for (unsigned n = 1; n <= 4; ++n) {
        const char sample = static_cast<char>(10 * n);
        spit(at("v/x" + std::to_string(n) + ".ppm"), "P6 4 3 255\n" + std::string(36, sample));
    }
    ViewsFacts facts;
    ASSERT_TRUE(open_views(at("v"), {}, facts).ok());
    EXPECT_EQ(facts.layout.pattern, "x{n+1}.png");
    EXPECT_NE(facts.told.find("x{n+1}.ppm"), std::string::npos) << facts.told;
    const auto found = texels();
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{4, 3, 2, 2}));
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(std::to_integer<std::size_t>(found[3 * i]), 10 * (i + 1));
    TextureHints hints;
    hints.type = SampleType::half16;
    ASSERT_TRUE(open_views(at("v"), hints, facts).ok());
    EXPECT_EQ(facts.layout.pattern, "x{n+1}.exr");
    // TGA is recognised by its name, and where that is missing by its footer.
    const auto tga = [](char sample) {
        const char header[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 3, 0, 24, 0};
        return std::string(header, sizeof header) + std::string(36, sample);
    };
    fs::create_directories(at("tga"));
    for (unsigned n = 1; n <= 4; ++n)
        spit(at("tga/x" + std::to_string(n) + ".tga"), tga(static_cast<char>(10 * n)));
    const auto of_tga = texels({}, "tga");
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{4, 3, 2, 2}));
    EXPECT_TRUE(of_tga == found);
    spit(at("quilt.png"), tga('\x07') + std::string(8, '\0') + "TRUEVISION-XFILE." + '\0');
    TextureHints two;
    two.views.quilt = ViewGrid{2, 1};
    texels(two, "quilt.png");
    EXPECT_TRUE(error_.ok()) << error_.message();
    // One such picture is a mosaic, whatever its name says.
    spit(at("quilt.raw"), "P5 4 3 255\n" + std::string(12, '\x07'));
    fs::rename(at("quilt.raw"), at("quilt.png"));
    hints = {};
    hints.views.quilt = ViewGrid{2, 1};
    const auto quilt = texels(hints, "quilt.png");
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{2, 3, 2, 1}));
    EXPECT_EQ(create_texture(at("out.tif"), desc_, {}, 1, {}).status().code(),
              ErrorCode::unsupported);
}

// Content that moves sideways from (0,0) to (1,0) shows that the first number is the column.
TEST_F(ViewsIo, MotionDecidesUnclearAxes) {
    for (const bool column_first : {false, true}) {
        for (unsigned a = 0; a < 2; ++a)
            for (unsigned b = 0; b < 2; ++b) {
                const unsigned s = column_first ? a : b, t = column_first ? b : a;
                std::string file = "P5 32 24 255\n";
                for (unsigned y = 0; y < 24; ++y)
                    for (unsigned x = 0; x < 32; ++x) {
                        const unsigned cell = (x + 2 * s) / 3 * 7919 + (y + 2 * t) / 3 * 104729;
                        file += static_cast<char>(cell * 2654435761u >> 24);
                    }
                spit(at("v/(" + std::to_string(a) + "," + std::to_string(b) + ").pgm"), file);
            }
        ViewsFacts facts;
        ASSERT_TRUE(open_views(at("v"), {}, facts).ok());
        EXPECT_EQ(facts.layout.pattern, column_first ? "({s},{t}).png" : "({t},{s}).png");
        EXPECT_EQ(facts.layout.order.columns, column_first);
        EXPECT_EQ(facts.told.find("(columns, as the views move)") != std::string::npos,
                  column_first)
            << facts.told;
        TextureHints hints;
        hints.views.order = ViewOrder{}; // the option decides
        ASSERT_TRUE(open_views(at("v"), hints, facts).ok());
        EXPECT_EQ(facts.layout.pattern, "({t},{s}).png");
    }
}

// Samples beyond the range of halves are counted once, however often they are read.
TEST_F(ViewsIo, CountsClampedSamplesOnce) {
    for (unsigned n = 0; n < 4; ++n) {
        std::string row = "Pf 2 2 -1\n";
        for (const float value : {1.0f, n == 2 ? 1e6f : 2.0f, 3.0f, n > 0 ? -7e4f : 4.0f})
            row.append(reinterpret_cast<const char*>(&value), 4);
        spit(at("v/x" + std::to_string(n) + ".pfm"), row);
    }
    Warnings warnings(false);
    TextureHints hints;
    hints.warnings = &warnings;
    const auto opened = open_texture(at("v"), hints);
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    const Box4 whole = Box4::whole(opened->source->desc().size);
    for (int pass = 0; pass < 3; ++pass)
        ASSERT_TRUE(opened->source->begin_slab(whole).ok());
    const Json list = warnings.json();
    ASSERT_EQ(list.size(), 1u) << list;
    EXPECT_EQ(list[0]["count"], 4);
    EXPECT_EQ(list[0]["first"], at("v/x1.pfm"));
    Warnings strict(true);
    hints.warnings = &strict;
    const auto again = open_texture(at("v"), hints);
    ASSERT_TRUE(again.ok());
    const Status status = again->source->begin_slab(whole);
    EXPECT_EQ(status.code(), ErrorCode::unsupported);
    EXPECT_NE(status.message().find("beyond +-65504"), std::string::npos) << status.message();
}

TEST_F(ViewsIo, RefusesWhatIsNoPicture) {
    const auto fresh = [&] {
        fs::remove_all(at("v"));
        fs::create_directories(at("v"));
        for (unsigned n = 0; n < 4; ++n)
            put("v/x" + std::to_string(n) + ".png", n);
    };
    fresh();
    fs::remove(at("v/x2.png"));
    ASSERT_EQ(::mkfifo(at("v/x2.png").c_str(), 0600), 0);
    refused(ErrorCode::io, "x2.png: cannot open: it is not a regular file");
    fs::remove(at("v/x2.png"));
    fs::create_directories(at("v/x2.png"));
    refused(ErrorCode::io, "x2.png: cannot open: it is a directory");
    fresh();
    ASSERT_EQ(::mkfifo(at("v/tessera.json").c_str(), 0600), 0);
    refused(ErrorCode::io, "tessera.json: cannot open");
    fresh();
    put("v/x1.png", 1, 5);
    refused(ErrorCode::invalid_file, "x1.png: has 5x3 pixels of 3 channels instead of 4x3");
    put("v/x1.png", 1, 4, 1);
    refused(ErrorCode::invalid_file, "x1.png: has 4x3 pixels of 1 channels instead of 4x3");
    fresh();
    fs::remove(at("v/x1.png"));
    refused(ErrorCode::invalid_file, "v: x1.png: this view is missing from 2x2 views");
    fresh();
    put("v/x01.png", 1);
    refused(ErrorCode::invalid_file, "two files for one view: x01.png and x1.png");
    fresh();
    for (unsigned n = 0; n < 4; ++n)
        put("v/depth" + std::to_string(n) + ".png", n);
    refused(ErrorCode::bad_argument, "more than one pattern");
    TextureHints hints;
    hints.views.pattern = "x{n}.png";
    texels(hints);
    EXPECT_TRUE(error_.ok()) << error_.message();
}

TEST_F(ViewsIo, RefusesPicturesThatClaimTooMuchOrEndTooEarly) {
    put("v/x0.png", 0);
    std::string png = slurp(at("v/x0.png"));
    spit(at("v/x0.png"), png.substr(0, png.size() - 12));
    refused(ErrorCode::invalid_file, "x0.png: damaged PNG: it ends too early");
    // 2^18 x 2^18 pixels are 206 GB. The header's checksum is corrected.
    png.replace(16, 8, std::string("\0\4\0\0\0\4\0\0", 8));
    std::uint32_t crc = ~0u;
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= static_cast<unsigned char>(png[i]);
        for (int bit = 0; bit < 8; ++bit)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    for (std::size_t i = 0; i < 4; ++i)
        png[29 + i] = static_cast<char>(~crc >> (24 - 8 * i));
    spit(at("v/x0.png"), png);
    refused(ErrorCode::invalid_file, "bytes cannot hold its pixels");
    fs::remove(at("v/x0.png"));
    put("v/x0.jpg", 3, 64);
    const std::string jpeg = slurp(at("v/x0.jpg"));
    for (std::size_t length = 4; length + 8 < jpeg.size(); length += 7) {
        spit(at("v/x0.jpg"), jpeg.substr(0, length));
        refused(ErrorCode::invalid_file, "x0.jpg: damaged JPEG");
        spit(at("v/x0.jpg"), jpeg.substr(0, length) + "\xff\xd9");
        refused(ErrorCode::invalid_file, "x0.jpg: ");
    }
    spit(at("v/x0.jpg"), "no picture");
    refused(ErrorCode::invalid_file,
            "x0.jpg: not a PNG, JPEG, EXR, TIFF, WebP, PPM or other known picture");
}

} // namespace
} // namespace tessera
