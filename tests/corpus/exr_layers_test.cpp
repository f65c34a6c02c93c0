// EXR files with layers, parts, other colours and other samples than halves of RGB.
#include "corpus/picture_file.h"
#include "format/samples.h"
#include "tests/support/pictures.h"
#include "tests/support/test_folder.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <cmath>
#include <cstring>

namespace tessera::corpus {
namespace {

using support::light_of;
using PixelValues = std::vector<double>;

class ExrLayers : public testing::Test {
protected:
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path() const { return (folder_ / "a.exr").string(); }

    // A channel whose samples are all `value`.
    struct Channel {
        std::string name;
        float value = 0;
        Imf::PixelType type = Imf::FLOAT;
    };
    static void add(const std::vector<Channel>& channels, Imf::Header& header,
                    Imf::FrameBuffer& frame, std::vector<std::uint32_t>& values) {
        values.resize(2 * channels.size());
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const float value = channels[c].value;
            std::uint32_t& sample = values[2 * c];
            header.channels().insert(channels[c].name, Imf::Channel(channels[c].type));
            if (channels[c].type == Imf::FLOAT)
                std::memcpy(&sample, &value, 4);
            else if (channels[c].type == Imf::UINT)
                sample = static_cast<std::uint32_t>(value);
            else
                sample = float_to_half(value);
            values[2 * c + 1] = sample;
            frame.insert(channels[c].name,
                         Imf::Slice(channels[c].type, reinterpret_cast<char*>(&sample), 4, 8));
        }
    }
    // Two pixels.
    std::string file(const std::vector<Channel>& channels,
                     const Imf::Chromaticities* colours = nullptr) const {
        Imf::Header header(2, 1);
        Imf::FrameBuffer frame;
        std::vector<std::uint32_t> values;
        add(channels, header, frame, values);
        if (colours != nullptr)
            Imf::addChromaticities(header, *colours);
        {
            Imf::OutputFile out(path().c_str(), header);
            out.setFrameBuffer(frame);
            out.writePixels(1);
        }
        return test::slurp(path());
    }
    std::string
    parts(const std::vector<std::pair<std::string, std::vector<Channel>>>& parts) const {
        std::vector<Imf::Header> headers(parts.size(), Imf::Header(2, 1));
        std::vector<Imf::FrameBuffer> frames(parts.size());
        std::vector<std::vector<std::uint32_t>> values(parts.size());
        for (std::size_t i = 0; i < parts.size(); ++i) {
            add(parts[i].second, headers[i], frames[i], values[i]);
            headers[i].setName(parts[i].first);
            headers[i].setType(Imf::SCANLINEIMAGE);
        }
        {
            Imf::MultiPartOutputFile out(path().c_str(), headers.data(),
                                         static_cast<int>(parts.size()));
            for (std::size_t i = 0; i < parts.size(); ++i) {
                Imf::OutputPart part(out, static_cast<int>(i));
                part.setFrameBuffer(frames[i]);
                part.writePixels(1);
            }
        }
        return test::slurp(path());
    }

    // The first pixel as halves. Sets status_, notes_ and clamped_.
    PixelValues pixel(const std::string& bytes, const std::string& layer = "") {
        const auto source = wrap_memory(std::as_bytes(std::span(bytes)));
        auto reader = open_picture_file(*source, {.layer = layer});
        status_ = reader.status();
        PixelValues out;
        if (!reader.ok())
            return out;
        notes_ = (*reader)->notes();
        status_ = (*reader)->read_rows(SampleType::half16, 0, 1,
                                       [&](std::uint32_t, std::span<const std::byte> row) {
                                           clamped_ = (*reader)->clamped_in_row();
                                           for (std::size_t i = 0; i < row.size() / 2; i += 2) {
                                               std::uint16_t half = 0;
                                               std::memcpy(&half, &row[i], 2);
                                               out.push_back(half_to_float(half));
                                           }
                                       });
        return out;
    }
    void refused(const std::string& bytes, const std::string& layer, ErrorCode code,
                 const std::string& words) {
        pixel(bytes, layer);
        EXPECT_EQ(status_.code(), code) << words << ": " << status_.message();
        EXPECT_NE(status_.message().find(words), std::string::npos) << status_.message();
    }

