// Pictures that are held whole: PGM, PPM, PFM and TIFF; and notes about colour profiles.
#include "corpus/picture_file.h"
#include "format/samples.h"
#include "tests/support/pictures.h"
#include "tests/support/png_memory.h"
#include "tests/support/test_folder.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <png.h>
#include <tiffio.h>

namespace tessera::corpus {
namespace {

// An open picture, and the bytes that it reads.
struct OpenedFile {
    std::string bytes;
    std::unique_ptr<ByteSource> source;
    std::unique_ptr<PictureReader> reader;
    Status status;
    std::uint64_t clamped = 0;

    explicit OpenedFile(std::string file, const PictureOptions& options = {})
        : bytes(std::move(file)), source(wrap_memory(std::as_bytes(std::span(bytes)))) {
        auto opened = open_picture_file(*source, options);
        status = opened.status();
        if (opened.ok())
            reader = std::move(*opened);
    }
    // All samples as numbers: codes of unorm8, values of halves.
    std::vector<double> samples(SampleType type) {
        std::vector<double> out;
        if (!reader) {
            ADD_FAILURE() << status.message();
            return out;
        }
        status = reader->read_rows(
            type, 0, reader->shape().height, [&](std::uint32_t, std::span<const std::byte> row) {
                clamped += reader->clamped_in_row();
                for (std::size_t i = 0; i < row.size(); i += sample_bytes(type)) {
                    std::uint16_t half = 0;
                    std::memcpy(&half, &row[i], sample_bytes(type));
                    out.push_back(type == SampleType::unorm8 ? half : half_to_float(half));
                }
            });
        return out;
    }
};

using SampleValues = std::vector<double>;

void expect_not_read(const std::string& file, ErrorCode code, const std::string& words) {
    const OpenedFile opened(file);
    EXPECT_EQ(opened.status.code(), code) << words;
    EXPECT_NE(opened.status.message().find(words), std::string::npos) << opened.status.message();
}

// Beginnings are refused or the same.
void expect_no_beginning_opens(const std::string& file) {
    OpenedFile whole(file);
    const SampleValues all = whole.samples(SampleType::half16);
    for (std::size_t i = 0; i < 64; ++i) {
        OpenedFile part(file.substr(0, i * file.size() / 64));
        if (part.reader && part.reader->shape() == whole.reader->shape()) {
            const SampleValues samples = part.samples(SampleType::half16);
            EXPECT_TRUE(!part.status.ok() || samples == all) << i;
        } else {
            EXPECT_EQ(part.status.code(), ErrorCode::invalid_file) << part.status.message();
        }
    }
}

TEST(Pnm, ReadsBinaryAndText) {
    const std::string grey = "P5\n# a comment\n3 2\n255\n" + std::string("\0\1\2\3\4\xff", 6);
    EXPECT_EQ(OpenedFile(grey).samples(SampleType::unorm8), (SampleValues{0, 1, 2, 3, 4, 255}));
    EXPECT_EQ(OpenedFile("P2 3 2 255\n0 1 2\n3 4 255\n").samples(SampleType::unorm8),
              (SampleValues{0, 1, 2, 3, 4, 255}));
    OpenedFile colour("P6 2 1 255\nabcdef");
    EXPECT_EQ(colour.reader->shape().channels, 3);
    EXPECT_EQ(colour.samples(SampleType::unorm8), (SampleValues{97, 98, 99, 100, 101, 102}));
    EXPECT_EQ(OpenedFile("P3 1 1 15 0 7 15").samples(SampleType::unorm8),
              (SampleValues{0, 119, 255}));
    expect_no_beginning_opens(grey);
    // 16 bits, the high byte first; 10 bits.
    OpenedFile deep("P5 2 1 65535\n" + std::string("\x80\x00\xff\xff", 4));
    EXPECT_EQ(deep.reader->shape().bits, 16);
    EXPECT_EQ(deep.samples(SampleType::unorm8), (SampleValues{128, 255}));
    EXPECT_NEAR(OpenedFile("P5 1 1 1023\n" + std::string("\2\0", 2)).samples(SampleType::half16)[0],
                512 / 1023.0, 0.0003);
}

TEST(Pnm, RefusesDamagedFiles) {
    expect_not_read("P5 3 2 255\nabcde", ErrorCode::invalid_file, "ends too early");
    expect_not_read("P5 3 2 0\nabcdef", ErrorCode::invalid_file, "'0' is not a largest value");
    expect_not_read("P5 x 2 255\nabcdef", ErrorCode::invalid_file,
                    "'x' is not its width or height");
    expect_not_read("P5 0 2 255\nabcdef", ErrorCode::invalid_file, "no pixels");
    expect_not_read("P5 16384 16384 255\nabcdef", ErrorCode::unsupported, "too large");
    expect_not_read("P5 1 1 7\nz", ErrorCode::invalid_file, "above its maximum 7");
    expect_not_read("P2 2 1 7\n1 z", ErrorCode::invalid_file, "'z' is not a sample");
    expect_not_read("P4 8 1\nz", ErrorCode::unsupported, "a PBM");
}

std::string pfm(const std::string& kind, const std::vector<float>& values, bool little) {
    std::string text = kind + "\n2 " + std::to_string(values.size() / (kind == "PF" ? 6 : 2)) +
                       (little ? "\n-1.0\n" : "\n1.0\n");
    for (const float value : values) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (unsigned i = 0; i < 4; ++i)
            text += static_cast<char>(bits >> 8 * (little ? i : 3 - i) & 255);
    }
    return text;
}

TEST(Pfm, ReadsFloatsFromTheBottom) {
    for (const bool little : {false, true}) {
        OpenedFile grey(pfm("Pf", {1, 2, 0.5f, -3}, little));
        EXPECT_TRUE(grey.reader->shape().is_float);
        EXPECT_EQ(grey.samples(SampleType::half16), (SampleValues{0.5, -3, 1, 2}));
    }
    OpenedFile colour(pfm("PF", {1, 2, 3, 1e6f, -1e9f, INFINITY}, true));
    EXPECT_EQ(colour.samples(SampleType::half16), (SampleValues{1, 2, 3, 65504, -65504, INFINITY}));
    EXPECT_EQ(colour.clamped, 2u);
    EXPECT_EQ(colour.samples(SampleType::unorm8), (SampleValues{255, 255, 255, 255, 0, 255}));
    expect_no_beginning_opens(pfm("PF", {1, 2, 3, 4, 5, 6}, true));
    const auto light = support::light_of(pfm("Pf", {1e6f, 2}, true));
    ASSERT_TRUE(light.ok()) << light.status().message();
    EXPECT_EQ(light->texels[0], glm::vec3(1e6f));
    expect_not_read("PF 2 1 0\n" + std::string(99, 'x'), ErrorCode::invalid_file, "its scale");
}

// Writes TIFF files.
class Tiff : public testing::Test {
protected:
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "a.tif").string(); }

    struct Kind {
        std::uint16_t bits = 8, samples = 3, format = SAMPLEFORMAT_UINT;
        std::uint16_t photometric = PHOTOMETRIC_RGB, planar = PLANARCONFIG_CONTIG;
        std::uint16_t compression = COMPRESSION_LZW, orientation = 0;
        bool alpha = false, tiled = false, big_endian = false;
        std::string profile = {};
    };
    // `values`: of all samples by rows, planes one after the other.
    template <class Number>
    std::string file(const Kind& kind, std::uint32_t width, std::uint32_t height,
                     const std::vector<Number>& values) const {
        TIFF* tiff = TIFFOpen(path().c_str(), kind.big_endian ? "wb" : "wl");
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind.bits);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kind.format);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kind.photometric);
        TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, kind.planar);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
        if (kind.orientation != 0)
            TIFFSetField(tiff, TIFFTAG_ORIENTATION, kind.orientation);
        if (!kind.profile.empty())
            TIFFSetField(tiff, TIFFTAG_ICCPROFILE, static_cast<std::uint32_t>(kind.profile.size()),
                         kind.profile.data());
        const std::uint16_t extra = EXTRASAMPLE_UNASSALPHA;
        if (kind.alpha)
            TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra);
        const std::size_t per_plane = kind.planar == PLANARCONFIG_CONTIG ? kind.samples : 1;
        const std::size_t line = kind.bits == 1 ? (width + 7) / 8 : width * per_plane;
        if (kind.tiled) { // one tile is larger than the picture
            TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
            TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
            std::vector<Number> tile(16 * 16 * per_plane);
            for (std::size_t y = 0; y < height; ++y)
                std::copy_n(values.data() + y * line, line, tile.data() + y * 16 * per_plane);
            TIFFWriteTile(tiff, tile.data(), 0, 0, 0, 0);
        } else {
            TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 2);
            for (std::size_t y = 0; y < values.size() / line; ++y)
                TIFFWriteScanline(tiff, const_cast<Number*>(&values[y * line]),
                                  static_cast<std::uint32_t>(y % height),
                                  static_cast<std::uint16_t>(y / height));
        }
        TIFFClose(tiff);
        return test::slurp(path());
    }

    std::filesystem::path folder_ = test::make_test_folder("tiff");
};

