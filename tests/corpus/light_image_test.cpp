// Pictures of light, Radiance HDR and EXR: their pixels, and files that are cut short or damaged.
#include "corpus/picture_file.h"
#include "format/samples.h"
#include "tests/support/pictures.h"
#include "tests/support/test_folder.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <cmath>
#include <cstring>

namespace tessera::corpus {
namespace {

using support::expect_no_beginning;
using support::light_of;

constexpr std::uint32_t hdr_width = 11, hdr_height = 5;

// Radiance pictures.

const std::string hdr_head = "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n";

// Exponents vary, so that all four components have runs and differences.
std::array<std::uint8_t, 4> rgbe(std::uint32_t x, std::uint32_t y) {
    return {static_cast<std::uint8_t>(10 + x / 4), static_cast<std::uint8_t>(50 * y + 2 * x), 7,
            static_cast<std::uint8_t>(125 + y + x / 6)};
}

void expect_light(const std::string& file, std::uint32_t w = hdr_width) {
    const auto image = light_of(file);
    ASSERT_TRUE(image.ok()) << image.status().message();
    ASSERT_EQ(image->width, w);
    ASSERT_EQ(image->height, hdr_height);
    for (std::uint32_t y = 0; y < hdr_height; ++y)
        for (std::uint32_t x = 0; x < w; ++x) {
            const auto p = rgbe(x, y);
            for (glm::length_t c = 0; c < 3; ++c)
                ASSERT_EQ(
                    image->texels[y * w + x][c],
                    std::ldexp(static_cast<float>(p[static_cast<std::size_t>(c)]), p[3] - 136))
                    << x << " " << y;
        }
}

void expect_hdr_refused(const std::string& file, const std::string& words) {
    const auto image = light_of(file);
    ASSERT_FALSE(image.ok());
    EXPECT_EQ(image.status().code(), ErrorCode::invalid_file);
    EXPECT_NE(image.status().message().find(words), std::string::npos) << image.status().message();
}

std::string quad(const std::array<std::uint8_t, 4>& pixel) {
    return {pixel.begin(), pixel.end()};
}

// Scanlines of `count` pixels each; at(i, k) is pixel k of scanline i.
template <class At> std::string flat(std::uint32_t scanlines, std::uint32_t count, const At& at) {
    std::string text;
    for (std::uint32_t i = 0; i < scanlines; ++i)
        for (std::uint32_t k = 0; k < count; ++k)
            text += quad(at(i, k));
    return text;
}

std::string old_runs(std::uint32_t w) {
    std::string text;
    for (std::uint32_t y = 0; y < hdr_height; ++y)
        for (std::uint32_t x = 0; x < w;) {
            std::uint32_t run = 1;
            while (x + run < w && rgbe(x + run, y) == rgbe(x, y))
                ++run;
            text += quad(rgbe(x, y));
            if (run > 1)
                text += std::string("\1\1\1") + static_cast<char>(run - 1);
            x += run;
        }
    return text;
}

std::string new_runs() {
    std::string text;
    for (std::uint32_t y = 0; y < hdr_height; ++y) {
        text += std::string("\2\2\0", 3) + static_cast<char>(hdr_width);
        for (std::size_t c = 0; c < 4; ++c)
            for (std::uint32_t x = 0; x < hdr_width;) {
                std::uint32_t run = 1;
                while (x + run < hdr_width && rgbe(x + run, y)[c] == rgbe(x, y)[c])
                    ++run;
                text += static_cast<char>(run > 1 ? 128 + run : 1);
                text += static_cast<char>(rgbe(x, y)[c]);
                x += run;
            }
    }
    return text;
}

TEST(HdrLight, KeepsFloats) {
    const std::string size = "-Y 5 +X 11\n";
    const auto at = [](std::uint32_t y, std::uint32_t x) { return rgbe(x, y); };
    const std::string plain = hdr_head + size + flat(hdr_height, hdr_width, at);
    expect_light(plain);
    expect_light(hdr_head + size + old_runs(hdr_width));
    expect_light(hdr_head + size + new_runs());
    expect_light("#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 5 +X 11\r\n" + new_runs());
    expect_no_beginning(plain, light_of);
    expect_no_beginning(hdr_head + size + old_runs(hdr_width), light_of);
    expect_no_beginning(hdr_head + size + new_runs(), light_of);
}

TEST(HdrLight, BecomesATexture) {
    const std::string file = hdr_head + "-Y 1 +X 3\n" + quad({128, 64, 0, 128}) +
                             quad({0, 0, 0, 0}) + quad({1, 255, 128, 130});
    const auto read =
        decode_image({reinterpret_cast<const unsigned char*>(file.data()), file.size()});
    ASSERT_TRUE(read.ok()) << read.status().message();
    const Image& image = *read;
    const std::vector<std::array<std::uint8_t, 4>> expected{
        {188, 137, 0, 255}, {0, 0, 0, 255}, {34, 255, 255, 255}};
    EXPECT_EQ(image.texels, expected); // 0.5 and 0.25; 1/64
}

TEST(HdrLight, LongRuns) {
    // 300 pixels: the count of a run takes two marks, 255 + 1 * 44 and then 0 * 256.
    const std::array<std::uint8_t, 4> pixel{9, 8, 7, 130};
    std::string text = "#?RADIANCE\n\n-Y 1 +X 300\n" + quad(pixel);
    text += std::string("\1\1\1\x2b", 4) + std::string("\1\1\1\1", 4); // 43 + 256
    const auto image = light_of(text);
    ASSERT_TRUE(image.ok()) << image.status().message();
    ASSERT_EQ(image->texels.size(), 300u);
    for (const glm::vec3& t : image->texels)
        EXPECT_EQ(t, glm::vec3(9, 8, 7) / 64.0f);
}

TEST(HdrLight, AllDirections) {
    for (const bool left : {false, true})
        for (const bool up : {false, true}) {
            const auto column = [&](std::uint32_t k) { return left ? hdr_width - 1 - k : k; };
            const auto line = [&](std::uint32_t i) { return up ? hdr_height - 1 - i : i; };
            const std::string y = up ? "+Y 5" : "-Y 5", x = left ? "-X 11" : "+X 11";
            expect_light(hdr_head + y + " " + x + "\n" +
                         flat(hdr_height, hdr_width, [&](std::uint32_t i, std::uint32_t k) {
                             return rgbe(column(k), line(i));
                         }));
            expect_light(hdr_head + x + " " + y + "\n" +
                         flat(hdr_width, hdr_height, [&](std::uint32_t i, std::uint32_t k) {
                             return rgbe(column(i), line(k));
                         }));
        }
}

TEST(HdrLight, Xyz) {
    // White of D65 and a colour outside of RGB, whose red would be negative.
    const auto image = light_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 2\n" +
                                quad({122, 128, 139, 129}) + quad({0, 128, 0, 129}));
    ASSERT_TRUE(image.ok()) << image.status().message();
    for (glm::length_t c = 0; c < 3; ++c)
        EXPECT_NEAR(image->texels[0][c], 1.0f, 0.02f);
    EXPECT_EQ(image->texels[1].x, 0.0f);
    EXPECT_NEAR(image->texels[1].y, 1.876f, 0.001f);
}

TEST(HdrLight, RefusesDamagedFiles) {
    // A file that ends in its first run, and one of runs without length: a reader may not wait for
    // more.
    expect_hdr_refused("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 8\n" +
                           std::string("\2\2\0\x08", 4),
                       "too early");
    expect_hdr_refused(hdr_head + "-Y 8 +X 8\n" + std::string("\2\2\0\x08", 4) +
                           std::string(1000, '\0'),
                       "a run of 0 pixels in a scanline of 8");
    expect_hdr_refused(hdr_head + "-Y 8 +X 8\n" + std::string("\2\2\0\x08\x89z", 6) +
                           std::string(99, '\1'),
                       "a run of 9 pixels");
    // Only the header and some pixels.
    expect_hdr_refused("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n" +
                           std::string(1000, '\x80'),
                       "too early");
    expect_hdr_refused(hdr_head + "-Y 8 +X 8\n" + std::string(400, '\1'), "leaves its scanline");
    expect_hdr_refused(hdr_head + "-Y 1 +X 8\n" + std::string("\2\2\0\x09", 4), "another length");
    for (const char* size :
         {"-Y 8", "-Y 8 +Y 8", "8 8", "-Y 8 +X", "-Y 8 +X 8z", "-Y 8 +X 99999999999"})
        expect_hdr_refused(hdr_head + size + "\n" + std::string(999, '\x80'), "is not its size");
    const auto format = light_of("#?RADIANCE\nFORMAT=other\n\n-Y 1 +X 1\nabcd");
    EXPECT_EQ(format.status().code(), ErrorCode::unsupported);
    expect_hdr_refused("#?RADIANCE\n" + std::string(5000, 'x'), "too long");
    expect_hdr_refused("no picture", "not an .hdr, .exr or .pfm picture");
    const auto large = light_of(hdr_head + "-Y 16384 +X 16384\n" + std::string(99, '\x80'));
    EXPECT_EQ(large.status().code(), ErrorCode::unsupported);
}

// EXR as light. Views in EXR have tests in tests/tools/texture_io_test.cpp.

class ExrLight : public testing::Test {
protected:
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "a.exr").string(); }
    std::filesystem::path folder_ = test::make_test_folder("exr_light");
};

