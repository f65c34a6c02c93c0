// Tests the JSON of bake, encode and decode, and the encoding options that a file records.
#include "tests/support/cli_fixture.h"

#include <sstream>

namespace {

using namespace tessera::test;
class CliJson : public CliFixture {};

const std::string json_scene = "bake composed --size 16x8x4x3 --spp 1 ";

TEST_F(CliJson, EncodeSaysWhatItAchieved) {
    succeed(json_scene + "-q -o a.rgb");
    const std::string encode = "encode a.rgb --size 16x8x4x3 --effort 0 --json -o x.tess ";
    const Json at_quality = json(encode + "--quality 60");
    EXPECT_EQ(at_quality["output"], "x.tess");
    EXPECT_EQ(at_quality["input"], "a.rgb");
    EXPECT_EQ(at_quality["size"], "16x8x4x3");
    EXPECT_EQ(at_quality["bytes"], fs::file_size(at("x.tess")));
    EXPECT_EQ(at_quality["raw_bytes"], 16 * 8 * 4 * 3 * 3);
    EXPECT_DOUBLE_EQ(at_quality["bits_per_texel"].get<double>(),
                     static_cast<double>(fs::file_size(at("x.tess"))) * 8 / (16 * 8 * 4 * 3));
    EXPECT_NEAR(at_quality["psnr"].get<double>(),
                json("compare a.rgb x.tess --json")["psnr"].get<double>(), 1e-9);
    EXPECT_EQ(at_quality["max_error"], json("compare a.rgb x.tess --json")["max_error"]);
    EXPECT_EQ(at_quality["rate"], (Json{{"kind", "quality"}, {"value", 60.0}}));
    EXPECT_EQ(at_quality["effort"], 0);
    EXPECT_EQ(at_quality["passes"], 1);
    EXPECT_EQ(at_quality["target_met"], true);
    EXPECT_EQ(at_quality["lossless"], false);
    EXPECT_GT(at_quality["seconds"].get<double>(), 0);
    const Json lossless = json(encode + "--max-error 0");
    EXPECT_EQ(lossless["lossless"], true);
    EXPECT_TRUE(lossless["psnr"].is_null());
    const Json beyond =
        json(encode + "--target-psnr 110 --lossless-fallback"); // no step reaches it
    EXPECT_EQ(beyond["target_met"], true);
    EXPECT_EQ(beyond["lossless"], true);
    EXPECT_NE(beyond["note"], "");
    EXPECT_EQ(json(encode + "--target-bytes 2000")["target_met"], true);
    const Json levels = json(encode + "--layers")["levels"];
    ASSERT_GE(levels.size(), 1u);
    EXPECT_GT(levels[0]["bytes"].get<int>(), 0);
    spit(at("m.gray"), std::string(16 * 8 / 2, 'x') + std::string(16 * 8 / 2, '\0'));
    EXPECT_EQ(json(encode + "--mask m.gray --mask-size 16x8x1x1")["texels_that_matter"],
              16 * 8 * 4 * 3 / 2);
}

TEST_F(CliJson, BakeAndDecodeSayWhatTheyWrote) {
    const Json baked = json(json_scene + "--effort 0 --json --seed 3 -o x.tess");
    EXPECT_EQ(baked["scene"], "composed");
    EXPECT_EQ(baked["seed"], 3);
    EXPECT_EQ(baked["samples_per_texel"], 1);
    EXPECT_EQ(baked["bytes"], fs::file_size(at("x.tess")));
    const Json plain = json(json_scene + "--json -o x.exr");
    EXPECT_EQ(plain["raw_bytes"], 16 * 8 * 4 * 3 * 3);
    EXPECT_EQ(plain["output"], "x.exr");

    const Json decoded = json("decode x.tess --json -o x.rgb --box 2:5,:,:,1:2");
    EXPECT_EQ(decoded["output"], "x.rgb");
    EXPECT_EQ(decoded["input"], "x.tess");
    EXPECT_EQ(decoded["size"], "3x8x4x1");
    EXPECT_EQ(decoded["raw_bytes"], fs::file_size(at("x.rgb")));
    EXPECT_EQ(decoded["filled"]["missing_tiles"], 0);
    EXPECT_GE(decoded["seconds"].get<double>(), 0);
    succeed(json_scene + "--effort 0 -q -o l.tess --layers --tile 8x8x4x3");
    const std::string whole = slurp(at("l.tess"));
    spit(at("part.tess"), whole.substr(0, whole.size() - 200));
    const Json part = json("decode part.tess --allow-partial --json -o x.rgb");
    EXPECT_EQ(part["filled"]["received_bytes"], whole.size() - 200);
    EXPECT_GT(part["filled"]["missing_tiles"].get<int>(), 0);
    const Outcome failed = run("decode part.tess --json -o x.rgb");
    EXPECT_EQ(failed.code, 3);
    EXPECT_EQ(failed.out, "");
}

TEST_F(CliJson, AFileSaysHowItWasMade) {
    // Smaller files do not say it.
    succeed("bake composed --size 32x32x9x5 --spp 1 --effort 0 -q -o x.tess "
            "--target-psnr 53.123456789");
    const Json info = json("info x.tess --json");
    EXPECT_EQ(info["metadata"]["tessera:rate"], "psnr 53.123456789");
    EXPECT_EQ(info["metadata"]["tessera:effort"], "0");
    const std::string version = run("version").out; // "tessera 0.1.0, file format ..."
    const std::string number = version.substr(8, version.find(',') - 8);
    EXPECT_EQ(info["metadata"]["Software"], "Tessera " + number);
    const std::string text = run("info x.tess").out;
    EXPECT_NE(text.find("Tessera " + number + ", --target-psnr 53.12 --effort 0\n"),
              std::string::npos)
        << text;
    EXPECT_EQ(text.find("tessera:"), std::string::npos) << text;
    // Text output is rounded, JSON is exact.
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.find("bits_per_texel") == 0)
            EXPECT_LE(line.substr(line.find_last_of(' ') + 1).size(), 7u) << line;
    EXPECT_NE(text.find("138240 (138.2 kB)"), std::string::npos) << text;
    EXPECT_DOUBLE_EQ(info["bits_per_texel"].get<double>(),
                     static_cast<double>(fs::file_size(at("x.tess"))) * 8 / (32 * 32 * 9 * 5));
    // Encoding again replaces the recorded options.
    succeed("encode x.tess -q -o y.tess --quality 90 --effort 1");
    const Json again = json("info y.tess --json")["metadata"];
    EXPECT_EQ(again["tessera:rate"], "quality 90");
    EXPECT_EQ(again["tessera:effort"], "1");
    EXPECT_EQ(again["Scene"], "composed");
    EXPECT_FALSE(again.contains("tessera:tools"));
    succeed("encode y.tess -q -o z.tess --quality 50 --effort 1");
    // Neither the name nor the number of threads changes the bytes.
    succeed("encode y.tess -q -o elsewhere/z.tess --quality 50 --effort 1 --threads 3");
    EXPECT_EQ(slurp(at("z.tess")) == slurp(at("elsewhere/z.tess")), true);
}

} // namespace
