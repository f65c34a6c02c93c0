// The tool as a person or a script meets it: the built binary, its exit codes, messages and JSON.
#include "tests/support/cli_fixture.h"
#include "tests/support/efforts.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace {

using namespace tessera::test;
class Cli : public CliFixture {};

const std::string small_scene = "bake composed --size 32x16x9x5 --spp 2 ";
const std::string quick = "--effort " + std::to_string(quick_effort) + " ";

TEST_F(Cli, ExplainsItself) {
    for (const char* verb : {"bake", "encode", "decode", "info", "validate", "compare", "sheet",
                             "render", "bench", "rd", "serve"}) {
        const Outcome help = run(std::string(verb) + " --help");
        EXPECT_EQ(help.code, 0);
        EXPECT_NE(help.out.find("Examples:"), std::string::npos) << verb;
        EXPECT_NE(help.out.find(std::string("tessera ") + verb), std::string::npos);
        EXPECT_EQ(run(std::string("help ") + verb).out, help.out);
        EXPECT_NE(run("help").out.find(verb), std::string::npos) << run("help").out;
    }
    EXPECT_EQ(run("--help").code, 0);
    EXPECT_NE(run("version").out.find("file format 0.2"), std::string::npos);
    EXPECT_EQ(run("--version").out, run("version").out);
    EXPECT_NE(run("bake --list").out.find("composed"), std::string::npos);
}

TEST_F(Cli, ReportsWrongUsage) {
    Outcome o = run("enocde x -o y");
    EXPECT_EQ(o.code, 1);
    EXPECT_NE(o.err.find("tessera: error: unknown verb enocde; did you mean encode?"),
              std::string::npos)
        << o.err;
    EXPECT_EQ(run("").code, 1);
    EXPECT_EQ(run("help enocde").code, 1);
    fail(1, "encode", {"input"});
    fail(1, "encode x.rgb", {"--output"});
    fail(1, "encode x.rgb -o x.tess --quality 0", {"--quality"});
    fail(1, "encode x.rgb -o x.tess --quality abc", {"--quality"});
    fail(1, "encode x.rgb -o x.tess --quality 5 --target-psnr 40", {"--"});
    fail(1, "encode x.rgb -o x.tess --effort 6", {"--effort"});
    fail(1, "encode x.rgb -o x.tess --frobnicate", {"frobnicate"});
    fail(1, "encode x.rgb -o x.png", {"x.png"});
    fail(1, "encode x.rgb -o x.tess", {"x.rgb", "--size"});
    fail(1, "encode x.rgb -o x.tess --size 3x3x3", {"--size", "3x3x3"});
    fail(1, "encode x.rgb -o x.tess --size 1048576x1048576x1048576x1048576", {"2^48"});
    fail(1, "bake nowhere -o x.tess", {"nowhere", "composed"});
    fail(1, "bake composed -o x.jpeg", {"x.jpeg"});
    fail(1, small_scene + "-o x.rgb --quality 3", {".tess"});
    EXPECT_TRUE(names().empty());
}

TEST_F(Cli, BakesEncodesDecodesCompares) {
    succeed(small_scene + "-o a.tess --target-psnr 40 -q " + quick);
    for (const char* name : {"a.rgb", "a.exr", "a_views/"})
        succeed(small_scene + "-q -o " + name);
    const Json same = json("compare a.exr a.rgb --json");
    EXPECT_EQ(same["identical"], true);
    EXPECT_EQ(json("compare a_views a.exr --json")["identical"], true);
    const Json coded = json("compare a.rgb a.tess --json");
    EXPECT_EQ(coded["identical"], false);
    EXPECT_GE(coded["psnr"].get<double>(), 39.9);
    EXPECT_GT(coded["ssim"]["mean"].get<double>(), 0.9);
    EXPECT_EQ(coded["size"], "32x16x9x5");
    for (const char* name : {"b.rgb", "b.exr", "b_views/"}) {
        succeed(std::string("decode a.tess -q -o ") + name);
        EXPECT_EQ(json(std::string("compare a.tess --json --size 32x16x9x5 ") + name)["identical"],
                  true);
    }
    const Outcome encoded = run("encode a_views -o c.tess --quality 50 " + quick);
    EXPECT_EQ(encoded.code, 0) << encoded.err;
    for (const char* word : {"bits per texel", "PSNR", "largest error", "ratio", " s, "})
        EXPECT_NE(encoded.out.find(word), std::string::npos) << encoded.out;
    EXPECT_EQ(encoded.err, ""); // no progress in a pipe
}