    std::filesystem::path folder_ = test::make_test_folder("exr_layers");
    Status status_;
    std::vector<std::string> notes_;
    std::uint64_t clamped_ = 0;
};

TEST_F(ExrLayers, TheOnlyLayerWithColoursIsRead) {
    const std::string blender = file({{"ViewLayer.Combined.R", 1},
                                      {"ViewLayer.Combined.G", 2},
                                      {"ViewLayer.Combined.B", 3},
                                      {"ViewLayer.Combined.A", 0.5f},
                                      {"ViewLayer.Depth.Z", 9},
                                      {"ViewLayer.Normal.X", 4},
                                      {"ViewLayer.Normal.Y", 5},
                                      {"ViewLayer.Normal.Z", 6}});
    EXPECT_EQ(pixel(blender), (PixelValues{1, 2, 3, 0.5}));
    for (const std::string name : {"ViewLayer.Combined", "Combined", "combined"})
        EXPECT_EQ(pixel(blender, name), (PixelValues{1, 2, 3, 0.5})) << name;
    EXPECT_EQ(pixel(blender, "Depth"), PixelValues{9});
    EXPECT_EQ(pixel(blender, "Normal"), (PixelValues{4, 5, 6}));
    EXPECT_TRUE(notes_.empty());
    refused(blender, "ombined", ErrorCode::bad_argument,
            "has no layer 'ombined'; its layers are: ViewLayer.Combined (A,B,G,R), "
            "ViewLayer.Depth (Z), ViewLayer.Normal (X,Y,Z)");
    // Channels without a layer come first.
    const std::string plain =
        file({{"R", 1}, {"G", 2}, {"B", 3}, {"spec.R", 4}, {"spec.G", 5}, {"spec.B", 6}, {"Z", 7}});
    EXPECT_EQ(pixel(plain), (PixelValues{1, 2, 3}));
    EXPECT_EQ(pixel(plain, "spec"), (PixelValues{4, 5, 6}));
    const std::string grey = file({{"beauty.Y", 8}, {"depth.Z", 1}});
    EXPECT_EQ(pixel(grey), PixelValues{8});
}

TEST_F(ExrLayers, SeveralLayersNeedAName) {
    const std::string stereo = file({{"left.R", 1},
                                     {"left.G", 2},
                                     {"left.B", 3},
                                     {"right.R", 4},
                                     {"right.G", 5},
                                     {"right.B", 6}});
    refused(stereo, "", ErrorCode::bad_argument,
            "has several layers with colours; say which by --layer: left (B,G,R), right (B,G,R)");
    EXPECT_EQ(pixel(stereo, "right"), (PixelValues{4, 5, 6}));
    const auto source = wrap_memory(std::as_bytes(std::span(stereo)));
    const auto light = read_light_image(*source, "right");
    ASSERT_TRUE(light.ok()) << light.status().message();
    EXPECT_EQ(light->texels[1], glm::vec3(4, 5, 6));
    EXPECT_EQ(light_of(stereo).status().code(), ErrorCode::bad_argument);
    const std::string two = file({{"a.c.Y", 1}, {"b.c.Y", 2}});
    refused(two, "c", ErrorCode::bad_argument, "has several layers 'c'; its layers are: a.c (Y)");
    refused(file({{"n.X", 1}, {"n.Y", 1}, {"n.Z", 1}, {"d.V", 2}}), "", ErrorCode::bad_argument,
            "no layer has channels R,G,B or Y; say which by --layer: d (V), n (X,Y,Z)");
    refused(file({{"m.a", 1}, {"m.b", 1}, {"m.c", 1}, {"m.d", 1}, {"m.e", 1}}), "m",
            ErrorCode::unsupported, "layer m has 5 channels, at most 4 are read: a,b,c,d,e");
}

TEST_F(ExrLayers, PartsAreLayers) {
    const std::string stereo = parts(
        {{"left", {{"R", 1}, {"G", 2}, {"B", 3}}}, {"right", {{"R", 4}, {"G", 5}, {"B", 6}}}});
    refused(stereo, "", ErrorCode::bad_argument, "left (B,G,R), right (B,G,R)");
    EXPECT_EQ(pixel(stereo, "left"), (PixelValues{1, 2, 3}));
    EXPECT_EQ(pixel(stereo, "right"), (PixelValues{4, 5, 6}));
    // Only one has colours; a part may name its channels after itself.
    const std::string passes = parts({{"depth", {{"depth.Z", 9}}},
                                      {"View.Combined", {{"View.Combined.Y", 4}}},
                                      {"extra", {{"uv.U", 1}, {"uv.V", 2}}}});
    EXPECT_EQ(pixel(passes), PixelValues{4});
    EXPECT_EQ(pixel(passes, "depth"), PixelValues{9});
    EXPECT_EQ(pixel(passes, "extra.uv"), (PixelValues{1, 2}));
}

TEST_F(ExrLayers, LargeFloatsAndIntegersAreClampedAndCounted) {
    EXPECT_EQ(pixel(file({{"R", 1e6f}, {"G", -1e9f}, {"B", 65504}})),
              (PixelValues{65504, -65504, 65504}));
    EXPECT_EQ(clamped_, 4u); // of two pixels
    EXPECT_EQ(pixel(file({{"R", INFINITY}, {"G", 1}, {"B", 1}}))[0], INFINITY);
    EXPECT_EQ(clamped_, 0u);
    EXPECT_EQ(pixel(file({{"R", 7, Imf::UINT}, {"G", 100000, Imf::UINT}, {"B", 0.5f, Imf::HALF}})),
              (PixelValues{7, 65504, 0.5}));
    EXPECT_EQ(clamped_, 2u);
}

TEST_F(ExrLayers, XyzBecomesRgb) {
    // The colour (0.5, 0.25, 1) of sRGB.
    const double rgb[3] = {0.5, 0.25, 1};
    const double x = 0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2];
    const double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    const double z = 0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2];
    const Imf::Chromaticities xyz({1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f});
    const auto f = [](double a) { return static_cast<float>(a); };
    for (const std::string& bytes :
         {file({{"R", f(x)}, {"G", f(y)}, {"B", f(z)}}, &xyz),
          file({{"X", f(x)}, {"Y", f(y)}, {"Z", f(z)}}),
          file({{"RY", f((x - y) / y)}, {"Y", f(y)}, {"BY", f((z - y) / y)}}, &xyz)}) {
        const PixelValues found = pixel(bytes);
        ASSERT_EQ(found.size(), 3u) << status_.message();
        const auto light = light_of(bytes);
        ASSERT_TRUE(light.ok()) << light.status().message();
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(found[c], rgb[c], 0.002) << c;
            EXPECT_NEAR(light->texels[0][static_cast<glm::length_t>(c)], rgb[c], 0.002) << c;
        }
    }
}