TEST_F(ExrLight, KeepsFloats) {
    const std::vector<float> values{0.1f, 1e6f, -2.0f, 3.0f, 4.0f, 5.0f};
    Imf::Header header(Imath::Box2i({-4, 7}, {-3, 7}), Imath::Box2i({-4, 7}, {-3, 7}));
    Imf::FrameBuffer frame;
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        frame.insert(names[c],
                     Imf::Slice::Make(Imf::FLOAT, values.data() + c, {-4, 7}, 2, 1, 12, 24));
    }
    {
        Imf::OutputFile file(path().c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(1);
    }
    const auto image = light_of(test::slurp(path()));
    ASSERT_TRUE(image.ok()) << image.status().message();
    ASSERT_EQ(image->texels.size(), 2u);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(image->texels[i / 3][static_cast<glm::length_t>(i % 3)], values[i]);
    expect_no_beginning(test::slurp(path()), light_of);
}

// Chroma is stored for every other pixel, and needs a constant colour here to come back exactly.
TEST_F(ExrLight, ReadsLuminanceAndChroma) {
    const std::vector<Imf::Rgba> pixels(std::size_t{40 * 30}, Imf::Rgba(0.5f, 0.25f, 2.0f, 1.0f));
    {
        Imf::RgbaOutputFile file(path().c_str(), 40, 30, Imf::WRITE_YC);
        file.setFrameBuffer(pixels.data(), 1, 40);
        file.writePixels(30);
    }
    const std::string bytes = test::slurp(path());
    const auto image = light_of(bytes);
    ASSERT_TRUE(image.ok()) << image.status().message();
    ASSERT_EQ(image->texels.size(), pixels.size());
    for (const glm::vec3& t : image->texels) {
        EXPECT_NEAR(t.x, 0.5f, 0.005f);
        EXPECT_NEAR(t.y, 0.25f, 0.005f);
        EXPECT_NEAR(t.z, 2.0f, 0.02f);
    }
    const auto source = wrap_memory(std::as_bytes(std::span(bytes)));
    auto reader = open_picture_file(*source);
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    EXPECT_EQ((*reader)->shape().channels, 3);
    std::uint32_t rows = 0;
    const Status read = (*reader)->read_rows(SampleType::unorm8, 7, 11,
                                             [&](std::uint32_t y, std::span<const std::byte> row) {
                                                 EXPECT_EQ(y, 7 + rows++);
                                                 EXPECT_NEAR(std::to_integer<int>(row[3]), 128, 1);
                                                 EXPECT_NEAR(std::to_integer<int>(row[4]), 64, 1);
                                                 EXPECT_EQ(std::to_integer<int>(row[5]), 255);
                                             });
    EXPECT_TRUE(read.ok()) << read.message();
    EXPECT_EQ(rows, 4u);
}