TEST_F(Cli, SwitchesCodingTools) {
    succeed(small_scene + "-q -o a.rgb");
    const std::string encode = "encode a.rgb --size 32x16x9x5 -q -o x.tess ";
    // A file says which tools it was made with, so what it decodes to is compared.
    const auto texels = [&](const std::string& tools) {
        succeed(encode + tools);
        succeed("decode x.tess -q -o x.rgb");
        const auto decoded = slurp(at("x.rgb"));
        fs::remove(at("x.rgb"));
        return decoded;
    };
    const std::string all = texels("");
    EXPECT_FALSE(texels("--tools -copies,-rotation") == all);
    EXPECT_FALSE(texels("--tools none") == all);
    EXPECT_FALSE(texels("--tools none,+copies") == texels("--tools=none"));
    EXPECT_TRUE(texels("--tools -copies,+copies") == all); // the last word counts
    EXPECT_TRUE(texels("--tools none --effort 0") == texels("--tools none"));
    succeed(small_scene + "-q -o x.tess --tools none");
    succeed("compare x.tess a.rgb --size 32x16x9x5 --min-psnr 38");
    fail(1, encode + "--tools -copeis",
         {"--tools", "'-copeis'", "did you mean 'copies'", "fitted-tables"});
    fail(1, encode + "--tools +frobnication", {"--tools", "frobnication", "copies, half"});
    fail(1, encode + "--tools copies", {"--tools", "+copies", "-copies"});
    fail(1, encode + "--tools -copies,,+half", {"--tools"});
    fail(1, small_scene + "-o y.tess --tools -copeis", {"did you mean 'copies'"});
    fail(1, small_scene + "-o y.rgb --tools none", {".tess"});
    fail(1, "rd composed -o report --tools -copeis", {"did you mean 'copies'"});
    EXPECT_EQ(names(), (std::vector<std::string>{"a.rgb", "x.rgb", "x.tess"}));
    const std::string rd = "rd a.rgb --size 32x16x9x5 -o report --rivals none --quality 50 "
                           "--efforts 0 --json ";
    const Json without = json(rd + "--tools none"), with = json(rd); // the cache knows them apart
    EXPECT_NE(without["textures"][0]["measurements"][0]["bytes"],
              with["textures"][0]["measurements"][0]["bytes"]);
    EXPECT_NE(without.dump().find("--tools none"), std::string::npos);
    // Of those who compress it is no business, of those who measure it is.
    for (const char* verb : {"encode", "bake"})
        EXPECT_EQ(run(std::string(verb) + " --help").out.find("--tools"), std::string::npos);
    EXPECT_NE(run("rd --help").out.find("--tools"), std::string::npos);
}

TEST_F(Cli, DecodesParts) {
    succeed(small_scene + quick + "-q -o a.tess --quality 60");
    succeed("decode a.tess -q -o whole.rgb");
    succeed("decode a.tess -q -o part.rgb --box 3:31,5:6,:,2:4");
    const std::string whole = slurp(at("whole.rgb")), part = slurp(at("part.rgb"));
    ASSERT_EQ(part.size(), 28u * 1 * 9 * 2 * 3);
    const std::size_t row = 9 * 3, image = 5 * row; // v 5, u 3, t 2 of v, u, t, s
    for (std::size_t u = 0; u < 28; ++u)
        EXPECT_EQ(part.substr(u * 2 * row, 2 * row),
                  whole.substr((5 * 32 + 3 + u) * image + 2 * row, 2 * row));
    for (const char* name : {"part.exr", "part/"}) {
        succeed(std::string("decode a.tess -q --box 3:31,5:6,:,2:4 -o ") + name);
        EXPECT_EQ(json(std::string("compare part.rgb --json ") + name)["identical"], true);
    }
    fail(1, "decode a.tess -o x.rgb --box 3:33,:,:,:", {"--box", "u"});
    fail(1, "decode a.tess -o x.rgb --box 3:4", {"--box"});
    EXPECT_FALSE(fs::exists(at("x.rgb")));
}

