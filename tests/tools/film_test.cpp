// Films, .y4m: their colours by the formulas of BT.601 and BT.709, and damaged ones.
#include "format/samples.h"
#include "tools/texture_io/film_io.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

namespace tessera {
namespace {

// Y'CbCr of 8 bits from R'G'B' between 0 and 1, by the weights of red and blue.
std::array<double, 3> yuv_of(double r, double g, double b, double red, double blue) {
    const double y = red * r + (1 - red - blue) * g + blue * b;
    return {y, (b - y) / (2 * (1 - blue)), (r - y) / (2 * (1 - red))};
}

class FilmTest : public testing::Test {
protected:
    // Flat frames of 4x2 pixels. `planes`: Y, Cb, Cr of each, as codes.
    static std::string film(const std::string& header,
                            const std::vector<std::array<int, 3>>& frames, int chroma_samples,
                            bool deep = false, int lines = 2) {
        std::string text = "YUV4MPEG2 W4 H" + std::to_string(lines) + " F25:1 " + header + "\n";
        for (const auto& frame : frames) {
            text += "FRAME\n";
            for (std::size_t plane = 0; plane < (chroma_samples > 0 ? 3u : 1u); ++plane)
                for (int i = 0; i < (plane == 0 ? 4 * lines : chroma_samples); ++i) {
                    text += static_cast<char>(frame[plane] & 255);
                    if (deep)
                        text += static_cast<char>(frame[plane] >> 8);
                }
        }
        return text;
    }
    // All texels; sets desc_, error_ and told_.
    std::vector<std::byte> read(const std::string& film, const TextureHints& hints = {}) {
        bytes_ = film;
        ViewsFacts facts;
        const auto source = open_film(wrap_memory(std::as_bytes(std::span(bytes_))), hints, facts);
        error_ = source.status();
        if (!source.ok())
            return {};
        told_ = facts.told;
        desc_ = (*source)->desc();
        const Box4 whole = Box4::whole(desc_.size);
        std::vector<std::byte> out(desc_.box_bytes(whole));
        error_ = (*source)->begin_slab(whole);
        if (error_.ok())
            error_ = (*source)->read(whole, out);
        return out;
    }
    void expect_colour(const std::vector<std::byte>& texels, std::array<double, 3> rgb) const {
        ASSERT_TRUE(error_.ok()) << error_.message();
        ASSERT_EQ(desc_.channels, 3);
        for (std::size_t i = 0; i < texels.size(); ++i)
            ASSERT_NEAR(std::to_integer<int>(texels[i]), 255 * rgb[i % 3], 1.6) << i;
    }

