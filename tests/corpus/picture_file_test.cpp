// Pictures of every kind: their pixels, and files that are cut short, damaged or too large.
#include "corpus/picture_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <jpeglib.h>
#include <png.h>
#include <webp/encode.h>

#include "tests/support/pictures.h"
#include "tests/support/png_memory.h"
#include "tests/support/test_folder.h"

namespace tessera::corpus {
namespace {

using support::expect_no_beginning;

using Rgba = std::array<std::uint8_t, 4>;
constexpr std::uint32_t width = 11, height = 5;

// No two neighbours are alike, and alpha is 0 nowhere.
Rgba texel(std::uint32_t x, std::uint32_t y) {
    return {static_cast<std::uint8_t>(20 * x + 3), static_cast<std::uint8_t>(50 * y + x),
            static_cast<std::uint8_t>(255 - 7 * x * y),
            static_cast<std::uint8_t>(250 - x - 40 * y)};
}

Rgba opaque(Rgba t) {
    return {t[0], t[1], t[2], 255};
}
Rgba grey(Rgba t) {
    return {t[0], t[0], t[0], 255};
}

std::span<const unsigned char> bytes_of(const std::string& file) {
    return {reinterpret_cast<const unsigned char*>(file.data()), file.size()};
}

Image decoded(const std::string& file) {
    auto image = decode_image(bytes_of(file));
    EXPECT_TRUE(image.ok()) << image.status().message();
    return image.ok() ? std::move(*image) : Image{};
}

// `expected` gets texel(x, y).
template <class Expected>
void expect_texels(const std::string& file, const Expected& expected, int tolerance = 0) {
    const Image image = decoded(file);
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < 4; ++c)
                ASSERT_NEAR(image.texels[y * width + x][c], expected(texel(x, y))[c], tolerance)
                    << x << " " << y << " " << c;
}

void expect_refused(const std::string& file, ErrorCode code, const std::string& words) {
    const auto image = decode_image(bytes_of(file));
    ASSERT_FALSE(image.ok()) << words;
    EXPECT_EQ(image.status().code(), code) << image.status().message();
    EXPECT_NE(image.status().message().find(words), std::string::npos) << image.status().message();
}

void expect_no_beginning(const std::string& file) {
    expect_no_beginning(file, [](const std::string& part) { return decode_image(bytes_of(part)); });
}

std::string little(std::uint64_t value, std::size_t bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i)
        text += static_cast<char>(value >> 8 * i);
    return text;
}

// Of `channels` of texel(); format of png_image.
std::string png(png_uint_32 format, bool deep = false) {
    std::vector<std::uint8_t> pixels;
    std::vector<std::uint16_t> deep_pixels;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < PNG_IMAGE_PIXEL_CHANNELS(format); ++c) {
                const bool is_alpha = PNG_IMAGE_PIXEL_CHANNELS(format) == 2 && c == 1;
                pixels.push_back(texel(x, y)[is_alpha ? 3 : c]);
                // Not exactly the 8-bit values, but nearest to them.
                deep_pixels.push_back(static_cast<std::uint16_t>(
                    std::clamp(257 * pixels.back() + (x % 2 ? 100 : -100), 0, 65535)));
            }
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = format;
    std::string file(1 << 16, '\0');
    png_alloc_size_t size = file.size();
    EXPECT_TRUE(png_image_write_to_memory(
        &image, file.data(), &size, 0,
        deep ? static_cast<void*>(deep_pixels.data()) : pixels.data(), 0, nullptr));
    file.resize(size);
    return file;
}