TEST_F(Tiff, ReadsIntegersAndFloats) {
    std::vector<std::uint8_t> bytes;
    SampleValues numbers;
    for (int i = 0; i < 3 * 5 * 3; ++i) {
        bytes.push_back(static_cast<std::uint8_t>(5 * i));
        numbers.push_back(5 * i);
    }
    for (const bool big_endian : {false, true})
        for (const bool tiled : {false, true}) {
            const std::string rgb =
                file(Kind{.tiled = tiled, .big_endian = big_endian}, 3, 5, bytes);
            EXPECT_EQ(OpenedFile(rgb).samples(SampleType::unorm8), numbers);
            expect_no_beginning_opens(rgb);
        }
    // Planes one after the other.
    const std::vector<std::uint8_t> planes{1, 2, 3, 4, 11, 12, 13, 14, 21, 22, 23, 24};
    EXPECT_EQ(OpenedFile(file(Kind{.planar = PLANARCONFIG_SEPARATE}, 2, 2, planes))
                  .samples(SampleType::unorm8),
              (SampleValues{1, 11, 21, 2, 12, 22, 3, 13, 23, 4, 14, 24}));
    OpenedFile deep(file(
        Kind{.bits = 16, .samples = 1, .photometric = PHOTOMETRIC_MINISBLACK, .big_endian = true},
        2, 1, std::vector<std::uint16_t>{0x8000, 65535}));
    EXPECT_EQ(deep.reader->shape().bits, 16);
    EXPECT_EQ(deep.samples(SampleType::unorm8), (SampleValues{128, 255}));
    EXPECT_EQ(OpenedFile(file(Kind{.samples = 1, .photometric = PHOTOMETRIC_MINISWHITE}, 2, 1,
                              std::vector<std::uint8_t>{0, 250}))
                  .samples(SampleType::unorm8),
              (SampleValues{255, 5}));
    OpenedFile floats(file(Kind{.bits = 32, .format = SAMPLEFORMAT_IEEEFP}, 1, 1,
                           std::vector<float>{0.5f, 1e6f, -2}));
    EXPECT_EQ(floats.reader->shape().usual_type(), SampleType::half16);
    EXPECT_EQ(floats.samples(SampleType::half16), (SampleValues{0.5, 65504, -2}));
    EXPECT_EQ(floats.clamped, 1u);
    OpenedFile alpha(
        file(Kind{.samples = 4, .alpha = true}, 1, 1, std::vector<std::uint8_t>{1, 2, 3, 4}));
    EXPECT_EQ(alpha.samples(SampleType::unorm8), (SampleValues{1, 2, 3, 4}));
    OpenedFile extra(file(Kind{.samples = 5}, 1, 1, std::vector<std::uint8_t>{1, 2, 3, 4, 5}));
    EXPECT_EQ(extra.samples(SampleType::unorm8), (SampleValues{1, 2, 3}));
    ASSERT_EQ(extra.reader->notes().size(), 1u);
    EXPECT_NE(extra.reader->notes()[0].find("left out"), std::string::npos);
}