    std::string bytes_;
    Status error_;
    TextureDesc desc_;
    std::string told_;
};

TEST_F(FilmTest, ColoursFollowTheMatrixAndTheRange) {
    const std::array<double, 3> rgb{0.8, 0.3, 0.1};
    for (const bool hd : {false, true}) {
        const auto [y, cb, cr] = hd ? yuv_of(rgb[0], rgb[1], rgb[2], 0.2126, 0.0722)
                                    : yuv_of(rgb[0], rgb[1], rgb[2], 0.299, 0.114);
        TextureHints hints;
        hints.views.yuv_matrix = hd ? YuvMatrix::bt709 : YuvMatrix::bt601;
        const auto code = [](double x) { return static_cast<int>(std::lround(x)); };
        const std::array<int, 3> limited{code(16 + 219 * y), code(128 + 224 * cb),
                                         code(128 + 224 * cr)};
        const std::array<int, 3> full{code(255 * y), code(128 + 255 * cb), code(128 + 255 * cr)};
        const std::array<int, 3> deep{code(64 + 876 * y), code(512 + 896 * cb),
                                      code(512 + 896 * cr)};
        const std::array<int, 3> deep_full{code(1023 * y), code(512 + 1023 * cb),
                                           code(512 + 1023 * cr)};
        expect_colour(read(film("C420jpeg", {limited}, 2), hints), rgb);
        expect_colour(read(film("C444", {limited}, 8), hints), rgb);
        expect_colour(read(film("C422", {limited}, 4), hints), rgb);
        expect_colour(read(film("C444 XCOLORRANGE=FULL", {full}, 8), hints), rgb);
        expect_colour(read(film("C420p10 XYSCSS=420P10", {deep}, 2, true), hints), rgb);
        expect_colour(read(film("C444p10 XCOLORRANGE=FULL", {deep_full}, 8, true), hints), rgb);
        EXPECT_NE(told_.find(hd ? "BT.709" : "BT.601"), std::string::npos) << told_;
        // Without the option: by the header, else by the number of lines.
        const std::string stated = hd ? " XCOLORMATRIX=BT709" : " XCOLORMATRIX=BT601";
        expect_colour(read(film("C444" + stated, {limited}, 8)), rgb);
        const int lines = hd ? 720 : 718;
        expect_colour(read(film("C420", {limited}, lines, false, lines)), rgb);
    }
    // Without a colour space, 4:2:0. Grey has one channel.
    read(film("", {{100, 128, 128}}, 2));
    EXPECT_EQ(desc_.channels, 3);
    const auto grey = read(film("Cmono", {{235, 0, 0}}, 0));
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.channels, 1);
    EXPECT_EQ(grey[0], std::byte{255});
}

TEST_F(FilmTest, KeepsTenBitsAsHalves) {
    TextureHints hints;
    hints.type = SampleType::half16;
    const auto texels = read(film("Cmono10 XCOLORRANGE=FULL", {{514, 0, 0}}, 0, true), hints);
    ASSERT_TRUE(error_.ok()) << error_.message();
    std::uint16_t half = 0;
    std::memcpy(&half, texels.data(), 2);
    EXPECT_NEAR(half_to_float(half), 514 / 1023.0f, 0.0003f);
}

// Chroma lies between two columns, or on the left of them.
TEST_F(FilmTest, InterpolatesChromaAtItsPlace) {
    for (const bool left : {false, true}) {
        std::string text = "YUV4MPEG2 W4 H2 F1:1 C420" + std::string(left ? "mpeg2" : "jpeg") +
                           " XCOLORRANGE=FULL\nFRAME\n" + std::string(8, '\x80') + "\x80\x80" +
                           std::string("\x80\x90"); // Cr: 0 and 16 codes
        const auto texels = read(text);
        ASSERT_TRUE(error_.ok()) << error_.message();
        const double shares[2][4] = {{0, 0.25, 0.75, 1}, {0, 0.5, 1, 1}};
        for (std::size_t u = 0; u < 4; ++u)
            EXPECT_NEAR(std::to_integer<int>(texels[3 * u]),
                        128 + 16 * 1.402 * shares[left ? 1 : 0][u], 0.6)
                << left << u;
    }
}

TEST_F(FilmTest, FramesFillTheGridInTheirOrder) {
    std::vector<std::array<int, 3>> frames;
    for (int i = 0; i < 6; ++i)
        frames.push_back({16 + 20 * i, 128, 128});
    const std::string six = film("C420", frames, 2);
    read(six);
    EXPECT_EQ(error_.code(), ErrorCode::bad_argument);
    EXPECT_NE(error_.message().find("has 6 frames, which is no square of views; say --grid"),
              std::string::npos)
        << error_.message();
    TextureHints hints;
    hints.views.grid = ViewGrid{3, 2};
    hints.views.order = ViewOrder{false, true, false, false}; // serpentine
    const auto texels = read(six, hints);
    ASSERT_TRUE(error_.ok()) << error_.message();
    EXPECT_EQ(desc_.size, (Extent4{4, 2, 3, 2}));
    const int order[] = {0, 1, 2, 5, 4, 3};
    for (std::size_t i = 0; i < 6; ++i) // of the first texel: t, then s
        EXPECT_NEAR(std::to_integer<int>(texels[3 * i]), 255 * 20 * order[i] / 219.0, 1) << i;
    hints.views.grid = ViewGrid{2, 2};
    read(six, hints);
    EXPECT_EQ(error_.code(), ErrorCode::bad_argument);
}

TEST_F(FilmTest, RefusesDamagedFilms) {
    const std::string good = film("C420", {{100, 128, 128}}, 2);
    const auto refused = [&](const std::string& text, ErrorCode code, const std::string& words) {
        read(text);
        EXPECT_EQ(error_.code(), code) << words;
        EXPECT_NE(error_.message().find(words), std::string::npos) << error_.message();
    };
    refused(good.substr(0, good.size() - 1), ErrorCode::invalid_file, "frame 0 ends too early");
    refused(good + "junk", ErrorCode::invalid_file, "frame 1 does not begin with FRAME");
    refused(good.substr(0, 20), ErrorCode::invalid_file, "header");
    refused(good.substr(0, good.find('\n') + 1), ErrorCode::invalid_file, "no frames");
    refused(film("C420 It", {{1, 1, 1}}, 2), ErrorCode::unsupported, "interlaced");
    refused(film("C411", {{1, 1, 1}}, 2), ErrorCode::unsupported, "colour space C411");
    refused(film("C444alpha", {{1, 1, 1}}, 8), ErrorCode::unsupported, "colour space C444alpha");
    refused("YUV4MPEG2 W4 F1:1\nFRAME\n", ErrorCode::invalid_file, "no width or height");
    refused("YUV4MPEG2 W0 H4\nFRAME\n", ErrorCode::invalid_file, "'W0' is not its width");
    refused("YUV4MPEG2 W99999 H4\nFRAME\n", ErrorCode::unsupported, "16384");
    for (std::size_t length = 10; length < good.size(); ++length) {
        read(good.substr(0, length));
        EXPECT_FALSE(error_.ok()) << length;
    }
}

} // namespace
} // namespace tessera
