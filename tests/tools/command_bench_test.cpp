#include "tests/support/cli_fixture.h"
#include "tests/support/cli_scenes.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using namespace tessera::test;
using namespace tessera::test::cli_scenes;

class BenchVerb : public CliFixture {};

#ifndef TESSERA_GPU
TEST_F(BenchVerb, BenchNeedsABuildWithGpuSupport) {
    fail(5, "bench gpu a.tess", {"TESSERA_GPU is off"});
}
#else
// A file with 8 tiles, drawn in a small window.
const std::string bench_scene =
    "bake composed --size 64x32x16x16 --spp 1 -q -o a.tess --quality 20 --effort 1";
const std::string bench_a = "bench gpu a.tess --pixels 48x32 --frames 2 --warm-up 1 ";

TEST_F(BenchVerb, ChecksWhatToBench) {
    fail(1, "bench", {"target"});
    fail(1, "bench cpu a.tess", {"cpu", "gpu"});
    fail(1, "bench gpu", {"file"});
    fail(1, "bench gpu a.rgb", {"a.rgb", ".tess"});
    fail(1, "bench gpu a.tess --skip all", {"--skip"});
    fail(1, "bench gpu a.tess --frames 0", {"--frames"});
    fail(2, "bench gpu none.tess", {"none.tess"});
}

TEST_F(BenchVerb, BenchesTheGpu) {
    if (std::getenv("TESSERA_NO_GPU") != nullptr)
        GTEST_SKIP() << "TESSERA_NO_GPU is set";
    succeed(bench_scene);
    fail(1, bench_a + "--pixels 48", {"--pixels"});
    fail(1, bench_a + "--eye 1,0,0", {"sphere"});
    fail(2, bench_a + "--original none.rgb", {"none.rgb"});
    const Json report = json(bench_a + "--budget 8M --json");
    EXPECT_EQ(report["tiles"], 8);
    EXPECT_EQ(report["width"], 48);
    std::vector<std::string> rows;
    for (const Json& row : report["rows"]) {
        const std::string name = row["via"].get<std::string>() + " " +
                                 row["fetches"].get<std::string>() + " " +
                                 row["frame"].get<std::string>();
        rows.push_back(name);
        ASSERT_FALSE(row.contains("missing")) << row;
        EXPECT_GT(row["device_ms"]["median"].get<double>(), 0) << name;
        EXPECT_GE(row["device_ms"]["p95"], row["device_ms"]["median"]) << name;
        EXPECT_GT(row["wall_ms"]["median"].get<double>(), 0) << name;
        EXPECT_GT(row["bytes"].get<double>(), 0) << name;
        // All ways give the same picture, except for the precision of the texture unit's filter.
        const bool filtered = name.find("filtered") != std::string::npos;
        EXPECT_TRUE(row["same_picture"] == true || (filtered && row["psnr"] > 50.0)) << row;
    }
    EXPECT_EQ(rows, (std::vector<std::string>{
                        "raw 16 steady", "raw 4 filtered steady", "load 16 steady",
                        "load 4 filtered steady", "feedback 16 cold", "feedback 16 steady",
                        "feedback 4 filtered cold", "feedback 4 filtered steady"}));
    for (const std::size_t cold : {4u, 6u}) {
        const Json& frame = report["rows"][cold]["tiles_per_frame"];
        EXPECT_GT(frame["decoded"].get<double>(), 0);
        EXPECT_EQ(frame["late"], 0.0);
        EXPECT_LT(report["rows"][cold + 1]["tiles_per_frame"]["decoded"], frame["decoded"]);
        for (const std::size_t row : {cold, cold + 1})
            EXPECT_LE(report["rows"][row]["bytes"].get<double>(), 8 << 20);
    }
    ASSERT_EQ(report["decode"].size(), 3u);
    EXPECT_EQ(report["decode"][0]["what"], "whole file");
    EXPECT_EQ(report["decode"][0]["texels"], 64 * 32 * 16 * 16);
    EXPECT_GT(report["decode"][0]["texels_per_second"].get<double>(), 0);
}

TEST_F(BenchVerb, BenchReportsWhatItCannotMeasure) {
    if (std::getenv("TESSERA_NO_GPU") != nullptr)
        GTEST_SKIP() << "TESSERA_NO_GPU is set";
    const std::string scene = "bake composed --size 16x8x8x8 --spp 1 -q ";
    succeed(scene + "-o a.tess --max-error 4");
    succeed(scene + "-o a.rgb");
    const std::string bench = bench_a + "--skip load --skip decode --original a.rgb ";
    const Json report = json(bench + "--budget 1M --json");
    EXPECT_EQ(report["rows"].size(), 6u);
    EXPECT_EQ(report["decode"].size(), 0u);
    for (const Json& row : report["rows"]) {
        EXPECT_EQ(row.contains("missing"), row["via"] != "raw") << row;
        const std::string missing = row.value("missing", "");
        EXPECT_EQ(missing.find("budget") != std::string::npos, row["via"] == "feedback");
    }
    const Outcome text = run(bench + "--skip feedback");
    EXPECT_EQ(text.code, 0) << text.err;
    for (const char* word : {"16 fetches, of a.rgb", "wall ms"})
        EXPECT_NE(text.out.find(word), std::string::npos) << text.out;
}

#endif

} // namespace