TEST_F(Tiff, ShowsOtherColoursAndTurnsUpright) {
    const std::vector<std::uint8_t> inks{0, 0, 0, 0, 0, 255, 255, 0, 0, 0, 0, 255};
    EXPECT_EQ(OpenedFile(file(Kind{.samples = 4, .photometric = PHOTOMETRIC_SEPARATED}, 3, 1, inks))
                  .samples(SampleType::unorm8),
              (SampleValues{255, 255, 255, 255, 0, 0, 0, 0, 0}));
    EXPECT_EQ(OpenedFile(file(Kind{.bits = 1,
                                   .samples = 1,
                                   .photometric = PHOTOMETRIC_MINISBLACK,
                                   .compression = COMPRESSION_CCITTFAX4},
                              8, 1, std::vector<std::uint8_t>{0xa5}))
                  .samples(SampleType::unorm8),
              (SampleValues{255, 0, 255, 0, 0, 255, 0, 255}));
    const std::string turned = file(Kind{.samples = 1,
                                         .photometric = PHOTOMETRIC_MINISBLACK,
                                         .orientation = ORIENTATION_RIGHTTOP},
                                    2, 1, std::vector<std::uint8_t>{7, 9});
    OpenedFile upright(turned);
    EXPECT_EQ(upright.reader->shape().height, 2u);
    EXPECT_EQ(upright.samples(SampleType::unorm8), (SampleValues{7, 9}));
    EXPECT_EQ(OpenedFile(turned, {.exif = Exif::ignored}).reader->shape().width, 2u);
    // The same for colours that libtiff converts.
    OpenedFile bits(file(Kind{.bits = 1,
                              .samples = 1,
                              .photometric = PHOTOMETRIC_MINISBLACK,
                              .orientation = ORIENTATION_BOTRIGHT},
                         4, 1, std::vector<std::uint8_t>{0x80}));
    EXPECT_EQ(bits.samples(SampleType::unorm8), (SampleValues{0, 0, 0, 255}));
    expect_not_read("II*" + std::string("\0\x08\0\0\0", 5), ErrorCode::invalid_file,
                    "damaged TIFF");
}

