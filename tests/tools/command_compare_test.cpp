// Tests the verb compare: figures, thresholds, samples.
#include "tests/support/cli_fixture.h"
#include "tests/support/cli_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using namespace tessera::test;
using namespace tessera::test::cli_scenes;

class CompareVerb : public CliFixture {};

TEST_F(CompareVerb, ComparesAgainstThresholds) {
    spit(at("a.rgb"), std::string(2 * 2 * 2 * 2 * 3, 'a'));
    std::string other = slurp(at("a.rgb"));
    other[7] = 'c';
    spit(at("b.rgb"), other);
    const std::string compare = "compare a.rgb b.rgb --size 2x2x2x2 ";
    succeed(compare + "--min-psnr 40 --max-error 2 --min-ssim 0.5");
    fail(7, compare + "--min-psnr 90", {"b.rgb", "PSNR", "90"});
    fail(7, compare + "--max-error 1", {"largest error 2"});
    fail(7, compare + "--min-ssim 1.1", {"SSIM"});
    succeed("compare a.rgb a.rgb --size 2x2x2x2 --min-psnr 999 --max-error 0");
    const Json missed = json(compare + "--json --max-error 1");
    EXPECT_EQ(missed["passed"], false);
    EXPECT_EQ(missed["max_error"], 2);
    EXPECT_EQ(missed["max_error_at"],
              (Json{{"u", 0}, {"v", 0}, {"s", 0}, {"t", 1}, {"channel", 1}}));
    EXPECT_NEAR(missed["psnr"].get<double>(), 10 * std::log10(255.0 * 255 * 48 / 4), 1e-9);
    spit(at("c.gray"), std::string(16, 'a'));
    fail(7, "compare a.rgb c.gray --size 2x2x2x2", {"channels"});
}

TEST_F(CompareVerb, ComparesASampleAndARebakedScene) {
    const std::string scene = "bake composed --size 64x32x16x16 --spp 2 --seed 5 -q ";
    succeed(scene + "-o a.tess --effort 1 --quality 40");
    succeed(scene + "-o a.rgb");
    const Json whole = json("compare a.rgb a.tess --no-ssim --json");
    // Sample count and seed come from the file's metadata.
    const Json baked = json("compare a.tess --bake composed --sample 1 --json");
    for (const char* figure : {"psnr", "max_error", "differing_samples"})
        EXPECT_EQ(baked[figure], whole[figure]) << figure;
    EXPECT_EQ(baked["sample"]["tiles"], 8);
    EXPECT_EQ(baked["sample"]["of_tiles"], 8);
    EXPECT_FALSE(whole.contains("sample"));
    const std::string part = "compare a.rgb a.tess --json --sample 0.21 --sample-seed ";
    const Json one = json(part + "1"), again = json(part + "1 --threads 1");
    EXPECT_EQ(one["sample"]["tiles"], 2); // rounded up
    EXPECT_EQ(one["sample"]["texels"], 2 * 32 * 32 * 8 * 8);
    EXPECT_EQ(one["psnr"], again["psnr"]);
    EXPECT_NE(one["psnr"], json(part + "2")["psnr"]);
    EXPECT_EQ(json("compare a.tess --bake composed --json --sample 0.21")["psnr"], one["psnr"]);
    EXPECT_NE(json("compare a.tess --bake composed --json --sample 0.21 --seed 6")["psnr"],
              one["psnr"]);
    succeed(scene + "-o v/");
    EXPECT_EQ(json("compare v a.tess --json --sample 0.21")["psnr"], one["psnr"]);
    const Outcome text = run("compare a.tess --bake composed --sample 0.21");
    EXPECT_NE(text.out.find("2 of 8 tiles"), std::string::npos) << text.out;
    fail(7, "compare a.tess --bake composed --sample 0.21 --min-psnr 90", {"a.tess", "PSNR"});
    fail(1, "compare a.tess", {"--bake"});
    fail(1, "compare a.tess a.rgb --bake composed", {"--bake"});
    fail(1, "compare a.tess --bake nowhere", {"nowhere"});
    fail(1, "compare a.tess a.rgb --sample-seed 3", {"--sample"});
    fail(1, "compare a.tess a.rgb --sample 0", {"fraction of tiles"});
    fail(7, "compare a.tess --bake lamps --sample 0.1", {"half16"});
}

// Both folders have samples that half floats cannot hold.
TEST_F(CompareVerb, CountsWarnings) {
    const float values[] = {1e6f, 2, 3, 4};
    for (const char* folder : {"f", "g"}) {
        fs::create_directories(at(folder));
        spit(at(fs::path(folder) / "p1.pfm"),
             "Pf 4 1 -1\n" + std::string(reinterpret_cast<const char*>(values), 16));
    }
    const Outcome o = run("compare f/ g/ -q");
    EXPECT_EQ(o.code, 0);
    EXPECT_EQ(o.err, "tessera compare: warning: samples beyond +-65504, the range of half floats, "
                     "became +-65504 (2 times, first in f/p1.pfm)\n");
    EXPECT_EQ(json("compare f/ g/ --json")["warnings"][0]["count"], 2);
    fail(5, "compare f/ g/ --strict", {"p1.pfm", "beyond +-65504", "--strict"});
}

} // namespace
