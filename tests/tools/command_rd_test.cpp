// The verb rd: its measurements, its report, and continuing after an interrupt.
#include "tests/support/cli_fixture.h"
#include "tests/support/cli_scenes.h"

#include <csignal>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using namespace tessera::test;
using namespace tessera::test::cli_scenes;

class RdVerb : public CliFixture {};

TEST_F(RdVerb, MeasuresRateAndDistortion) {
    succeed("bake composed --size 16x8x5x4 --spp 1 -q -o a.tess");
    const std::string rd = "rd a.tess -o report --psnr 34,38 --efforts 0 ";
    const Outcome first = run(rd + "--rivals exr:dwaa,raw");
    EXPECT_EQ(first.code, 0) << first.err;
    EXPECT_EQ(first.err, "");
    for (const char* words : {"tessera:0 psnr 34", "exr:dwaa", "BD-rate against tessera:0",
                              "Speed against error", "report/index.html", "rendered"})
        EXPECT_NE(first.out.find(words), std::string::npos) << words << first.out;
    for (const char* name : {"index.html", "rd.svg", "rd.csv", "rd.json", "cache"})
        EXPECT_TRUE(fs::exists(at("report") / name)) << name;
    const Json report = Json::parse(slurp(at("report") / "rd.json"), nullptr, false);
    ASSERT_TRUE(report.is_object());
    const Json& rows = report["textures"][0]["measurements"];
    EXPECT_GE(rows.size(), 2u + 4 + 1);
    EXPECT_GT(rows[0]["quality"]["psnr_rendered"].get<double>(), 20);

    // The second run takes known results from the cache. No rival is installed, and it lists each.
    const Outcome again = run(rd + "--quick", "PATH=/nowhere");
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_NE(again.out.find("cached"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("x265:medium: not installed: x265, ffmpeg"), std::string::npos)
        << again.out;
    EXPECT_NE(slurp(at("report") / "index.html").find("install-rivals.sh"), std::string::npos);
    succeed("rd lambert --size 12x8x4x4 --spp 1 -q -o r2 --rivals none --quality 50 "
            "--keep");
    EXPECT_TRUE(
        fs::exists(at("r2") / "bitstreams" / "lambert_tessera-3_quality-50" / "texture.tess"));
    // Without --efforts, two more efforts are measured for the table of speeds.
    const std::string table = slurp(at("r2") / "rd.csv");
    for (const char* codec : {"tessera:0", "tessera:3", "tessera:4"})
        EXPECT_NE(table.find(codec), std::string::npos) << codec << table;
    EXPECT_EQ(slurp(at("report") / "rd.csv").find("tessera:4"), std::string::npos);
}

TEST_F(RdVerb, ComparesPictures) {
    succeed("bake composed --size 16x16x1x1 --spp 1 -q -o a.rgb");
    // --rivals replaces the rivals of --pictures, but not its efforts and qualities.
    succeed("rd a.rgb --size 16x16x1x1 --pictures -q -o r --rivals none");
    const std::string table = slurp(at("r") / "rd.csv");
    for (const char* quality : {"40", "48", "56", "64", "72", "78"})
        EXPECT_NE(table.find(",quality " + std::string(quality) + ","), std::string::npos)
            << quality << table;
    EXPECT_NE(table.find("tessera:4"), std::string::npos) << table;
    EXPECT_EQ(table.find("tessera:3"), std::string::npos) << table;
    succeed("bake composed --size 8x4x3x2 --spp 1 -q -o b.tess");
    fail(1, "rd b.tess --pictures -q -o x", {"b.tess", "--pictures", "one view", "3x2"});
    // No picture codec is installed, so BD-rates refer to Tessera itself.
    const Outcome o =
        run("rd a.rgb --size 16x16x1x1 --pictures -o y --efforts 0 --quality 50", "PATH=/nowhere");
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_NE(o.out.find("jxl: not installed: cjxl, djxl"), std::string::npos) << o.out;
}

TEST_F(RdVerb, RejectsBadArguments) {
    succeed("bake composed --size 8x4x3x2 --spp 1 -q -o a.tess");
    fail(1, "rd a.tess -o x --rivals h266", {"h266", "x265"});
    fail(1, "rd a.tess", {"--output"});
    fail(1, "rd nowhere -o x", {"nowhere"});
    fail(1, "rd a.tess -o x -q --rivals none --psnr 38 --anchor avif", {"avif"});
    fail(2, "rd a.tess -o a.tess/x", {"a.tess/x"});
}

// The interrupt arrives while a rival runs that never ends.
TEST_F(RdVerb, ContinuesAfterAnInterrupt) {
    succeed("bake composed --size 8x4x3x2 --spp 1 -q -o a.rgb");
    fs::create_directory(at("bin"));
    const auto rival = [&](const std::string& work) {
        spit(at("bin") / "zfp", "#!/bin/sh\n[ $# = 0 ] && echo v1.0 || " + work + "\n");
        fs::permissions(at("bin") / "zfp", fs::perms::owner_all);
    };
    const std::string rd = "rd a.rgb --size 8x4x3x2 -o r --rivals zfp:rate --psnr 34 --efforts 0";
    rival("/bin/sleep 60");
    const std::string path = "PATH=" + at("bin").string() + ":$PATH ";
    const Outcome o = run(rd, path + "timeout --signal=INT --preserve-status 2");
    EXPECT_EQ(o.code, 128 + SIGINT) << o.err;
    EXPECT_NE(o.err.find("interrupted; run the same command again to continue"), std::string::npos)
        << o.err;
    EXPECT_FALSE(fs::exists(at("r") / "index.html"));
    rival("exit 9");
    const Outcome again = run(rd, path);
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(again.out.find("[1/5] tessera:0 psnr 34"), again.out.find("[1/5]"));
    EXPECT_NE(again.out.find("cached"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("zfp: exit code 9"), std::string::npos) << again.out;
}

} // namespace
