// The pixels of photographs: alpha, masks, linear light and deep samples.
#include "tests/support/photographs.h"

#include <gtest/gtest.h>

#include "tests/support/png_memory.h"

namespace tessera::corpus {
namespace {

using test::spit;

class PhotoPixelsTest : public testing::Test {
protected:
    void SetUp() override { folder_ = test::make_test_folder("photo_pixels"); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    // A photograph of one row, 2 pixels wide.
    PosedPhotograph photograph(const std::string& file) const {
        spit(folder_ / "photo", file);
        PosedPhotograph photograph;
        photograph.path = (folder_ / "photo").string();
        photograph.camera.width = 2;
        photograph.camera.height = 1;
        return photograph;
    }
    void expect_texels(const PosedPhotograph& photograph,
                       const std::optional<glm::dvec3>& background,
                       const std::array<float, 4>& first,
                       const std::array<float, 4>& second) const {
        const auto pixels = read_photograph(photograph, background);
        ASSERT_TRUE(pixels.ok()) << pixels.status().message();
        ASSERT_EQ(pixels->texels.size(), 2u);
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_NEAR(pixels->texels[0][c], first[c], 1e-6) << c;
            EXPECT_NEAR(pixels->texels[1][c], second[c], 1e-6) << c;
        }
    }

    std::filesystem::path folder_;
};

// A PNG of one row from RGBA samples of 8 or 16 bits, big-endian.
std::string rgba_png(int bits, std::vector<unsigned char> samples) {
    std::string file;
    png_structp out = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(out);
    test::write_png_to(out, file);
    png_set_IHDR(out, info, 2, 1, bits, PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(out, info);
    png_write_row(out, samples.data());
    png_write_end(out, nullptr);
    png_destroy_write_struct(&out, &info);
    return file;
}

TEST_F(PhotoPixelsTest, KeepsAlphaOrMixesTheBackground) {
    const PosedPhotograph p = photograph(rgba_png(8, {255, 51, 0, 255, 255, 51, 0, 102}));
    expect_texels(p, std::nullopt, {1, 0.2f, 0, 1}, {1, 0.2f, 0, 0.4f});
    expect_texels(p, glm::dvec3(1, 1, 0.5), {1, 0.2f, 0, 1}, {1, 0.68f, 0.3f, 1});
}

TEST_F(PhotoPixelsTest, ReadsSixteenBits) {
    const PosedPhotograph p = photograph(
        rgba_png(16, {0x40, 0x00, 0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0, 0, 0x20, 0, 0, 0x80, 0}));
    const auto pixels = read_photograph(p);
    ASSERT_TRUE(pixels.ok()) << pixels.status().message();
    EXPECT_NEAR(pixels->texels[0][0], 16384.0 / 65535, 1.0 / 8192);
    EXPECT_EQ(pixels->texels[0][1], 1.0f);
    EXPECT_NEAR(pixels->texels[1][1], 32.0 / 65535, 1e-6) << "less than a step of 8 bits";
    EXPECT_NEAR(pixels->texels[1][3], 0.5, 1.0 / 4096);
}

// A mask of half the size, black on the left.
TEST_F(PhotoPixelsTest, WeighsByTheMask) {
    PosedPhotograph p = photograph("P6\n2 1\n255\nabcdef");
    p.mask_path = (folder_ / "mask").string();
    const std::array<float, 4> first = {97 / 255.f, 98 / 255.f, 99 / 255.f, 0},
                               second = {100 / 255.f, 101 / 255.f, 102 / 255.f, 1};
    spit(p.mask_path, std::string("P5\n2 1\n255\n\0\xff", 13));
    expect_texels(p, std::nullopt, first, second);
    expect_texels(p, glm::dvec3(0.5), first, second);
    spit(p.mask_path, std::string("P5\n4 2\n255\n\0\0\xff\xff\0\0\xff\xff", 19));
    expect_texels(p, std::nullopt, first, second);
    spit(p.mask_path, std::string("P5\n2 4\n255\n12345678", 19));
    const auto wrong = read_photograph(p);
    ASSERT_FALSE(wrong.ok());
    EXPECT_EQ(wrong.status().message(),
              p.mask_path + ": has 2x4 pixels, but its camera is for 2x1");
}

// PFM has linear light: 0.5 is 0.7353570 in sRGB. Light above 1 is white.
TEST_F(PhotoPixelsTest, DisplaysLinearLight) {
    std::string file = "PF\n2 1\n-1\n";
    for (const float light : {0.5f, 0.0f, 1.0f, 7.0f, -1.0f, 0.001f})
        test::append_number(file, light);
    const auto pixels = read_photograph(photograph(file));
    ASSERT_TRUE(pixels.ok()) << pixels.status().message();
    EXPECT_NEAR(pixels->texels[0][0], 0.7353570, 1e-6);
    EXPECT_EQ(pixels->texels[0][1], 0);
    EXPECT_NEAR(pixels->texels[0][2], 1, 1e-6);
    EXPECT_NEAR(pixels->texels[1][0], 1, 1e-6);
    EXPECT_EQ(pixels->texels[1][1], 0);
    EXPECT_NEAR(pixels->texels[1][2], 0.01292, 1e-5);
}

TEST_F(PhotoPixelsTest, RefusesWhatIsNotTheCamerasPicture) {
    const PosedPhotograph p = photograph(test::plain_ppm(3, 1, "abc"));
    const auto wrong = read_photograph(p);
    ASSERT_FALSE(wrong.ok());
    EXPECT_EQ(wrong.status().code(), ErrorCode::invalid_file);
    EXPECT_EQ(wrong.status().message(), p.path + ": has 3x1 pixels, but its camera is for 2x1");
    EXPECT_EQ(read_photograph(photograph("nothing")).status().code(), ErrorCode::invalid_file);
    std::filesystem::remove(p.path);
    EXPECT_EQ(read_photograph(p).status().code(), ErrorCode::io);
}

} // namespace
} // namespace tessera::corpus
