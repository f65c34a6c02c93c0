// Tests the verb encode: targets, masks, reuse.
#include "tests/support/cli_fixture.h"
#include "tests/support/cli_scenes.h"

#include <fcntl.h>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/file.h>
#include <unistd.h>

namespace {

using namespace tessera::test;
using namespace tessera::test::cli_scenes;

class EncodeVerb : public CliFixture {};

TEST_F(EncodeVerb, ReusesTheTilesThatWereNotEdited) {
    succeed(small_scene + "-q -o old.tess --quality 60 --meta by=me " + quick);
    succeed("decode old.tess -q -o x.rgb");
    // Size, effort, description and metadata come from the old file.
    const Json report = json("encode x.rgb --reuse old.tess -o new.tess --json");
    EXPECT_EQ(slurp(at("new.tess")), slurp(at("old.tess")));
    EXPECT_GE(report["kept_tiles"], 1);
    EXPECT_FALSE(report.contains("rate"));
    EXPECT_EQ(run("encode x.rgb --reuse old.tess -o old.tess").code, 0);
    EXPECT_EQ(slurp(at("new.tess")), slurp(at("old.tess")));
    for (const char* option : {"--quality 60", "--tile 8x8x8x8"})
        fail(1, std::string("encode x.rgb --reuse old.tess -o y.tess ") + option,
             {"--reuse", std::string(option).substr(0, 6)});
    fail(1, "encode x.rgb --size 16x32x9x5 --reuse old.tess -o y.tess",
         {"old.tess", "another texture"});
    fail(1, "encode x.rgb --reuse x.rgb -o y.tess", {"x.rgb", ".tess"});
    fail(2, "encode x.rgb --reuse gone.tess -o y.tess", {"gone.tess"});
    EXPECT_EQ(names(), (std::vector<std::string>{"new.tess", "old.tess", "x.rgb"}));
}

TEST_F(EncodeVerb, KeepsItsTargetsAndBounds) {
    succeed(small_scene + "-q -o a.rgb");
    const std::string encode = "encode a.rgb --size 32x16x9x5 -q -o x.tess " + quick;
    succeed(encode + "--max-error 0");
    EXPECT_EQ(json("compare a.rgb x.tess --json")["identical"], true);
    const std::string lossless = slurp(at("x.tess"));
    succeed(encode + "--lossless");
    EXPECT_EQ(slurp(at("x.tess")), lossless);
    fail(1, encode + "--lossless --max-error 0", {"--max-error and --lossless"});
    succeed(encode + "--max-error 3");
    EXPECT_LE(json("compare a.rgb x.tess --json")["max_error"].get<int>(), 3);
    succeed(encode + "--target-psnr 36");
    EXPECT_GE(json("compare a.rgb x.tess --json")["psnr"].get<double>(), 35.95);
    succeed(encode + "--target-bytes 6000");
    EXPECT_LE(fs::file_size(at("x.tess")), 6000u);
    succeed(encode + "--target-bpt 2");
    EXPECT_LE(static_cast<double>(fs::file_size(at("x.tess"))) * 8, 2.0 * 32 * 16 * 9 * 5);
    succeed(encode + "--threads 1");
    const std::string one = slurp(at("x.tess"));
    succeed(encode + "--threads 3 --no-verify");
    EXPECT_EQ(slurp(at("x.tess")), one);
}

// Neither texture reaches 90 dB with the finest quantiser. That file is smaller than the lossless
// one for the baked texture, and larger for the texture with few values.
TEST_F(EncodeVerb, TargetsBeyondEveryQuantiser) {
    succeed("bake composed --size 16x8x4x4 --spp 1 -q -o a.rgb");
    std::string plain(16 * 8 * 4 * 4 * 3, '\0');
    for (std::size_t i = 0; i < plain.size(); i += 977)
        plain[i] = '\xff';
    spit(at("b.rgb"), plain);
    const std::string how = " --size 16x8x4x4 --effort 0 --target-psnr 90 ",
                      encode = "encode a.rgb -o x.tess" + how;
    fail(6, encode + "-q", {"x.tess", "not 90.00", "--lossless-fallback"});
    EXPECT_EQ(names(), (std::vector<std::string>{"a.rgb", "b.rgb", "x.tess"})); // no journal
    succeed("validate -q x.tess");
    const std::string missed = slurp(at("x.tess"));
    for (const char* more : {"--resume", "--threads 1"}) {
        EXPECT_EQ(run(encode + more).code, 6) << more;
        EXPECT_EQ(slurp(at("x.tess")) == missed, true) << more;
    }
    EXPECT_EQ(json(encode + "--json")["target_met"], false);
    EXPECT_EQ(run("encode a.rgb -q -o -" + how).out == missed, true);

    spit(at("m.gray"), std::string(64, 'x') + std::string(64, '\0'));
    for (const std::string more :
         {"", "--resume", "--layers", "--mask m.gray --mask-size 16x8x1x1"}) {
        const Json met = json(encode + "--lossless-fallback --json " + more);
        EXPECT_EQ(met["lossless"], true) << more;
        const std::string compare = "compare a.rgb x.tess --json ";
        const bool masked = more.starts_with("--mask");
        EXPECT_EQ(json(compare + (masked ? more : ""))["max_error"], 0) << more;
    }
    const Json by_default = json("encode b.rgb -o x.tess --json" + how);
    EXPECT_EQ(by_default["lossless"], true);
    EXPECT_EQ(by_default["target_met"], true);

    for (const char* rate : {"--target-bytes 2000", "--max-error 1", "--quality 90", ""})
        fail(1, std::string("encode a.rgb --size 16x8x4x4 -o y.tess --lossless-fallback ") + rate,
             {"--lossless-fallback", "--target-psnr"});
    fail(1, "bake composed --size 16x8x4x4 --spp 1 -o y.rgb --lossless-fallback",
         {"--lossless-fallback", ".tess"});
}

TEST_F(EncodeVerb, MasksSayWhichTexelsMatter) {
    succeed(small_scene + "-q -o a.rgb");
    std::string places(32 * 16, '\0');
    for (std::size_t i = 0; i < places.size(); ++i)
        places[i] = i % 32 < 24 ? 'x' : '\0';
    spit(at("m.gray"), places);
    const std::string encode = "encode a.rgb --size 32x16x9x5 " + quick,
                      sides = " --mask-size 32x16x1x1";
    const Outcome coded = run(encode + "-o x.tess --mask m.gray" + sides);
    EXPECT_EQ(coded.code, 0) << coded.err;
    EXPECT_NE(coded.out.find("75.00 % of the texels are not masked"), std::string::npos)
        << coded.out;
    succeed(encode + "-q -o plain.tess");
    EXPECT_LT(fs::file_size(at("x.tess")), fs::file_size(at("plain.tess")));
    // The same mask in other file formats.
    succeed("encode m.gray --size 32x16x1x1 --max-error 0 -q -o m.tess");
    for (const char* mask : {"m.exr", "m_views/"})
        succeed(std::string("decode m.tess -q -o ") + mask);
    for (const char* mask : {"m.tess", "m.exr", "m_views"}) {
        succeed(encode + "-q -o y.tess --mask " + mask + sides);
        EXPECT_EQ(slurp(at("y.tess")) == slurp(at("x.tess")), true) << mask;
    }

    const std::string compare = "compare a.rgb x.tess ";
    const Json all = json(compare + "--json"),
               part = json(compare + "--json --mask m.gray" + sides);
    EXPECT_GT(part["psnr"], all["psnr"]);
    EXPECT_EQ(part["mask"]["texels"], 24 * 16 * 9 * 5);
    EXPECT_FALSE(part.contains("ssim"));
    const Outcome text = run(compare + "--mask m.gray" + sides);
    EXPECT_NE(text.out.find("17280 texels are not masked"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("no SSIM"), std::string::npos) << text.out;
}

TEST_F(EncodeVerb, RefusesMasksThatDoNotFit) {
    succeed(small_scene + "-q -o a.rgb");
    spit(at("m.gray"), std::string(32 * 16, 'x'));
    const std::string encode = "encode a.rgb --size 32x16x9x5 -o x.tess --mask ",
                      compare = "compare a.rgb a.rgb --size 32x16x9x5 --mask ";
    for (const std::string& verb : {encode, compare}) {
        fail(2, verb + "missing.gray", {"missing.gray"});
        fail(3, verb + "m.gray", {"m.gray"}); // wrong size
        fail(1, verb + "m.gray --mask-size 16x32x1x1", {"m.gray", "16x32x1x1", "32x16x9x5"});
        fail(1, verb + "m.gray --mask-size 16x32x1", {"--mask-size"});
        fail(1, verb + "m.txt", {"m.txt"});
    }
    fail(1, "encode a.rgb --size 32x16x9x5 -o x.tess --mask-size 32x16x1x1", {"--mask"});
    fail(1, compare + "m.gray --mask-size 32x16x1x1 --min-ssim 0.5", {"--min-ssim"});
    // A mask that is loaded counts towards the budget. One with one byte per texel is read in place
    // and does not.
    const std::uintmax_t texels = 128ull * 64 * 32 * 32;
    for (const auto& [name, channels] : {std::pair("large.gray", 1u), std::pair("large.rgb", 3u)}) {
        spit(at(name), "");
        fs::resize_file(at(name), texels * channels); // a hole
    }
    const std::string large = "encode large.gray --size 128x64x32x32 --effort 0 -q -o y.tess "
                              "--threads 1 --memory 109M --mask ";
    fail(5, large + "large.rgb", {"large.rgb", "memory", "--memory", ".gray"});
    succeed(large + "large.gray");
    EXPECT_FALSE(fs::exists(at("x.tess")));
}

TEST_F(EncodeVerb, TakesOddSizes) {
    for (const std::string size : {"1x1x1x1", "7x5x3x2", "33x1x9x1"}) {
        succeed("bake gallery --spp 1 -q -o a.exr --size " + size);
        succeed("encode a.exr -q -o a.tess");
        succeed("validate a.tess -q");
        succeed("decode a.tess -q -o b/");
        EXPECT_EQ(json("compare a.tess b --json")["identical"], true) << size;
    }
}

TEST_F(EncodeVerb, HandlesHdr) {
    succeed("bake lamps -q --spp 1 --size 16x8x4x4 -o a.tess --max-error 4");
    succeed("bake lamps -q --spp 1 --size 16x8x4x4 -o a.exr");
    const Json c = json("compare a.exr a.tess --json");
    EXPECT_LE(c["max_error"].get<int>(), 4);
    EXPECT_TRUE(c.contains("psnr_pu21") && c.contains("psnr_log2"));
    EXPECT_EQ(json("info a.tess --json")["type"], "half16");
    fail(5, "decode a.tess -o views/", {"views", "EXR"});
    const std::string half("\x00\x7e\x00\x7c\x00\xfc\x00\x3c", 8); // NaN, inf, -inf, 1
    spit(at("n.gray16f"), half);
    const Outcome o = run("encode n.gray16f --size 2x2x1x1 -o n.tess --max-error 0");
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(o.err, "tessera encode: warning: NaN became 0\n"
                     "tessera encode: warning: infinities became +-65504 (2 times)\n");
    fail(3, "encode n.gray16f --size 2x2x1x1 -o m.tess --strict",
         {"n.gray16f", "texel u 0, v 0, s 0, t 0, channel 0 is NaN"});
    EXPECT_FALSE(fs::exists(at("m.tess")));
}

TEST_F(EncodeVerb, ReplacesItsInputOnlyOnPurpose) {
    spit(at("a.rgb"), std::string(8 * 8 * 3, '\x33'));
    succeed("encode a.rgb --size 8x8x1x1 -q -o a.tess");
    fs::create_symlink("a.tess", at("b.tess"));
    const std::string before = slurp(at("a.tess"));
    for (const char* output : {"a.tess", "./a.tess", "b.tess"})
        fail(1, std::string("encode a.tess -o ") + output, {output, "is the input", "--in-place"});
    EXPECT_EQ(slurp(at("a.tess")), before);
    succeed("encode a.tess -q --meta key=text --in-place -o b.tess");
    EXPECT_TRUE(fs::is_symlink(at("b.tess")));
    EXPECT_EQ(json("info a.tess --json")["metadata"]["key"], "text");
}

// Found before an input is read, which would take minutes.
TEST_F(EncodeVerb, ChecksItsOutputFirst) {
    spit(at("a.rgb"), std::string(8 * 8 * 3, '\x33'));
    const std::string missing = "encode gone.rgb --size 8x8x1x1 -o ";
    spit(at("old.tess"), "old");
    fs::permissions(at("old.tess"), fs::perms::owner_read);
    fail(2, missing + "old.tess", {"old.tess", "read-only"});
    fs::create_directories(at("w.tess.journal"));
    const int lock = ::open(at("w.tess.journal/lock").c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_GE(lock, 0);
    ASSERT_EQ(::flock(lock, LOCK_EX), 0);
    fail(2, missing + "w.tess", {"w.tess", "another process is writing"});
    ::close(lock);
    fail(2, missing + "w.tess", {"gone.rgb"});
}

// What the input states in vain is listed at the end, is in the JSON, or is an error.
TEST_F(EncodeVerb, CountsWarnings) {
    const float values[] = {1e6f, 2, 3, -1e7f};
    fs::create_directories(at("f"));
    for (const char* name : {"p1.pfm", "p2.pfm", "p3.pfm", "p4.pfm"})
        spit(at(fs::path("f") / name),
             "Pf 4 1 -1\n" + std::string(reinterpret_cast<const char*>(values), 16));
    const std::string command = "encode f/ --lossless -o f.tess";
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(o.err, "tessera encode: warning: samples beyond +-65504, the range of half floats, "
                     "became +-65504 (8 times, first in f/p1.pfm)\n");
    const Outcome j = run(command + " --json");
    const Json list = Json::parse(j.out)["warnings"];
    ASSERT_EQ(list.size(), 1u) << j.out;
    EXPECT_EQ(list[0]["count"], 8);
    EXPECT_EQ(list[0]["first"], "f/p1.pfm");
    fail(5, command + " --strict", {"f/p1.pfm", "beyond +-65504", "--strict"});
    EXPECT_EQ(json("encode f/ --lossless -o g.tess --type unorm8 --json")["warnings"].size(), 0u);
}

// Views as cameras deliver them: the tool reports how it reads them, and they can be drawn.
TEST_F(EncodeVerb, TakesViewsOfCameras) {
    std::string texels(8 * 6 * 2 * 3 * 3, '\0');
    for (std::size_t i = 0; i < texels.size(); ++i)
        texels[i] = static_cast<char>(i * 37 % 251);
    spit(at("a.rgb"), texels);
    const std::string exactly = " -o a.tess --max-error 0 --effort 0 ";
    succeed("encode a.rgb --size 8x6x2x3 -q" + exactly);
    succeed("decode a.tess -q -o rig/ --views-pattern 'out_{t:2}_{s:2}_-1.5_*.png'");
    fs::remove(at("rig/tessera.json"));
    const Outcome coded = run("encode rig/ --camera-spacing 0.5 --camera-focus 4" + exactly);
    EXPECT_EQ(coded.code, 0) << coded.err;
    EXPECT_EQ(coded.out.find("rig/: 6 views named out_{t:2}_{s:2}_-1.5_.png, 2x3 cameras from the "
                             "top left; 8x6x2x3, 3 x unorm8\n"),
              0u)
        << coded.out;
    const Json info = json("info a.tess --json");
    EXPECT_EQ(info["description"]["angular-map"], "planar-views");
    EXPECT_EQ(info["metadata"]["Cameras"], "0.5,0.5,4,2.91176187");
    succeed("decode a.tess -q -o b.rgb");
    EXPECT_EQ(slurp(at("b.rgb")) == texels, true);

    // From a camera's position its view is drawn pixel for pixel.
    succeed("decode a.tess -q -o same/");
    succeed("render a.tess -q -o v.png --pixels 8x6 --eye 0.25,-0.5,4");
    EXPECT_EQ(json("compare v.png same/out_02_01_-1.5_.png --json")["identical"], true);
    succeed("render a.tess -q -o middle.png --pixels 80x60 --focus 2");
    EXPECT_EQ(json("compare v.png same/out_02_00_-1.5_.png --json")["identical"], false);
    fail(1, "render a.tess -q -o w.png --eye 0,0,-1", {"window"});
    fail(5, "render a.tess -q -o w.png --via load", {"planar views"});
    // Other file names, and single pictures.
    succeed("encode same/ -q" + exactly); // tessera.json knows the cameras
    EXPECT_EQ(json("info a.tess --json")["metadata"]["Cameras"], info["metadata"]["Cameras"]);
    succeed("decode a.tess -q -o x_qs3x2a1.png --quilt 3x2");
    succeed("encode x_qs3x2a1.png --grid 2x3 --order bottom-up -q" + exactly);
    succeed("decode a.tess -q -o b.rgb");
    EXPECT_EQ(slurp(at("b.rgb")) == texels, true);
    succeed("decode a.tess -q -o m.png --quilt 6x1");
    fail(1, "decode a.tess -q -o m.png --quilt 4x1", {"m.png", "4x1", "8x6x2x3"});
    succeed("decode a.tess -q -o m.png --views-pattern '{n}.png'");
    succeed("encode m.png --mosaic 2x3 -q" + exactly);
    succeed("decode a.tess -q -o b.rgb");
    EXPECT_EQ(slurp(at("b.rgb")) == texels, true);
    fail(1, "encode rig/ -o x.tess --order upside", {"--order", "'upside'", "bottom-up"});
    fail(1, "encode a.rgb --size 8x6x2x3 -o x.tess --camera-fov 40", {"--camera-fov", "planar"});
    fail(1, "encode rig/ -o x.tess --camera-spacing far", {"--camera-spacing", "far"});
    EXPECT_FALSE(fs::exists(at("x.tess")));
}

TEST_F(EncodeVerb, HoldsPicturesWithinItsMemory) {
    spit(at("large.gray"), "");
    fs::resize_file(at("large.gray"), 8 << 20); // a hole
    succeed("encode large.gray --size 2048x1024x2x2 --effort 0 -q -o large.tess");
    fail(5, "decode large.tess -o large.png --threads 1 --memory 109M",
         {"large.png", "held in memory", "--memory"});
    EXPECT_FALSE(fs::exists(at("large.png")));
    succeed("decode large.tess -q -o large.png");
}

} // namespace