// Colour profiles. A minimal one has a name, primaries and a curve.

std::string big_endian_of(std::uint32_t value, int bytes = 4) {
    std::string text;
    for (int i = bytes; i-- > 0;)
        text += static_cast<char>(value >> 8 * i & 255);
    return text;
}

std::string icc_profile(const std::string& name, bool srgb_colours, double gamma) {
    const auto fixed = [](double x) {
        return big_endian_of(static_cast<std::uint32_t>(std::lround(x * 65536)));
    };
    const double colours[3][3] = {{srgb_colours ? 0.4361 : 0.6097, srgb_colours ? 0.2225 : 0.3111,
                                   srgb_colours ? 0.0139 : 0.0195},
                                  {srgb_colours ? 0.3851 : 0.2053, srgb_colours ? 0.7169 : 0.6257,
                                   srgb_colours ? 0.0971 : 0.0609},
                                  {srgb_colours ? 0.1431 : 0.1492, srgb_colours ? 0.0606 : 0.0632,
                                   srgb_colours ? 0.7141 : 0.7446}};
    std::vector<std::pair<std::string, std::string>> tags;
    std::string wide;
    for (const char c : name)
        wide += std::string(1, '\0') + c;
    tags.emplace_back("desc", "mluc" + big_endian_of(0) + big_endian_of(1) + big_endian_of(12) +
                                  "enUS" + big_endian_of(static_cast<std::uint32_t>(wide.size())) +
                                  big_endian_of(28) + wide);
    for (std::size_t c = 0; c < 3; ++c)
        tags.emplace_back(std::string(1, "rgb"[c]) + "XYZ",
                          "XYZ " + big_endian_of(0) + fixed(colours[c][0]) + fixed(colours[c][1]) +
                              fixed(colours[c][2]));
    for (const char* curve : {"rTRC", "gTRC", "bTRC"})
        tags.emplace_back(curve, "para" + big_endian_of(0) + big_endian_of(0, 2) +
                                     big_endian_of(0, 2) + fixed(gamma));
    tags.emplace_back("wtpt", "XYZ " + big_endian_of(0) + fixed(0.9642) + fixed(1) + fixed(0.8249));
    std::string table = big_endian_of(static_cast<std::uint32_t>(tags.size())), data;
    for (auto& [signature, content] : tags) {
        content.resize((content.size() + 3) / 4 * 4);
        table +=
            signature +
            big_endian_of(static_cast<std::uint32_t>(128 + 4 + 12 * tags.size() + data.size())) +
            big_endian_of(static_cast<std::uint32_t>(content.size()));
        data += content;
    }
    std::string head = big_endian_of(static_cast<std::uint32_t>(128 + table.size() + data.size())) +
                       big_endian_of(0) + std::string("\4\x30\0\0", 4) + "mntrRGB XYZ ";
    head += std::string(12, '\0') + "acsp";
    head.resize(68);
    head += fixed(0.9642) + fixed(1) + fixed(0.8249);
    head.resize(128);
    return head + table + data;
}