TEST_F(Cli, KeepsItsPromises) {
    succeed(small_scene + "-q -o a.rgb");
    const std::string encode = "encode a.rgb --size 32x16x9x5 -q -o x.tess " + quick;
    succeed(encode + "--max-error 0");
    EXPECT_EQ(json("compare a.rgb x.tess --json")["identical"], true);
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

TEST_F(Cli, ComparesAgainstThresholds) {
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

TEST_F(Cli, ComparesASampleAndAgainstASceneBakedAgain) {
    const std::string scene = "bake composed --size 64x32x16x16 --spp 2 --seed 5 -q ";
    succeed(scene + "-o a.tess --effort 1 --quality 40");
    succeed(scene + "-o a.rgb");
    const Json whole = json("compare a.rgb a.tess --no-ssim --json");
    // Samples and seed are those that the file names.
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
    fail(1, "compare a.tess a.rgb --sample 0", {"sample"});
    fail(7, "compare a.tess --bake lamps --sample 0.1", {"half16"});
}

TEST_F(Cli, MasksSayWhichTexelsMatter) {
    succeed(small_scene + "-q -o a.rgb");
    std::string places(32 * 16, '\0');
    for (std::size_t i = 0; i < places.size(); ++i)
        places[i] = i % 32 < 24 ? 'x' : '\0';
    spit(at("m.gray"), places);
    const std::string encode = "encode a.rgb --size 32x16x9x5 " + quick, sides = " --mask-size 32x16x1x1";
    const Outcome coded = run(encode + "-o x.tess --mask m.gray" + sides);
    EXPECT_EQ(coded.code, 0) << coded.err;
    EXPECT_NE(coded.out.find("75.00 % of the texels matter"), std::string::npos) << coded.out;
    succeed(encode + "-q -o plain.tess");
    EXPECT_LT(fs::file_size(at("x.tess")), fs::file_size(at("plain.tess")));
    // The same mask as another kind of texture.
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
    EXPECT_NE(text.out.find("17280 texels matter"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("no SSIM"), std::string::npos) << text.out;
}

TEST_F(Cli, RefusesMasksThatDoNotFit) {
    succeed(small_scene + "-q -o a.rgb");
    spit(at("m.gray"), std::string(32 * 16, 'x'));
    const std::string encode = "encode a.rgb --size 32x16x9x5 -o x.tess --mask ",
                      compare = "compare a.rgb a.rgb --size 32x16x9x5 --mask ";
    for (const std::string& verb : {encode, compare}) {
        fail(2, verb + "missing.gray", {"missing.gray"});
        fail(3, verb + "m.gray", {"m.gray"}); // not of the texture's size
        fail(1, verb + "m.gray --mask-size 16x32x1x1", {"m.gray", "16x32x1x1", "32x16x9x5"});
        fail(1, verb + "m.gray --mask-size 16x32x1", {"--mask-size"});
        fail(1, verb + "m.jpeg", {"m.jpeg"});
    }
    fail(1, "encode a.rgb --size 32x16x9x5 -o x.tess --mask-size 32x16x1x1", {"--mask"});
    fail(1, compare + "m.gray --mask-size 32x16x1x1 --min-ssim 0.5", {"--min-ssim"});
    // One that is loaded has to fit the budget; one byte a texel that is read in place has not.
    const std::uintmax_t texels = 128ull * 64 * 32 * 32;
    for (const auto& [name, channels] : {std::pair("large.gray", 1u), std::pair("large.rgb", 3u)}) {
        spit(at(name), "");
        fs::resize_file(at(name), texels * channels); // a hole
    }
    const std::string large = "encode large.gray --size 128x64x32x32 --effort 0 -q -o y.tess "
                              "--threads 1 --memory 97M --mask ";
    fail(5, large + "large.rgb", {"large.rgb", "memory", "--memory", ".gray"});
    succeed(large + "large.gray");
    EXPECT_FALSE(fs::exists(at("x.tess")));
}

TEST_F(Cli, KeepsWithinItsMemoryOrSaysWhatItNeeds) {
    succeed(small_scene + quick + "-q -o a.tess");
    for (const char* size : {"1G", "512MiB", "300000k", "999999999"})
        succeed(std::string("decode a.tess -q -o a.rgb --threads 1 --memory ") + size);
    for (const char* size : {"", "1.5G", "G", "-1", "1GX", "99999999999T"})
        fail(1, "decode a.tess -o b.rgb --memory '" + std::string(size) + "'", {"--memory"});
    for (const char* verb : {"decode a.tess -o b.rgb", "encode a.rgb --size 32x16x9x5 -o b.tess",
                             "bake composed -o b.tess", "compare a.tess a.tess"})
        fail(1, verb + std::string(" --threads 2 --memory 64M"), {"--memory", "at least"});
    EXPECT_EQ(names(), (std::vector<std::string>{"a.rgb", "a.tess"}));
}

TEST_F(Cli, TakesOddSizes) {
    for (const std::string size : {"1x1x1x1", "7x5x3x2", "33x1x9x1"}) {
        succeed("bake gallery --spp 1 -q -o a.exr --size " + size);
        succeed("encode a.exr -q -o a.tess");
        succeed("validate a.tess -q");
        succeed("decode a.tess -q -o b/");
        EXPECT_EQ(json("compare a.tess b --json")["identical"], true) << size;
    }
}

TEST_F(Cli, HandlesHdr) {
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
    EXPECT_NE(o.out.find("1 NaN replaced by 0, 2 infinities"), std::string::npos) << o.out;
    fail(3, "encode n.gray16f --size 2x2x1x1 -o m.tess --strict", {"n.gray16f"});
    EXPECT_FALSE(fs::exists(at("m.tess")));
}

TEST_F(Cli, DescribesFiles) {
    succeed(small_scene + quick + "-q -o a.tess --seed 7 --meta Author=me --viewing-radius 4,20");
    const Json info = json("info a.tess --json");
    EXPECT_EQ(info["size"], "32x16x9x5");
    EXPECT_EQ(info["metadata"]["Scene"], "composed");
    EXPECT_EQ(info["metadata"]["Samples per texel"], "2");
    EXPECT_EQ(info["metadata"]["Seed"], "7");
    EXPECT_EQ(info["metadata"]["Author"], "me");
    EXPECT_EQ(info["description"]["proxy"], "sphere:0,0,0,3.5");
    EXPECT_EQ(info["description"]["viewing-radius"], "4,20");
    EXPECT_EQ(info["file_bytes"], fs::file_size(at("a.tess")));
    // The description survives a detour through pictures, metadata through .tess.
    succeed("decode a.tess -q -o a.exr");
    succeed("encode a.exr -q -o b.tess --proxy sphere:1,0,0,2");
    EXPECT_EQ(json("info b.tess --json")["description"]["transfer"],
              info["description"]["transfer"]);
    EXPECT_EQ(json("info b.tess --json")["description"]["proxy"], "sphere:1,0,0,2");
    succeed("encode a.tess -q -o c.tess --quality 20");
    EXPECT_EQ(json("info c.tess --json")["metadata"]["Author"], "me");
    fail(1, "encode a.exr -o x.tess --transfer gamma", {"--transfer", "linear"});
    fail(1, "encode a.exr -o x.tess --meta novalue", {"--meta"});
    EXPECT_EQ(run("info a.tess").code, 0);
}

TEST_F(Cli, ValidatesEveryTruncation) {
    succeed("bake composed -q --spp 1 --size 9x7x3x2 -o a.tess --quality 30");
    const std::string good = slurp(at("a.tess"));
    EXPECT_EQ(json("validate a.tess --json")["valid"], true);
    for (std::size_t n = 0; n < good.size(); n += 1 + good.size() / 40) {
        spit(at("t.tess"), good.substr(0, n));
        const Outcome o = run("validate t.tess --json");
        EXPECT_EQ(o.code, 3) << n;
        const Json report = Json::parse(o.out, nullptr, false);
        ASSERT_TRUE(report.is_object()) << o.out;
        EXPECT_FALSE(report["findings"].empty());
        EXPECT_GT(report["findings"][0]["number"].get<int>(), 0);
        fail(3, "info t.tess", {"t.tess"});
        fail(3, "decode t.tess -o t.rgb", {"t.tess"});
    }
    for (std::size_t i = 0; i < good.size(); i += 1 + good.size() / 40) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ 0x40);
        spit(at("t.tess"), bad);
        EXPECT_NE(run("validate t.tess").code, 0) << "byte " << i;
        EXPECT_NE(run("decode t.tess -q -o t.rgb").code, 0) << "byte " << i;
    }
    EXPECT_EQ(names(), (std::vector<std::string>{"a.tess", "t.tess"}));
}

TEST_F(Cli, RefusesBadInput) {
    spit(at("x.rgb"), std::string(629, 'x'));
    fail(3, "encode x.rgb --size 7x5x3x2 -o x.tess", {"x.rgb", "630", "629"});
    fail(2, "encode none.rgb --size 7x5x3x2 -o x.tess", {"none.rgb"});
    fail(2, "encode none.exr -o x.tess", {"none.exr"});
    fail(2, "info none.tess", {"none.tess"});
    spit(at("x.exr"), "not an EXR");
    fail(3, "encode x.exr -o x.tess", {"x.exr"});
    spit(at("y.tess"), "not a Tessera file, however long it may be made to look");
    for (const char* verb : {"info", "validate"})
        fail(3, std::string(verb) + " y.tess", {"y.tess"});
    fail(3, "decode y.tess -o y.rgb", {"y.tess"});
    EXPECT_EQ(names(), (std::vector<std::string>{"x.exr", "x.rgb", "y.tess"}));
}

TEST_F(Cli, LeavesNoPartialFile) {
    succeed(small_scene + quick + "-q -o a.tess");
    const auto before = names();
    fail(2, small_scene + "-o a.tess/x.tess", {"a.tess/x.tess", "not a folder"});
    fail(2, "decode a.tess -o a.tess/x.rgb", {"a.tess/x.rgb", "not a folder"});
    fail(2, "decode a.tess -o a.tess/views/", {"a.tess/views", "not a folder"});
    for (const char* output : {"x.rgb", "x.exr"})
        fail(2, small_scene + "-o " + output, {"x."}, "ulimit -f 4;"); // 2 or 4 kB: a full disk
    const Outcome full = run(small_scene + "-o x.tess --max-error 0", "ulimit -f 4;");
    EXPECT_EQ(full.code, 2);
    EXPECT_FALSE(fs::exists(at("x.tess")));
    EXPECT_EQ(fs::exists(at("x.tess.journal")),
              full.err.find("kept in x.tess.journal") != std::string::npos)
        << full.err;
    fs::remove_all(at("x.tess.journal"));
    fail(2, "decode a.tess -o x.exr", {"x.exr"}, "ulimit -f 4;");
    fs::create_directories(at("folder.tess"));
    fail(1, small_scene + "-o folder.tess/ --quality 5", {".tess"});
    fs::remove(at("folder.tess"));
    fs::create_symlink("/dev/full", at("full.rgb"));
    fail(2, small_scene + "-o full.rgb", {"full.rgb"});
    fs::remove(at("full.rgb"));
    EXPECT_EQ(names(), before);
}

TEST_F(Cli, ReportsFullStandardOutput) {
    succeed(small_scene + quick + "-q -o a.tess");
    const std::string command = "cd '" + folder_.string() + "' && '" + TESSERA_TOOL +
                                "' info a.tess >/dev/full 2>/dev/null";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2);
}