TEST_F(ExrLight, ReadsLuminanceAndChromaOfFullResolution) {
    // Y, (R - Y) / Y and (B - Y) / Y of (0.5, 0.25, 2) with the weights of BT.709.
    const float luma = 0.2126f * 0.5f + 0.7152f * 0.25f + 0.0722f * 2.0f;
    const float values[3] = {luma, (0.5f - luma) / luma, (2.0f - luma) / luma};
    Imf::Header header(1, 1);
    Imf::FrameBuffer frame;
    const char* const names[] = {"Y", "RY", "BY"};
    for (std::size_t c = 0; c < 3; ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &values[c], {0, 0}, 1, 1));
    }
    {
        Imf::OutputFile file(path().c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(1);
    }
    const auto image = light_of(test::slurp(path()));
    ASSERT_TRUE(image.ok()) << image.status().message();
    EXPECT_NEAR(image->texels[0].x, 0.5f, 0.001f);
    EXPECT_NEAR(image->texels[0].y, 0.25f, 0.001f);
    EXPECT_NEAR(image->texels[0].z, 2.0f, 0.001f);
}

// Writes one FLOAT channel Y of 3x2 pixels, 1 to 6, with these windows.
class ExrWindows : public ExrLight {
protected:
    std::string file(const Imath::Box2i& display, const Imath::Box2i& data) const {
        const std::vector<float> values{1, 2, 3, 4, 5, 6};
        Imf::Header header(display, data);
        header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
        Imf::FrameBuffer frame;
        frame.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), data.min, 3, 2));
        {
            Imf::OutputFile out(path().c_str(), header);
            out.setFrameBuffer(frame);
            out.writePixels(2);
        }
        return test::slurp(path());
    }
};