// Rows as given to libpng: any depth, interlaced or not.
std::string low_png(int depth, int type, int interlace, const std::vector<std::string>& rows,
                    std::span<const png_color> palette = {}, int transparent = -1) {
    std::string file;
    png_structp out = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(out);
    test::write_png_to(out, file);
    png_set_IHDR(out, info, width, static_cast<png_uint_32>(rows.size()), depth, type, interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!palette.empty())
        png_set_PLTE(out, info, palette.data(), static_cast<int>(palette.size()));
    png_color_16 colour{};
    colour.gray = static_cast<png_uint_16>(transparent);
    if (transparent >= 0)
        png_set_tRNS(out, info, nullptr, 0, &colour);
    std::vector<png_bytep> pointers;
    for (const std::string& row : rows)
        pointers.push_back(reinterpret_cast<png_bytep>(const_cast<char*>(row.data())));
    png_set_rows(out, info, pointers.data());
    png_write_png(out, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_destroy_write_struct(&out, &info);
    return file;
}

std::vector<std::string> rgb_rows() {
    std::vector<std::string> rows(height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                rows[y] += static_cast<char>(texel(x, y)[c]);
    return rows;
}

TEST(PictureFile, Png) {
    expect_texels(png(PNG_FORMAT_RGBA), [](Rgba t) { return t; });
    expect_texels(png(PNG_FORMAT_RGB), opaque);
    expect_texels(png(PNG_FORMAT_GRAY), grey);
    expect_texels(png(PNG_FORMAT_GA), [](Rgba t) { return Rgba{t[0], t[0], t[0], t[3]}; });
    expect_texels(png(PNG_FORMAT_LINEAR_RGB, true), opaque); // 16 bits: the nearest of 8
    const std::string interlaced = low_png(8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7, rgb_rows());
    expect_texels(interlaced, opaque);
    expect_no_beginning(png(PNG_FORMAT_RGBA));
    expect_no_beginning(interlaced);
    // Trailing bytes of other programs.
    expect_texels(png(PNG_FORMAT_RGB) + std::string(100'000, 'x'), opaque);
}

TEST(PictureFile, PngOfFewBits) {
    const std::vector<std::string> row{std::string("\xa5\x40", 2)}; // 1010'0101'010
    const Image ones = decoded(low_png(1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, row));
    const png_color palette[] = {{1, 2, 3}, {40, 50, 60}};
    const Image indexed =
        decoded(low_png(1, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, row, palette));
    const Image clear = decoded(low_png(1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, row, {}, 1));
    for (std::size_t x = 0; x < width; ++x) {
        const bool one = (0xa540 >> (15 - x) & 1) != 0;
        EXPECT_EQ(ones.texels[x], (one ? Rgba{255, 255, 255, 255} : Rgba{0, 0, 0, 255})) << x;
        EXPECT_EQ(indexed.texels[x], (one ? Rgba{40, 50, 60, 255} : Rgba{1, 2, 3, 255})) << x;
        EXPECT_EQ(clear.texels[x], (one ? Rgba{255, 255, 255, 0} : Rgba{0, 0, 0, 255})) << x;
    }
}

// 1, 3 or 4 channels (CMYK) at full resolution. set_up() changes libjpeg's settings. Small pictures
// have smooth content, large ones none.
template <class SetUp>
std::string write_jpeg(int channels, unsigned side_x, unsigned side_y, const SetUp& set_up) {
    jpeg_compress_struct codec{};
    jpeg_error_mgr errors{};
    codec.err = jpeg_std_error(&errors);
    jpeg_create_compress(&codec);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&codec, &bytes, &size);
    codec.image_width = side_x;
    codec.image_height = side_y;
    codec.input_components = channels;
    codec.in_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_set_defaults(&codec);
    jpeg_set_quality(&codec, 100, TRUE);
    codec.comp_info[0].h_samp_factor = codec.comp_info[0].v_samp_factor = 1;
    set_up(codec);
    jpeg_start_compress(&codec, TRUE);
    for (unsigned y = 0; y < side_y; ++y) {
        std::vector<unsigned char> row;
        for (unsigned x = 0; x < side_x; ++x)
            for (int c = 0; c < channels; ++c)
                row.push_back(static_cast<unsigned char>(side_x > 32 ? 128
                                                         : c == 0    ? 6 * x
                                                         : c == 1    ? 10 * y
                                                         : c == 2    ? 255 - 4 * x
                                                                     : 100 + 3 * x));
        auto* line = row.data();
        jpeg_write_scanlines(&codec, &line, 1);
    }
    jpeg_finish_compress(&codec);
    std::string file(reinterpret_cast<char*>(bytes), size);
    jpeg_destroy_compress(&codec);
    std::free(bytes);
    return file;
}

std::string jpeg(int channels, bool progressive, bool adobe = true) {
    return write_jpeg(channels, 32, 24, [&](jpeg_compress_struct& codec) {
        codec.write_Adobe_marker = adobe;
        if (progressive)
            jpeg_simple_progression(&codec);
    });
}

TEST(PictureFile, Jpeg) {
    for (const bool progressive : {false, true})
        for (const int channels : {1, 3}) {
            const std::string file = jpeg(channels, progressive);
            const Image image = decoded(file);
            ASSERT_EQ(image.width, 32u);
            ASSERT_EQ(image.height, 24u);
            for (int y = 0; y < 24; ++y)
                for (int x = 0; x < 32; ++x) {
                    const Rgba t = image.texels[static_cast<std::size_t>(y * 32 + x)];
                    EXPECT_NEAR(t[0], 6 * x, 3);
                    EXPECT_NEAR(t[1], channels == 1 ? 6 * x : 10 * y, 3);
                    EXPECT_NEAR(t[2], channels == 1 ? 6 * x : 255 - 4 * x, 3);
                    EXPECT_EQ(t[3], 255);
                }
            expect_no_beginning(file);
            // Phones append films.
            EXPECT_EQ(decoded(file + std::string(100'000, '\0')).texels, image.texels);
        }
}

// An EXIF segment behind the start of a JPEG, in one of both byte orders.
std::string with_orientation(const std::string& jpeg, int value, bool big_endian) {
    const auto number = [&](unsigned x, int bytes) {
        std::string text;
        for (int i = 0; i < bytes; ++i)
            text += static_cast<char>(x >> 8 * (big_endian ? bytes - 1 - i : i) & 255);
        return text;
    };
    const std::string tiff = (big_endian ? "MM" : "II") + number(42, 2) + number(8, 4) +
                             number(2, 2) + number(0x010F, 2) + number(2, 2) + number(1, 4) +
                             number(0, 4) + number(0x0112, 2) + number(3, 2) + number(1, 4) +
                             number(static_cast<unsigned>(value), 2) + number(0, 2) + number(0, 4);
    const std::string segment = std::string("Exif\0\0", 6) + tiff;
    return jpeg.substr(0, 2) + "\xff\xe1" + '\0' + static_cast<char>(segment.size() + 2) + segment +
           jpeg.substr(2);
}

TEST(PictureFile, ExifTurnsJpegUpright) {
    const std::string plain = jpeg(3, false);
    const Image as_stored = decoded(plain);
    const auto w = as_stored.width, h = as_stored.height;
    for (int value = 0; value <= 9; ++value) {
        const std::string file = with_orientation(plain, value, value % 2 == 0);
        const Image image = decoded(file);
        const bool swaps = value >= 5 && value <= 8;
        ASSERT_EQ(image.width, swaps ? h : w) << value;
        ASSERT_EQ(image.height, swaps ? w : h) << value;
        // EXIF says at which edges of the upright picture the stored row 0 and column 0 lie.
        for (std::uint32_t y = 0; y < h; ++y)
            for (std::uint32_t x = 0; x < w; ++x) {
                const bool right = value == 2 || value == 3, bottom = value == 3 || value == 4;
                std::uint32_t to_x = right ? w - 1 - x : x, to_y = bottom ? h - 1 - y : y;
                if (swaps) { // row 0 lies left or right, column 0 at the top or the bottom
                    to_x = value == 5 || value == 8 ? y : h - 1 - y;
                    to_y = value == 5 || value == 6 ? x : w - 1 - x;
                }
                ASSERT_EQ(image.texels[to_y * image.width + to_x], as_stored.texels[y * w + x])
                    << value;
            }
        const auto source = wrap_memory(std::as_bytes(std::span(file)));
        const auto ignoring = open_picture_file(*source, {.exif = Exif::ignored});
        ASSERT_TRUE(ignoring.ok());
        EXPECT_EQ((*ignoring)->shape().width, w);
        expect_no_beginning(file);
    }
}

TEST(PictureFile, JpegInCmyk) {
    const std::string ycck = write_jpeg(4, 32, 24, [](jpeg_compress_struct& codec) {
        jpeg_set_colorspace(&codec, JCS_YCCK);
        codec.comp_info[0].h_samp_factor = codec.comp_info[0].v_samp_factor = 1;
        codec.comp_info[3].h_samp_factor = codec.comp_info[3].v_samp_factor = 1;
        codec.write_Adobe_marker = TRUE;
    });
    for (const auto& [file, adobe] :
         {std::pair(jpeg(4, false, false), false), std::pair(jpeg(4, false, true), true),
          std::pair(ycck, true)}) {
        const Image image = decoded(file);
        ASSERT_EQ(image.texels.size(), 32u * 24u);
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 32; ++x) {
                const auto rgb = [&](int ink) { // Adobe's inks are inverted
                    const int key = 100 + 3 * x;
                    return (adobe ? ink * key : (255 - ink) * (255 - key)) / 255.0;
                };
                const Rgba t = image.texels[static_cast<std::size_t>(y * 32 + x)];
                EXPECT_NEAR(t[0], rgb(6 * x), 4);
                EXPECT_NEAR(t[1], rgb(10 * y), 4);
                EXPECT_NEAR(t[2], rgb(255 - 4 * x), 4);
            }
    }
}

// A large flat picture of 253 scans, nearly all empty, which would take a reader much longer than
// its 20 kB suggest.
TEST(PictureFile, JpegOfManyScans) {
    std::vector<jpeg_scan_info> scans{{1, {0}, 0, 0, 0, 0}};
    for (int bit = 3; bit >= 0; --bit)
        for (int k = 1; k < 64; ++k)
            scans.push_back({1, {0}, k, k, bit == 3 ? 0 : bit + 1, bit});
    const std::string file = write_jpeg(1, 2048, 2048, [&](jpeg_compress_struct& codec) {
        codec.scan_info = scans.data();
        codec.num_scans = static_cast<int>(scans.size());
    });
    EXPECT_LT(file.size(), 40'000u);
    expect_refused(file, ErrorCode::invalid_file, "damaged JPEG: too many scans");
}

std::string webp(bool lossless, std::uint32_t side_x = width, std::uint32_t side_y = height) {
    std::vector<Rgba> texels;
    for (std::uint32_t y = 0; y < side_y; ++y)
        for (std::uint32_t x = 0; x < side_x; ++x)
            texels.push_back(lossless ? texel(x, y) : Rgba{90, 90, 90, 255});
    std::uint8_t* bytes = nullptr;
    const int stride = static_cast<int>(side_x) * 4;
    const std::size_t size =
        lossless ? WebPEncodeLosslessRGBA(texels[0].data(), static_cast<int>(side_x),
                                          static_cast<int>(side_y), stride, &bytes)
                 : WebPEncodeRGBA(texels[0].data(), static_cast<int>(side_x),
                                  static_cast<int>(side_y), stride, 90, &bytes);
    const std::string file(reinterpret_cast<char*>(bytes), size);
    WebPFree(bytes);
    return file;
}

TEST(PictureFile, Webp) {
    expect_texels(webp(true), [](Rgba t) { return t; });
    expect_texels(
        webp(false),
        [](Rgba) {
            return Rgba{90, 90, 90, 255};
        },
        2);
    expect_no_beginning(webp(true));
    expect_no_beginning(webp(false, 64, 48));
    expect_refused("RIFF\x10\0\0\0WEBPVP8?", ErrorCode::invalid_file, "WebP");
}

// Packs texel(x, y) into the bits of a word.
using Pack = std::uint64_t (*)(Rgba);

std::string bmp_lines(Pack pack, unsigned bits, bool top_down) {
    std::string lines;
    for (std::uint32_t i = 0; i < height; ++i) {
        const std::uint32_t y = top_down ? i : height - 1 - i;
        std::string line;
        for (std::uint32_t x = 0; x < width; ++x)
            line += little(pack(texel(x, y)), bits / 8);
        lines += line + std::string((4 - line.size() % 4) % 4, '\0');
    }
    return lines;
}

// `between`: masks or a palette.
std::string bmp(const std::string& lines, unsigned bits, std::uint32_t compression = 0,
                const std::string& between = "", bool top_down = false) {
    const std::string info = little(40, 4) + little(width, 4) +
                             little(top_down ? -std::uint64_t{height} : height, 4) + little(1, 2) +
                             little(bits, 2) + little(compression, 4) + std::string(20, '\0');
    const std::uint64_t offset = 14 + info.size() + between.size();
    return "BM" + little(offset + lines.size(), 4) + little(0, 4) + little(offset, 4) + info +
           between + lines;
}

std::uint64_t bgr(Rgba t) {
    return t[2] | t[1] << 8 | t[0] << 16;
}
std::uint64_t bgra(Rgba t) {
    return bgr(t) | std::uint64_t{t[3]} << 24;
}
std::uint64_t bgr555(Rgba t) {
    return static_cast<std::uint64_t>(t[2] >> 3 | t[1] >> 3 << 5 | t[0] >> 3 << 10);
}
std::uint8_t spread5(std::uint8_t value) {
    return static_cast<std::uint8_t>(((value >> 3) * 255 + 15) / 31);
}
Rgba from555(Rgba t) {
    return {spread5(t[0]), spread5(t[1]), spread5(t[2]), 255};
}

TEST(PictureFile, Bmp) {
    const std::string rgb = bmp(bmp_lines(bgr, 24, false), 24);
    expect_texels(rgb, opaque);
    expect_texels(bmp(bmp_lines(bgr, 24, true), 24, 0, "", true), opaque);
    expect_texels(bmp(bmp_lines(bgra, 32, false), 32), [](Rgba t) { return t; });
    expect_texels(bmp(bmp_lines(bgr, 32, false), 32), opaque); // the fourth byte is unused
    expect_texels(bmp(bmp_lines(bgr555, 16, false), 16), from555);
    const Pack rgb565 = [](Rgba t) {
        return static_cast<std::uint64_t>(t[2] >> 3 | t[1] >> 2 << 5 | t[0] >> 3 << 11);
    };
    const std::string masks = little(0xf800, 4) + little(0x7e0, 4) + little(0x1f, 4);
    expect_texels(bmp(bmp_lines(rgb565, 16, false), 16, 3, masks), [](Rgba t) {
        const auto green = static_cast<std::uint8_t>(((t[1] >> 2) * 255 + 31) / 63);
        return Rgba{spread5(t[0]), green, spread5(t[2]), 255};
    });
    // Bytes behind the pixels do not matter; a missing padding of the last line does not, either.
    expect_texels(rgb + "more", opaque);
    expect_texels(rgb.substr(0, rgb.size() - 3), opaque);
    expect_refused(rgb.substr(0, rgb.size() - 4), ErrorCode::invalid_file, "too early");
    expect_no_beginning(rgb);
    expect_refused(bmp("", 8, 1), ErrorCode::unsupported, "not supported: a compressed BMP");
    expect_refused(bmp("", 5), ErrorCode::invalid_file, "5 bits");
}

TEST(PictureFile, BmpWithPalettes) {
    std::string palette;
    for (std::uint32_t i = 0; i < 16; ++i)
        palette +=
            little(bgr({static_cast<std::uint8_t>(i), 0, static_cast<std::uint8_t>(7 * i), 0}), 4);
    for (const unsigned bits : {1u, 4u, 8u}) {
        std::string line;
        for (std::uint32_t x = 0; x < width; ++x) {
            if (x * bits % 8 == 0)
                line += '\0';
            line.back() = static_cast<char>(line.back() | (x % (1u << std::min(bits, 3u)))
                                                              << (8 - bits - x * bits % 8));
        }
        line.resize((line.size() + 3) / 4 * 4);
        std::string lines;
        for (std::uint32_t y = 0; y < height; ++y)
            lines += line;
        const std::string used = palette.substr(0, 4u << std::min(bits, 4u));
        const Image image = decoded(bmp(lines, bits, 0, used));
        ASSERT_EQ(image.texels.size(), std::size_t{width} * height);
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t i = x % (1u << std::min(bits, 3u));
            EXPECT_EQ(image.texels[x], (Rgba{static_cast<std::uint8_t>(i), 0,
                                             static_cast<std::uint8_t>(7 * i), 255}))
                << bits << " " << x;
        }
        expect_no_beginning(bmp(lines, bits, 0, used));
        expect_refused(bmp(lines, bits, 0, used.substr(0, 4)), ErrorCode::invalid_file,
                       "a pixel has colour 1 of 1");
    }
}

struct TgaKind {
    int kind = 2; // 1 palette, 2 colour, 3 grey; 8 more with run lengths
    int bits = 24;
    int order = 0;         // 16: from the right, 32: from the top
    std::string palette{}; // of 24 bits
    int first = 0;         // index of its first colour
};

std::string tga(const TgaKind& k, Pack pack) {
    std::vector<std::uint64_t> words;
    for (std::uint32_t j = 0; j < height; ++j)
        for (std::uint32_t i = 0; i < width; ++i)
            words.push_back(
                pack(texel(k.order & 16 ? width - 1 - i : i, k.order & 32 ? j : height - 1 - j)));
    const auto bytes = static_cast<std::size_t>((k.bits + 7) / 8);
    std::string pixels;
    for (std::size_t i = 0; i < words.size();) {
        std::size_t run = 1;
        while (k.kind >= 8 && run < 128 && i + run < words.size() && words[i + run] == words[i])
            ++run;
        if (k.kind >= 8)
            pixels += static_cast<char>(run > 1 ? 127 + run : 0);
        pixels += little(words[i], bytes);
        i += run;
    }
    return little(2, 1) + little(k.palette.empty() ? 0 : 1, 1) +
           little(static_cast<unsigned>(k.kind), 1) + little(static_cast<unsigned>(k.first), 2) +
           little(k.palette.size() / 3, 2) + little(k.palette.empty() ? 0 : 24, 1) + little(0, 4) +
           little(width, 2) + little(height, 2) + little(static_cast<unsigned>(k.bits), 1) +
           little(static_cast<unsigned>(k.order), 1) + "id" + k.palette + pixels;
}

TEST(PictureFile, Tga) {
    const Pack rows = [](Rgba t) { return std::uint64_t{t[1]} / 50; }; // runs along each row
    std::string palette;
    for (std::uint32_t i = 3; i < 9; ++i)
        palette += little(i | 100 << 8 | 2 * i << 16, 3);
    for (const int order : {0, 16, 32, 48}) {
        expect_texels(tga({.kind = 2, .bits = 24, .order = order}, bgr), opaque);
        expect_texels(tga({.kind = 10, .bits = 32, .order = order}, bgra),
                      [](Rgba t) { return t; });
        expect_texels(tga({.kind = 10, .bits = 16, .order = order}, bgr555), from555);
        expect_texels(tga({.kind = 11, .bits = 8, .order = order}, rows), [](Rgba t) {
            const auto i = static_cast<std::uint8_t>(t[1] / 50);
            return Rgba{i, i, i, 255};
        });
    }
    expect_texels(
        tga({.kind = 3, .bits = 16}, [](Rgba t) { return std::uint64_t{t[0]} | t[3] << 8; }),
        [](Rgba t) {
            return Rgba{t[0], t[0], t[0], t[3]};
        });
    const Pack indices = [](Rgba t) { return std::uint64_t{t[1]} / 50 + 3; };
    for (const int kind : {1, 9})
        expect_texels(tga({.kind = kind, .bits = 8, .palette = palette, .first = 3}, indices),
                      [](Rgba t) {
                          const auto i = static_cast<std::uint8_t>(t[1] / 50 + 3);
                          return Rgba{static_cast<std::uint8_t>(2 * i), 100, i, 255};
                      });
    expect_refused(tga({.kind = 1, .bits = 8, .palette = palette, .first = 4}, indices),
                   ErrorCode::invalid_file, "a pixel has colour 3 of 6");
    expect_no_beginning(tga({.kind = 2, .bits = 24}, bgr));
    expect_no_beginning(tga({.kind = 11, .bits = 8}, rows));
    expect_no_beginning(tga({.kind = 9, .bits = 8, .palette = palette, .first = 3}, indices));
}

TEST(PictureFile, RefusesOtherKindsByName) {
    const std::pair<const char*, const char*> kinds[] = {{"GIF89a", "a GIF"},
                                                         {"8BPS", "a PSD"},
                                                         {"\x53\x80\xf6\x34", "a Softimage PIC"},
                                                         {"P4\n", "a PBM"}};
    for (const auto& [begin, name] : kinds)
        expect_refused(begin + std::string(100, '\1'), ErrorCode::unsupported,
                       std::string("not supported: ") + name + "; convert it to PNG");
    for (const std::string& text : {std::string("nonsense"), std::string(40, '\0')})
        expect_refused(text, ErrorCode::invalid_file, "not a picture of a known kind");
    expect_refused("", ErrorCode::invalid_file, "not a picture, but an empty file");
    expect_refused("<!DOCTYPE html><html>", ErrorCode::invalid_file, "but an HTML page");
}

TEST(PictureFile, RefusesLargePicturesBeforeTheyTakeMemory) {
    std::string large = bmp("", 24);
    large.replace(18, 8, little(1 << 14, 4) + little(1 << 13, 4));
    expect_refused(large, ErrorCode::unsupported, "16384x8192 is too large");
    large.replace(18, 8, little(1 << 13, 4) + little(1 << 13, 4));
    expect_refused(large, ErrorCode::invalid_file, "too early");
    large.replace(18, 4, little(~0u, 4));
    expect_refused(large, ErrorCode::unsupported, "too large");
    large.replace(18, 4, little(0, 4));
    expect_refused(large, ErrorCode::invalid_file, "no pixels");
    std::string run = tga({.kind = 11, .bits = 8}, bgr);
    run.replace(12, 4, little(8000, 2) + little(8000, 2));
    expect_refused(run, ErrorCode::invalid_file, "too early");
}

} // namespace
} // namespace tessera::corpus