TEST_F(Cli, CleansUpWhenInterrupted) {
    for (const char* output : {"x.tess", "x.rgb", "x.exr", "views/"}) {
        const Outcome o =
            run(std::string("bake gallery --spp 64 --size 256x128x16x16 -o ") + output,
                "timeout --signal=INT --preserve-status 0.5");
        EXPECT_EQ(o.code, 128 + SIGINT) << output << o.err;
        EXPECT_NE(o.err.find("interrupted"), std::string::npos) << o.err;
        const bool kept = o.err.find("--resume goes on") != std::string::npos; // resume_test.cpp
        EXPECT_EQ(names(),
                  kept ? std::vector<std::string>{"x.tess.journal"} : std::vector<std::string>{});
        fs::remove_all(at("x.tess.journal"));
    }
}

TEST_F(Cli, MeasuresRateAndDistortion) {
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

    // Again, and more: what is known is not measured again. No rival is there, and each is named.
    const Outcome again = run(rd + "--quick", "PATH=/nowhere");
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_NE(again.out.find("cached"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("x265:medium: not installed: x265, ffmpeg"), std::string::npos)
        << again.out;
    EXPECT_NE(slurp(at("report") / "index.html").find("install-rivals.sh"), std::string::npos);
    succeed("rd lambert --texture-size 12x8x4x4 --samples 1 -q -o r2 --rivals none --quality 50 "
            "--keep");
    EXPECT_TRUE(fs::exists(at("r2") / "bitstreams" / "lambert_tessera-3_quality-50" /
                           "texture.tess"));
    // Nobody named efforts: two more for the speeds.
    const std::string table = slurp(at("r2") / "rd.csv");
    for (const char* codec : {"tessera:0", "tessera:3", "tessera:5"})
        EXPECT_NE(table.find(codec), std::string::npos) << codec << table;
    EXPECT_EQ(slurp(at("report") / "rd.csv").find("tessera:5"), std::string::npos);
}

TEST_F(Cli, RefusesToMeasureNonsense) {
    succeed("bake composed --size 8x4x3x2 --spp 1 -q -o a.tess");
    fail(1, "rd a.tess -o x --rivals h266", {"h266", "x265"});
    fail(1, "rd a.tess", {"--output"});
    fail(1, "rd nowhere -o x", {"nowhere"});
    fail(1, "rd a.tess -o x -q --rivals none --psnr 38 --anchor avif", {"avif"});
    fail(2, "rd a.tess -o a.tess/x", {"a.tess/x"});
}

// A rival that takes for ever is what is interrupted.
TEST_F(Cli, GoesOnMeasuringAfterAnInterrupt) {
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
    EXPECT_NE(o.err.find("interrupted; the same command goes on"), std::string::npos) << o.err;
    EXPECT_FALSE(fs::exists(at("r") / "index.html"));
    rival("exit 9");
    const Outcome again = run(rd, path);
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(again.out.find("[1/5] tessera:0 psnr 34"), again.out.find("[1/5]"));
    EXPECT_NE(again.out.find("cached"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("zfp: exit code 9"), std::string::npos) << again.out;
}

TEST_F(Cli, DrawsSheets) {
    succeed(small_scene + quick + "-q -o a.tess");
    succeed(small_scene + "-q -o a.rgb");
    succeed("sheet a.rgb a.tess -o s.png -q"); // the size of a.rgb is that of a.tess
    EXPECT_EQ(slurp(at("s.png")).substr(1, 3), "PNG");
    succeed("sheet a.tess -o t.png -q --views 1 --angular 0");
    fail(1, "sheet a.tess -o t.jpg", {".png"});
    succeed("bake lamps -q --spp 1 --size 4x3x2x1 -o l.exr");
    succeed("sheet l.exr -o l.png -q");
    fail(7, "sheet a.tess l.exr -o x.png", {});
    fail(7, "compare a.tess l.exr", {"32x16x9x5", "4x3x2x1"});
}

TEST_F(Cli, DrawsViews) {
    succeed(small_scene + quick + "-q -o a.tess");
    succeed("render a.tess -o v.png --views paper --size 16x12 -q");
    succeed("render a.tess -o v.exr --eye 6,2,-8 --look 0,1,0 --fov 30 --size 16x12 -q");
    EXPECT_EQ(names(), (std::vector<std::string>{"a.tess", "v-1.png", "v-2.png", "v-3.png",
                                                 "v-4.png", "v-5.png", "v.exr"}));
    const auto before = names();
    fail(1, "render -o x.png", {".tess", "--scene"});
    fail(1, "render a.tess", {"--output"});
    fail(1, "render a.tess -o x.jpeg", {"x.jpeg"});
    fail(1, "render a.tess -o x.png --eye 1,2", {"--eye", "1,2"});
    fail(1, "render a.tess -o x.png --eye 1,0,0", {"outside"});
    fail(1, "render a.tess -o x.png --look 10,0,0", {"same point"});
    fail(1, "render a.tess -o x.png --fov 180", {"180"});
    fail(1, "render a.tess -o x.png --size 99999x1", {"--size"});
    fail(1, "render a.tess -o x.png --views paper --orbit 3", {"--orbit"});
    fail(1, "render a.tess -o x.png --orbit 0", {"--orbit"});
    fail(1, "render a.tess -o x.png --via magic", {"--via"});
    fail(1, "render a.tess -o x.png --budget 0", {"--budget"});
    fail(1, "render a.tess -o x.png --truth mirror", {"composed"});
    fail(1, "render a.tess -o x.png --truth-spp 4", {"--truth"});
    fail(1, "render a.tess -o x.png --sheet s.jpg", {"s.jpg"});
    fail(2, "render none.tess -o x.png", {"none.tess"});
    fail(2, "render a.tess -o a.tess/x.png", {"a.tess/x.png"});
    spit(at("y.tess"), "not a Tessera file");
    fail(3, "render y.tess -o x.png", {"y.tess"});
    fs::remove(at("y.tess"));
    succeed(small_scene + "-q -o f.rgb");
    succeed("encode f.rgb --size 32x16x9x5 -q -o f.tess");
    fail(5, "render f.tess -o x.png", {"--proxy"});
    // No driver at all, or a build without a GPU: the same advice.
    fail(5, "render a.tess -o x.png --via load", {"--via cpu"}, "__EGL_VENDOR_LIBRARY_DIRS=none");
    fs::remove(at("f.rgb"));
    fs::remove(at("f.tess"));
    EXPECT_EQ(names(), before);
}

TEST_F(Cli, SetsPicturesSideBySide) {
    succeed(small_scene + quick + "-q -o a.tess");
    succeed("render a.tess -o v.png --views paper --size 16x12 -q");
    const Outcome o = run("sheet v-1.png v-2.png v-3.png --columns 2 --middle 10 -o m.png");
    EXPECT_EQ(o.out, "m.png: 44 x 76 pixels\n") << o.err; // gaps of 8, labels of 16
    EXPECT_EQ(run("sheet v-1.png v-2.png v-3.png -o m.png").out, "m.png: 80 x 44 pixels\n");
    succeed("sheet v-1.png --label 'one, two' -o m.png -q");
    fail(1, "sheet -o m.png", {"inputs"});
    fail(1, "sheet v-1.png v-2.png --label one -o m.png", {"1 labels for 2"});
    fail(1, "sheet v-1.png -o m.jpg", {"m.jpg"});
    fail(7, "sheet v-1.png a.tess -o m.png", {"differ"}); // a picture is a texture of one view, too
    fail(1, "sheet a.tess a.tess a.tess -o m.png", {"two textures"});
    fail(2, "sheet none.png -o m.png", {"none.png"});
    spit(at("bad.png"), "no picture");
    fail(3, "sheet bad.png -o m.png", {"bad.png"});
}

#ifndef TESSERA_GPU
TEST_F(Cli, BenchNeedsABuildThatDraws) {
    fail(5, "bench gpu a.tess", {"TESSERA_GPU is off"});
}
#else
// A file of 8 tiles in a small window.
const std::string bench_scene =
    "bake composed --size 64x32x16x16 --spp 1 -q -o a.tess --quality 20 --effort 1";
const std::string bench_a = "bench gpu a.tess --size 48x32 --frames 2 --warm-up 1 ";

TEST_F(Cli, ChecksWhatToBench) {
    fail(1, "bench", {"target"});
    fail(1, "bench cpu a.tess", {"cpu", "gpu"});
    fail(1, "bench gpu", {"file"});
    fail(1, "bench gpu a.rgb", {"a.rgb", ".tess"});
    fail(1, "bench gpu a.tess --skip all", {"--skip"});
    fail(1, "bench gpu a.tess --frames 0", {"--frames"});
    fail(2, "bench gpu none.tess", {"none.tess"});
}

TEST_F(Cli, BenchesTheGpu) {
    if (std::getenv("TESSERA_NO_GPU") != nullptr)
        GTEST_SKIP() << "TESSERA_NO_GPU is set";
    succeed(bench_scene);
    fail(1, bench_a + "--size 48", {"--size"});
    fail(1, bench_a + "--eye 1,0,0", {"sphere"});
    fail(2, bench_a + "--original none.rgb", {"none.rgb"});
    const Json report = json(bench_a + "--budget 8 --json");
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
        // All ways give the same picture, but for how finely the texture unit mixes.
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

TEST_F(Cli, BenchSaysWhatCannotBe) {
    if (std::getenv("TESSERA_NO_GPU") != nullptr)
        GTEST_SKIP() << "TESSERA_NO_GPU is set";
    const std::string scene = "bake composed --size 16x8x8x8 --spp 1 -q ";
    succeed(scene + "-o a.tess --max-error 4");
    succeed(scene + "-o a.rgb");
    const std::string bench = bench_a + "--skip load --skip decode --original a.rgb ";
    const Json report = json(bench + "--budget 1 --json");
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