// Light is converted to the primaries of sRGB. Views keep theirs, and that is said.
TEST_F(ExrLayers, OtherPrimaries) {
    const Imf::Chromaticities bt2020({0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f},
                                     {0.3127f, 0.3290f});
    const std::string bytes = file({{"R", 1}, {"G", 0.5f}, {"B", 0.25f}}, &bt2020);
    EXPECT_EQ(pixel(bytes), (PixelValues{1, 0.5, 0.25}));
    ASSERT_EQ(notes_.size(), 1u);
    EXPECT_NE(notes_[0].find("not those of BT.709"), std::string::npos) << notes_[0];
    const auto light = light_of(bytes);
    ASSERT_TRUE(light.ok()) << light.status().message();
    // By the matrix of BT.2087: 1.6605, -0.5876, -0.0728; and so on.
    EXPECT_NEAR(light->texels[0].x, 1.6605 - 0.5876 * 0.5 - 0.0728 * 0.25, 0.002);
    EXPECT_NEAR(light->texels[0].y, -0.1246 + 1.1329 * 0.5 - 0.0083 * 0.25, 0.002);
    EXPECT_NEAR(light->texels[0].z, -0.0182 - 0.1006 * 0.5 + 1.1187 * 0.25, 0.002);
    // Grey stays grey under another white.
    const Imf::Chromaticities aces({0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f},
                                   {0.32168f, 0.33767f});
    const auto grey = light_of(file({{"R", 2}, {"G", 2}, {"B", 2}}, &aces));
    ASSERT_TRUE(grey.ok()) << grey.status().message();
    for (glm::length_t c = 0; c < 3; ++c)
        EXPECT_NEAR(grey->texels[0][c], 2, 0.002);
    // Primaries that span no triangle are ignored.
    const Imf::Chromaticities none({0, 0}, {0, 0}, {0, 0}, {0, 0});
    EXPECT_EQ(pixel(file({{"R", 1}, {"G", 2}, {"B", 3}}, &none)), (PixelValues{1, 2, 3}));
    EXPECT_TRUE(light_of(file({{"R", 1}, {"G", 2}, {"B", 3}}, &none)).ok());
}

TEST_F(ExrLayers, TilesAreReadAtTheFinestLevel) {
    for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
        Imf::Header header(40, 24);
        header.setTileDescription(Imf::TileDescription(16, 16, mode));
        header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
        {
            Imf::TiledOutputFile out(path().c_str(), header);
            for (int ly = 0; ly < out.numYLevels(); ++ly)
                for (int lx = 0; lx < out.numXLevels(); ++lx) {
                    if (!out.isValidLevel(lx, ly))
                        continue;
                    std::vector<float> values(40 * 24);
                    for (std::size_t i = 0; i < values.size(); ++i)
                        values[i] = lx + ly > 0 ? -1 : static_cast<float>(i);
                    Imf::FrameBuffer frame;
                    frame.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                                 4, 160));
                    out.setFrameBuffer(frame);
                    out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
                }
        }
        const std::string bytes = test::slurp(path());
        const auto light = light_of(bytes);
        ASSERT_TRUE(light.ok()) << light.status().message();
        ASSERT_EQ(light->texels.size(), 960u);
        for (std::size_t i = 0; i < 960; ++i)
            ASSERT_EQ(light->texels[i].x, static_cast<float>(i)) << mode;
    }
}

} // namespace
} // namespace tessera::corpus