std::string png_with(const std::string& icc, double gamma) {
    std::string file;
    png_structp out = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(out);
    test::write_png_to(out, file);
    png_set_IHDR(out, info, 1, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!icc.empty())
        png_set_iCCP(out, info, "name", 0, reinterpret_cast<png_const_bytep>(icc.data()),
                     static_cast<png_uint_32>(icc.size()));
    if (gamma > 0)
        png_set_gAMA(out, info, gamma);
    png_byte row[3] = {1, 2, 3};
    png_bytep rows = row;
    png_set_rows(out, info, &rows);
    png_write_png(out, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_destroy_write_struct(&out, &info);
    return file;
}

std::string note_of(const std::string& file) {
    const OpenedFile opened(file);
    EXPECT_TRUE(opened.status.ok()) << opened.status.message();
    return opened.reader && !opened.reader->notes().empty() ? opened.reader->notes()[0] : "";
}

TEST(ColourProfiles, OtherThanSrgbAreNamed) {
    EXPECT_EQ(note_of(png_with("", 0)), "");
    EXPECT_EQ(note_of(png_with("", 0.45455)), "");
    EXPECT_EQ(note_of(png_with("", 1)), "the gamma 1 of a PNG is ignored, sRGB is assumed");
    EXPECT_EQ(note_of(png_with(icc_profile("any name", true, 2.2), 0)), "");
    EXPECT_EQ(note_of(png_with(icc_profile("Adobe RGB (1998)", false, 2.2), 0)),
              "the colour profile 'Adobe RGB (1998)' is ignored, sRGB is assumed");
    EXPECT_EQ(note_of(png_with(icc_profile("linear sRGB", true, 1), 0)),
              "the colour profile 'linear sRGB' is ignored, sRGB is assumed");
}

TEST_F(Tiff, ProfilesAreNamed) {
    EXPECT_EQ(note_of(file(Kind{.profile = icc_profile("Wide", false, 1.8)}, 1, 1,
                           std::vector<std::uint8_t>{1, 2, 3})),
              "the colour profile 'Wide' is ignored, sRGB is assumed");
}

} // namespace
} // namespace tessera::corpus