// The picture is the display window; pixels that the file does not have are 0.
TEST_F(ExrWindows, PixelsArePlacedByTheDisplayWindow) {
    const std::string bytes = file({{10, 20}, {14, 23}}, {{11, 21}, {13, 22}});
    const auto image = light_of(bytes);
    ASSERT_TRUE(image.ok()) << image.status().message();
    ASSERT_EQ(image->width, 5u);
    ASSERT_EQ(image->height, 4u);
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 5; ++x) {
            const bool is_there = x >= 1 && x < 4 && y >= 1 && y < 3;
            const auto expected = is_there ? 3 * (y - 1) + x : 0u;
            EXPECT_EQ(image->texels[5 * y + x].x, static_cast<float>(expected)) << x << " " << y;
        }
    // The same from the middle on, as views are read.
    const auto source = wrap_memory(std::as_bytes(std::span(bytes)));
    auto reader = open_picture_file(*source);
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    std::vector<std::uint16_t> seen;
    ASSERT_TRUE((*reader)
                    ->read_rows(SampleType::half16, 2, 4,
                                [&](std::uint32_t, std::span<const std::byte> row) {
                                    seen.resize(seen.size() + row.size() / 2);
                                    std::memcpy(seen.data() + seen.size() - row.size() / 2,
                                                row.data(), row.size());
                                })
                    .ok());
    ASSERT_EQ(seen.size(), 10u);
    for (std::size_t i = 0; i < 10; ++i)
        EXPECT_EQ(seen[i], i >= 1 && i < 4 ? float_to_half(static_cast<float>(i + 3)) : 0) << i;
}

TEST_F(ExrWindows, PixelsBeyondTheDisplayWindowAreLeftOut) {
    const auto image = light_of(file({{1, 1}, {4, 1}}, {{0, 0}, {2, 1}}));
    ASSERT_TRUE(image.ok()) << image.status().message();
    ASSERT_EQ(image->texels.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(image->texels[i].x, i < 2 ? static_cast<float>(i + 5) : 0.0f);
}

TEST_F(ExrWindows, WindowsApartAndTooLargeAreRefused) {
    EXPECT_EQ(light_of(file({{0, 0}, {3, 3}}, {{10, 10}, {12, 11}})).status().code(),
              ErrorCode::invalid_file);
    EXPECT_EQ(light_of(file({{0, 0}, {1 << 21, 1 << 21}}, {{0, 0}, {2, 1}})).status().code(),
              ErrorCode::unsupported);
}

} // namespace
} // namespace tessera::corpus
