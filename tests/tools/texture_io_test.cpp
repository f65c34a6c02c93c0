// Tests textures in files of every kind: written files are read back, and errors name the bad file.
#include "format/levels.h"
#include "format/work.h"
#include "tests/support/test_folder.h"
#include "tools/support/copy_texture.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/texture_io/texture_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

namespace tessera {
namespace {

using test::slurp;
using test::spit;

namespace fs = std::filesystem;

// Gives each test a temporary folder.
class ImageIo : public testing::Test {
protected:
    void SetUp() override { folder_ = test::make_test_folder("io"); }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::size_t entries() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }
    fs::path folder_;
};

// Random samples in memory. Half floats have any bits, including NaN and infinities.
class NoiseTexture : public TexelSource {
public:
    NoiseTexture(const TextureDesc& desc, unsigned seed)
        : desc_(desc), texels_(desc.box_bytes(Box4::whole(desc.size))) {
        std::mt19937 random(seed);
        for (std::byte& b : texels_)
            b = static_cast<std::byte>(random() & 255u);
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        copy_box(box, Box4::whole(desc_.size), texels_, box, out, desc_.texel_bytes());
        return {};
    }
    std::vector<std::byte>& bytes() { return texels_; }

private:
    TextureDesc desc_;
    std::vector<std::byte> texels_;
};

TextureDesc make_desc(Extent4 size, SampleType type, std::uint8_t channels) {
    return {size, type, channels};
}

Status write(TexelSource& source, const std::string& path, const Description& d = {}) {
    auto sink = create_texture(path, source.desc(), d, 2);
    if (!sink.ok())
        return sink.status();
    return copy_texture(source, **sink, 2, {}, "test");
}

TextureHints hints_of(const TextureDesc& desc) {
    TextureHints hints;
    hints.size = desc.size;
    hints.type = desc.type;
    hints.channels = desc.channels;
    return hints;
}

std::vector<std::byte> read_box(TexelSource& source, const Box4& box) {
    std::vector<std::byte> out(source.desc().box_bytes(box));
    const Status status = source.read(box, out);
    EXPECT_TRUE(status.ok()) << status.message();
    return out;
}

void expect_same(NoiseTexture& expected, TexelSource& actual) {
    ASSERT_EQ(actual.desc(), expected.desc());
    const Box4 whole = Box4::whole(expected.desc().size);
    const Status status = actual.begin_slab(whole);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(read_box(actual, whole), expected.bytes());
}

std::string raw_name(const TextureDesc& desc) {
    static const char* const names[] = {"x.gray", "x.ya", "x.rgb", "x.rgba"};
    return std::string(names[desc.channels - 1]) + (desc.type == SampleType::half16 ? "16f" : "");
}

const Extent4 odd_sizes[] = {{7, 5, 3, 2}, {1, 1, 1, 1}, {1, 9, 1, 4}, {33, 31, 9, 7}};

TEST_F(ImageIo, RoundTripsEveryKindTypeAndSize) {
    for (const Extent4& size : odd_sizes)
        for (SampleType type : {SampleType::unorm8, SampleType::half16})
            for (std::uint8_t channels = 1; channels <= 4; ++channels) {
                NoiseTexture texture(make_desc(size, type, channels), channels);
                for (const std::string& name : {raw_name(texture.desc()), std::string("x.exr"),
                                                std::string("x.raw"), std::string("views/")}) {
                    const Status written = write(texture, path(name));
                    if (name == "views/" && type == SampleType::half16) {
                        EXPECT_EQ(written.code(), ErrorCode::unsupported);
                        continue;
                    }
                    ASSERT_TRUE(written.ok()) << written.message();
                    // Raw files store no description, the others store all of it.
                    TextureHints hints;
                    if (kind_of(path(name)) == TextureKind::raw)
                        hints = hints_of(texture.desc());
                    const auto opened = open_texture(path(name), hints);
                    ASSERT_TRUE(opened.ok()) << opened.status().message();
                    expect_same(texture, *opened->source);
                }
            }
}

TEST_F(ImageIo, ReadsBoxesOfSlabsFromSeveralThreads) {
    const Extent4 size{13, 11, 70, 6}; // s is long enough for both ways of reading raw files
    NoiseTexture texture(make_desc(size, SampleType::unorm8, 3), 7);
    for (const std::string name : {"x.rgb", "x.exr", "views/"}) {
        ASSERT_TRUE(write(texture, path(name)).ok());
        TextureHints hints;
        hints.size = size;
        const auto opened = open_texture(path(name), hints);
        ASSERT_TRUE(opened.ok()) << opened.status().message();
        const Box4 slab{{2, 1, 3, 1}, {12, 9, 68, 6}};
        ASSERT_TRUE(opened->source->begin_slab(slab).ok());
        const Status status = parallel_for(200, 4, [&](std::uint64_t i) {
            std::mt19937 random(static_cast<unsigned>(i));
            Box4 box;
            for (std::size_t a = 0; a < 4; ++a) {
                const std::uint32_t n = slab.end[a] - slab.begin[a];
                box.begin[a] = slab.begin[a] + static_cast<std::uint32_t>(random()) % n;
                box.end[a] = box.begin[a] + 1 +
                             static_cast<std::uint32_t>(random()) % (slab.end[a] - box.begin[a]);
            }
            EXPECT_EQ(read_box(*opened->source, box), read_box(texture, box)) << to_string(box);
            return Status();
        });
        EXPECT_TRUE(status.ok()) << status.message();
        std::vector<std::byte> byte(3);
        EXPECT_FALSE(opened->source->read({{0, 0, 0, 0}, {1, 1, 1, 2}}, byte).ok());
    }
}

// Reads like the encoder: all views of some texels, tile after tile. All views of 20x13 texels are
// kept; of 40x26, only rows of views, because they need more than 4 MiB.
TEST_F(ImageIo, ReadsRawTilesOfTheSamePlacesInTurn) {
    NoiseTexture texture(make_desc({47, 27, 70, 65}, SampleType::unorm8, 1), 11);
    ASSERT_TRUE(write(texture, path("x.gray")).ok());
    const auto opened = open_texture(path("x.gray"), hints_of(texture.desc()));
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    for (const Extent4& part : {Extent4{20, 13, 70, 65}, Extent4{40, 26, 70, 65}}) {
        const TileGrid places(texture.desc().size, part), views({1, 1, 70, 65}, {1, 1, 30, 30});
        const Status status = parallel_for(places.tiles() * views.tiles(), 4, [&](std::uint64_t i) {
            Box4 box = places.box(i / views.tiles());
            const Box4 of_views = views.box(i % views.tiles());
            for (const Axis axis : {axis_s, axis_t}) {
                box.begin[axis] = of_views.begin[axis];
                box.end[axis] = of_views.end[axis];
            }
            EXPECT_EQ(read_box(*opened->source, box), read_box(texture, box)) << to_string(box);
            return Status();
        });
        EXPECT_TRUE(status.ok()) << status.message();
    }
}

TEST_F(ImageIo, RawSinkTakesBoxesInAnyOrderWithoutSlabs) {
    NoiseTexture texture(make_desc({4, 3, 5, 2}, SampleType::unorm8, 3), 3);
    auto sink = create_texture(path("x.rgb"), texture.desc(), {}, 1);
    ASSERT_TRUE(sink.ok());
    for (std::uint32_t s : {3u, 0u})
        for (std::uint32_t v : {2u, 0u, 1u}) {
            const Box4 box{{0, v, s, 0}, {4, v + 1, s == 0 ? 3u : 5u, 2}};
            ASSERT_TRUE((*sink)->write(box, read_box(texture, box)).ok());
        }
    ASSERT_TRUE((*sink)->finish().ok());
    const auto opened = open_texture(path("x.rgb"), hints_of(texture.desc()));
    ASSERT_TRUE(opened.ok());
    expect_same(texture, *opened->source);
}

TEST_F(ImageIo, KeepsTheDescription) {
    Description d;
    d.proxy = Proxy::sphere;
    d.sphere_radius = 3.5f;
    d.sphere_centre[1] = -0.1f;
    d.surface_map = SurfaceMap::sphere_longitude_latitude;
    d.angular_map = AngularMap::hemisphere_alpha_beta;
    d.transfer = Transfer::srgb;
    d.primaries = Primaries::bt709;
    d.viewing_radius[0] = 4;
    d.viewing_radius[1] = 1e6f;
    NoiseTexture texture(make_desc({3, 2, 2, 2}, SampleType::unorm8, 3), 1);
    for (const std::string name : {"x.exr", "views/"}) {
        ASSERT_TRUE(write(texture, path(name), d).ok());
        const auto opened = open_texture(path(name), {});
        ASSERT_TRUE(opened.ok()) << opened.status().message();
        EXPECT_EQ(opened->description, d);
    }
}

TEST_F(ImageIo, LeavesNothingBehindWithoutFinish) {
    NoiseTexture texture(make_desc({3, 2, 2, 2}, SampleType::unorm8, 3), 1);
    for (const std::string name : {"x.rgb", "x.exr", "views/"}) {
        {
            auto sink = create_texture(path(name), texture.desc(), {}, 1);
            ASSERT_TRUE(sink.ok());
            const Box4 whole = Box4::whole(texture.desc().size);
            ASSERT_TRUE((*sink)->begin_slab(whole).ok());
            ASSERT_TRUE((*sink)->write(whole, texture.bytes()).ok());
            ASSERT_TRUE((*sink)->end_slab().ok());
        }
        EXPECT_EQ(entries(), 0u) << name;
    }
}

TEST_F(ImageIo, RefusesRawOfAnotherSize) {
    const TextureDesc desc = make_desc({7, 5, 3, 2}, SampleType::unorm8, 3);
    for (int off : {-1, 1}) {
        std::ofstream(path("x.rgb")) << std::string(static_cast<std::size_t>(630 + off), 'x');
        const auto opened = open_texture(path("x.rgb"), hints_of(desc));
        ASSERT_FALSE(opened.ok());
        EXPECT_EQ(opened.status().code(), ErrorCode::invalid_file);
        EXPECT_NE(opened.status().message().find("630"), std::string::npos);
        EXPECT_NE(opened.status().message().find(std::to_string(630 + off)), std::string::npos);
    }
    EXPECT_EQ(open_texture(path("x.rgb"), {}).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(open_texture(path("none.rgb"), hints_of(desc)).status().code(), ErrorCode::io);
    EXPECT_EQ(open_texture(path("x.txt"), {}).status().code(), ErrorCode::bad_argument);
}

TEST_F(ImageIo, RefusesSizesPast64Bits) {
    TextureHints hints;
    hints.size = Extent4{1u << 20, 1u << 20, 1u << 20, 1u << 20};
    std::ofstream(path("x.rgb")) << "x";
    EXPECT_EQ(open_texture(path("x.rgb"), hints).status().code(), ErrorCode::bad_argument);
    hints.size = Extent4{1u << 20, 1u << 20, 1u << 8, 1};
    EXPECT_EQ(open_texture(path("x.rgb"), hints).status().code(), ErrorCode::invalid_file);
    NoiseTexture tiny(make_desc({1, 1, 1, 1}, SampleType::unorm8, 1), 1);
    for (const char* text : {"4294967297x1x1x1", "0x1x1x1", "1x1x1", "1x1x1x1x1", "-1x1x1x1", "x",
                             "", "1x1x1x 1", "99999999999999999999x1x1x1"})
        EXPECT_EQ(parse_extent(text).status().code(), ErrorCode::bad_argument) << text;
}

// Writes EXR pictures that the library would not write.

void write_foreign_exr(const std::string& path, int width, int height,
                       const std::vector<std::pair<std::string, Imf::PixelType>>& channels,
                       const std::string& size, int left = 0, int top = 0) {
    const Imath::Box2i window(Imath::V2i(left, top),
                              Imath::V2i(left + width - 1, top + height - 1));
    Imf::Header header(window, window);
    std::vector<float> values(static_cast<std::size_t>(width * height), 0.5f);
    std::vector<unsigned> counts(values.size(), 2);
    Imf::FrameBuffer frame;
    for (const auto& [name, type] : channels) {
        header.channels().insert(name, Imf::Channel(type));
        void* data = type == Imf::UINT ? static_cast<void*>(counts.data()) : values.data();
        frame.insert(name, Imf::Slice::Make(type, data, window.min, width, height));
    }
    if (!size.empty())
        header.insert("tessera:size", Imf::StringAttribute(size));
    Imf::OutputFile file(path.c_str(), header);
    if (!channels.empty())
        file.setFrameBuffer(frame);
    file.writePixels(height);
}

// OpenEXR cannot write a picture without channels, so this removes the only one from the header.
// The list has a 4-byte length, 18 bytes per channel with a short name, and a zero.
std::string without_channels(std::string exr) {
    const std::size_t list = exr.find(std::string("channels\0chlist\0", 16)) + 16;
    exr[list] = 1;
    return exr.erase(list + 4, 18);
}

TEST_F(ImageIo, ConvertsFloatAndUintChannels) {
    write_foreign_exr(path("x.exr"), 6, 2, {{"R", Imf::FLOAT}, {"G", Imf::UINT}, {"B", Imf::FLOAT}},
                      "", -3, 100);
    EXPECT_EQ(open_texture(path("x.exr"), {}).status().code(), ErrorCode::bad_argument);
    TextureHints hints;
    hints.size = Extent4{3, 1, 2, 2};
    const auto opened = open_texture(path("x.exr"), hints);
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    EXPECT_EQ(opened->source->desc().type, SampleType::half16);
    ASSERT_TRUE(opened->source->begin_slab(Box4::whole(*hints.size)).ok());
    const auto texels = read_box(*opened->source, Box4::whole(*hints.size));
    for (std::size_t i = 0; i < texels.size(); i += 6) {
        std::uint16_t rgb[3];
        std::memcpy(rgb, texels.data() + i, 6);
        EXPECT_EQ(rgb[0], 0x3800); // 0.5
        EXPECT_EQ(rgb[1], 0x4000); // 2
        EXPECT_EQ(rgb[2], 0x3800);
    }
}

TEST_F(ImageIo, ReadsTiledExr) {
    const int width = 35, height = 18;
    Imf::Header header(width, height);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.setTileDescription(Imf::TileDescription(16, 16));
    header.insert("tessera:size", Imf::StringAttribute("7x6x5x3"));
    std::vector<half> pixels;
    for (int i = 0; i < width * height; ++i)
        pixels.emplace_back(static_cast<float>(i));
    {
        Imf::TiledOutputFile file(path("x.exr").c_str(), header);
        Imf::FrameBuffer frame;
        frame.insert("Y",
                     Imf::Slice::Make(Imf::HALF, pixels.data(), Imath::V2i(0, 0), width, height));
        file.setFrameBuffer(frame);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    }
    const auto opened = open_texture(path("x.exr"), {});
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    ASSERT_TRUE(opened->source->begin_slab(Box4::whole({7, 6, 5, 3})).ok());
    const auto texel = read_box(*opened->source, {{4, 2, 3, 1}, {5, 3, 4, 2}});
    std::uint16_t bits;
    std::memcpy(&bits, texel.data(), 2);
    EXPECT_EQ(bits, half(static_cast<float>((2 * 3 + 1) * width + 4 * 5 + 3)).bits());
}

TEST_F(ImageIo, RefusesBadExr) {
    const auto refused = [&](const TextureHints& hints, const std::string& words) {
        const auto opened = open_texture(path("x.exr"), hints);
        EXPECT_FALSE(opened.ok()) << words;
        if (opened.ok())
            return;
        EXPECT_EQ(opened.status().code(), ErrorCode::invalid_file) << opened.status().message();
        EXPECT_NE(opened.status().message().find(words), std::string::npos)
            << opened.status().message();
        EXPECT_EQ(opened.status().message().rfind(path("x.exr"), 0), 0u);
    };
    write_foreign_exr(path("x.exr"), 6, 2, {{"Y", Imf::FLOAT}}, "3x1x2x2");
    spit(path("x.exr"), without_channels(slurp(path("x.exr"))));
    refused({}, "channel list");
    write_foreign_exr(path("x.exr"), 6, 2, {{"R", Imf::FLOAT}, {"B", Imf::FLOAT}}, "3x1x2x2");
    refused({}, "channel G is missing");
    write_foreign_exr(path("x.exr"), 6, 2, {{"depth", Imf::FLOAT}}, "3x1x2x2");
    refused({}, "channel R is missing");
    write_foreign_exr(path("x.exr"), 6, 2, {{"Y", Imf::FLOAT}}, "3x1x2x3");
    refused({}, "6x3 pixels");
    write_foreign_exr(path("x.exr"), 6, 2, {{"Y", Imf::FLOAT}}, "3x1x2");
    refused({}, "tessera:size");
    std::ofstream(path("x.exr")) << "this is no EXR picture, whatever its name says";
    refused({}, "EXR");
    std::ofstream(path("x.exr"), std::ios::trunc).flush();
    refused({}, "EXR");
}

TEST_F(ImageIo, FindsEveryTruncationOfAnExr) {
    NoiseTexture texture(make_desc({3, 4, 5, 6}, SampleType::unorm8, 3), 5);
    ASSERT_TRUE(write(texture, path("x.exr")).ok());
    const auto size = fs::file_size(path("x.exr"));
    for (std::uintmax_t n = size; n-- > 0;) {
        fs::resize_file(path("x.exr"), n);
        const auto opened = open_texture(path("x.exr"), {});
        Status status = opened.status();
        if (opened.ok())
            status = opened->source->begin_slab(Box4::whole(texture.desc().size));
        ASSERT_FALSE(status.ok()) << n << " of " << size;
        ASSERT_EQ(status.code(), ErrorCode::invalid_file) << status.message();
    }
}

TEST_F(ImageIo, SurvivesFlippedBytesOfAnExr) {
    NoiseTexture texture(make_desc({3, 4, 5, 6}, SampleType::unorm8, 3), 5);
    ASSERT_TRUE(write(texture, path("x.exr")).ok());
    const std::string good = slurp(path("x.exr"));
    std::fstream file(path("x.exr"), std::ios::binary | std::ios::in | std::ios::out);
    const auto patch = [&](std::size_t at, char byte) {
        file.seekp(static_cast<std::streamoff>(at));
        file.put(byte).flush();
    };
    for (std::size_t i = 0; i < good.size(); ++i) {
        patch(i, static_cast<char>(good[i] ^ (i % 2 ? 0xFF : 0x10)));
        const auto opened = open_texture(path("x.exr"), {});
        if (opened.ok()) // without checksums, damage may go undetected
            (void)opened->source->begin_slab(Box4::whole(opened->source->desc().size)).ok();
        patch(i, good[i]);
    }
}

// Tests of folders of views. views_io_test.cpp has more.

TEST_F(ImageIo, InfersViewsFromNamesAlone) {
    NoiseTexture texture(make_desc({7, 5, 3, 2}, SampleType::unorm8, 4), 5);
    ASSERT_TRUE(write(texture, path("views/")).ok());
    fs::remove(path("views/tessera.json"));
    const auto opened = open_texture(path("views"), {});
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    expect_same(texture, *opened->source);
}

TEST_F(ImageIo, RefusesBadFoldersOfViews) {
    NoiseTexture texture(make_desc({7, 5, 3, 2}, SampleType::unorm8, 3), 5);
    NoiseTexture other(make_desc({7, 6, 1, 1}, SampleType::unorm8, 3), 5);
    ASSERT_TRUE(write(other, path("other/")).ok());
    const auto refused = [&](ErrorCode code, const std::string& words) {
        const auto opened = open_texture(path("views"), {});
        Status status = opened.status();
        if (opened.ok())
            status = opened->source->begin_slab(Box4::whole(texture.desc().size));
        EXPECT_EQ(status.code(), code) << words << ": " << status.message();
        EXPECT_NE(status.message().find(words), std::string::npos) << status.message();
        fs::remove_all(path("views"));
        ASSERT_TRUE(write(texture, path("views/")).ok());
    };
    const std::string view = path("views/view_t001_s002.png");
    ASSERT_TRUE(write(texture, path("views/")).ok());
    fs::remove(view);
    refused(ErrorCode::invalid_file, "view_t001_s002.png");
    fs::copy_file(path("other/view_t000_s000.png"), view, fs::copy_options::overwrite_existing);
    refused(ErrorCode::invalid_file, "7x6 pixels of 3 channels instead of 7x5");
    std::ofstream(view, std::ios::trunc) << "no PNG at all, but long enough to hold a header";
    refused(ErrorCode::invalid_file, "not a PNG");
    fs::resize_file(view, fs::file_size(view) - 20);
    refused(ErrorCode::invalid_file, "view_t001_s002.png: damaged PNG");
    fs::copy_file(view, path("views/view_t1_s2.png"));
    refused(ErrorCode::invalid_file, "two files for one view");
    fs::copy_file(view, path("views/view_t002_s000.png"));
    refused(ErrorCode::invalid_file, "outside the 3x2 views");
    std::ofstream(path("views/tessera.json"), std::ios::trunc) << "{\"size\": ";
    refused(ErrorCode::invalid_file, "tessera.json");
    std::ofstream(path("views/tessera.json"), std::ios::trunc)
        << "{\"size\": \"7x5x1048576x1048576\"}";
    refused(ErrorCode::invalid_file, "view_t000_s003.png: this view is missing");
    fs::create_directories(path("empty"));
    EXPECT_EQ(open_texture(path("empty"), {}).status().code(), ErrorCode::invalid_file);
}

TEST_F(ImageIo, ReplacesOnlyItsOwnFolders) {
    NoiseTexture texture(make_desc({7, 5, 3, 2}, SampleType::unorm8, 3), 5);
    NoiseTexture smaller(make_desc({2, 2, 1, 1}, SampleType::unorm8, 3), 6);
    ASSERT_TRUE(write(texture, path("views/")).ok());
    ASSERT_TRUE(write(smaller, path("views/")).ok());
    const auto opened = open_texture(path("views/"), {});
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    expect_same(smaller, *opened->source);
    std::ofstream(path("views/holiday.jpg")) << "precious";
    const Status status = write(texture, path("views/"));
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find("holiday.jpg"), std::string::npos);
    EXPECT_TRUE(fs::exists(path("views/holiday.jpg")));
    EXPECT_EQ(entries(), 1u);
    fs::create_directories(path("nothing"));
    EXPECT_TRUE(write(texture, path("nothing")).ok());
}

// Paths that cannot be written.

TEST_F(ImageIo, ReportsPlacesThatCannotBeWritten) {
    NoiseTexture texture(make_desc({3, 2, 2, 2}, SampleType::unorm8, 3), 1);
    std::ofstream(path("file")) << "x";
    for (const std::string name : {"file/x.rgb", "file/x.exr", "file/views/"}) {
        const Status status = write(texture, path(name));
        EXPECT_EQ(status.code(), ErrorCode::io) << name;
        EXPECT_NE(status.message().find(path("file/")), std::string::npos) << status.message();
    }
    fs::create_symlink("/dev/full", path("full.rgb"));
    EXPECT_EQ(write(texture, path("full.rgb")).code(), ErrorCode::io);
    EXPECT_EQ(write(texture, path("file/")).code(), ErrorCode::io);
    EXPECT_EQ(write(texture, path("x.rgba")).code(), ErrorCode::bad_argument);
    EXPECT_EQ(entries(), 2u);
}

TEST_F(ImageIo, RefusesReadOnlyFolders) {
    if (getuid() == 0)
        GTEST_SKIP() << "nothing is read-only for root";
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    NoiseTexture texture(make_desc({3, 2, 2, 2}, SampleType::unorm8, 3), 1);
    for (const std::string name : {"x.rgb", "x.exr", "views/"})
        EXPECT_EQ(write(texture, path(name)).code(), ErrorCode::io) << name;
    fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(ImageIo, RefusesMoreThanTheDiskHolds) {
    EXPECT_TRUE(check_parent_folders(path("x.rgb"), 1).ok());
    const Status status = check_parent_folders(path("x.rgb"), std::uint64_t{1} << 62);
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find("the disk has"), std::string::npos) << status.message();
}

TEST(Parse, ReadsBoxes) {
    const Extent4 size{8, 6, 4, 2};
    const auto box = parse_box("1:3,:6,2:,:", size);
    ASSERT_TRUE(box.ok()) << box.status().message();
    EXPECT_EQ(*box, (Box4{{1, 0, 2, 0}, {3, 6, 4, 2}}));
    for (const char* text : {"", "1:3", "1:3,0:7,:,:", "3:3,:,:,:", "4:3,:,:,:", "a:b,:,:,:",
                             "1-3,:,:,:", ":,:,:,:,:", "0:18446744073709551616,:,:,:"})
        EXPECT_EQ(parse_box(text, size).status().code(), ErrorCode::bad_argument) << text;
}

} // namespace
} // namespace tessera
