// Tests the verb render in this process.
#include "tests/support/rendering.h"
#include "tools/picture/picture.h"
#include "tools/support/json_text.h"
#include "tools/verbs/command.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_file.h"

#include <ImfArray.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

namespace fs = std::filesystem;

TEST_F(Render, DrawsMeasuresAndShows) {
    const std::string file = encode("composed", "c.tess");
    ASSERT_TRUE(
        run({file, "-o", at("v.png"), "--views", "paper", "--pixels", "40x30", "--truth",
             "composed", "--truth-spp", "2", "--sheet", at("s.png"), "--json", "--write-all"})
            .ok());
    const Json json = Json::parse(out_);
    ASSERT_EQ(json["views"].size(), 5u);
    for (const Json& view : json["views"]) {
        EXPECT_GT(view["compressed_uncompressed"]["psnr"].get<double>(), 35) << view;
        EXPECT_GT(view["compressed_truth"]["psnr"].get<double>(), 15) << view;
        EXPECT_LT(view["uncompressed_truth"]["ssim"].get<double>(), 1) << view;
        EXPECT_EQ(read_png(view["output"].get<std::string>())->width, 40u);
    }
    EXPECT_GT(read_png(at("s.png"))->height, 5u * 30);
    EXPECT_TRUE(fs::exists(at("v-5-truth.png")) && fs::exists(at("v-1-uncompressed.png")));
    // The original comes from a file, without a scene, on an orbit.
    ASSERT_TRUE(run({file, "-o", at("o.png"), "--orbit", "2", "--pixels", "8x8", "--original", file,
                     "--json"})
                    .ok());
    EXPECT_TRUE(Json::parse(out_)["views"][1]["compressed_uncompressed"]["psnr"].is_null());
    EXPECT_TRUE(fs::exists(at("o-2.png")));
    ASSERT_TRUE(run({file, "-o", at("q.png"), "--pixels", "8x8", "-q"}).ok());
    EXPECT_EQ(out_, "");
}

TEST_F(Render, DrawsATextureThatNoFileHolds) {
    const std::vector<std::string> how = {"--views", "1",        "--pixels", "40x30",
                                          "--truth", "composed", "--json"};
    std::vector<std::string> words = {"-o",     at("s.png"), "--scene", "composed",
                                      "--size", "32x16x8x8", "--spp",   "2"};
    words.insert(words.end(), how.begin(), how.end());
    ASSERT_TRUE(run(words).ok());
    const Json scene = Json::parse(out_);
    words = {encode("composed", "c.tess"), "-o", at("c.png")};
    words.insert(words.end(), how.begin(), how.end());
    ASSERT_TRUE(run(words).ok());
    EXPECT_EQ(scene["views"][0]["uncompressed_truth"],
              Json::parse(out_)["views"][0]["uncompressed_truth"]);
    EXPECT_FALSE(scene["views"][0].contains("compressed_truth"));
    // The texture would have 422 TB.
    EXPECT_TRUE(run({"-o", at("h.png"), "--scene", "lamps", "--size", "65536x16384x256x256",
                     "--spp", "1", "--pixels", "8x6"})
                    .ok());
}

// RGB of a picture of 32x20 pixels.
std::vector<float> exr_pixels(const std::string& path) {
    std::vector<float> rgb(32 * 20 * 3);
    Imf::InputFile in(path.c_str());
    Imf::FrameBuffer frame;
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c)
        frame.insert(names[c],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(rgb.data() + c), 12, 12 * 32));
    in.setFrameBuffer(frame);
    in.readPixels(0, 19);
    return rgb;
}

TEST_F(Render, WritesExr) {
    const std::string file = encode("lamps", "l.tess");
    ASSERT_TRUE(run({file, "-o", at("l.exr"), "--pixels", "32x20", "--truth", "lamps"}).ok());
    ASSERT_TRUE(run({file, "-o", at("l.png"), "--pixels", "32x20"}).ok());
    std::vector<float> rgb = exr_pixels(at("l.exr"));
    const Picture shown = to_picture({32, 20, rgb}, SampleType::half16);
    const auto png = read_png(at("l.png"));
    ASSERT_TRUE(png.ok()) << png.status().message();
    EXPECT_EQ(shown.rgb, png->rgb);
    EXPECT_GT(*std::max_element(rgb.begin(), rgb.end()), 1.0f) << "scene-linear";
}

// A file of display values, too.
TEST_F(Render, ExrHoldsLinearLight) {
    const std::string file = encode("composed", "c.tess");
    ASSERT_TRUE(run({file, "-o", at("c.exr"), "--pixels", "32x20"}).ok());
    ASSERT_TRUE(run({file, "-o", at("c.png"), "--pixels", "32x20"}).ok());
    std::vector<float> rgb = exr_pixels(at("c.exr"));
    for (float& x : rgb)
        x = static_cast<float>(corpus::linear_to_srgb(static_cast<double>(x)));
    const auto png = read_png(at("c.png"));
    ASSERT_TRUE(png.ok()) << png.status().message();
    EXPECT_EQ(to_picture({32, 20, rgb}, SampleType::unorm8).rgb, png->rgb);
}

TEST_F(Render, RefusesWithReasons) {
    const std::string file = encode("composed", "c.tess"), out = at("v.png");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--eye", "1,0,0"}, "outside");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--fov", "180"}, "between 0 and 180");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--pixels", "0x4"}, "0x4");
    fails(ErrorCode::bad_argument, {file, "-o", at("v.jpg")}, ".png");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--truth", "nowhere"}, "aliasing-near");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--truth", "mirror"}, "composed");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--views", "6"}, "paper");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--sheet", out}, "name of a view");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--original", at("x.exr")}, "raw");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--via", "magic"}, "magic");
    fails(ErrorCode::bad_argument, {at("c.rgb"), "-o", out}, ".tess");
    fails(ErrorCode::unsupported, {encode("composed", "flat.tess", false), "-o", out}, "--proxy");
    fails(ErrorCode::bad_argument, {"-o", out}, "--scene");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--scene", "composed"}, "not both");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--size", "8x8x8x8"}, "--scene");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--spp", "2"}, "--truth");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "nowhere"}, "aliasing-near");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "composed", "--via", "load"}, "CPU");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "composed", "--size", "8x8x8"}, "8x8x8");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "composed", "--truth", "mirror"},
          "mirror");
    fails(ErrorCode::io, {at("none.tess"), "-o", out}, "none.tess");
    std::ofstream(at("file")) << "not a folder";
    fails(ErrorCode::io, {at("none.tess"), "-o", at("file/v.png")}, "not a folder");
    fails(ErrorCode::io, {at("none.tess"), "-o", out, "--sheet", at("file/s.png")}, "not a folder");
    std::ofstream(at("bad.tess")) << "not a texture";
    fails(ErrorCode::invalid_file, {at("bad.tess"), "-o", out}, "bad.tess");
    EXPECT_FALSE(fs::exists(out));
}

} // namespace
} // namespace tessera
