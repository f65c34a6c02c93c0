// Tests the errors for wrong usage: they come before any work and name options as they were typed.
#include "tests/support/cli_fixture.h"
#include "tools/verbs/command.h"

#include <sstream>

namespace {

using namespace tessera::test;

class CliUsage : public CliFixture {
protected:
    // Writes raw texels directly, without running the tool.
    void make_raw(const std::string& name, std::size_t bytes) const {
        std::string texels(bytes, '\0');
        for (std::size_t i = 0; i < bytes; ++i)
            texels[i] = static_cast<char>(i * 7 % 101);
        spit(at(name), texels);
    }
};

const std::string plain_scene = "bake composed --size 16x8x4x4 --spp 1 ";
const std::string usage_scene = plain_scene + "--effort 0 ";

TEST_F(CliUsage, UnknownOptionsSuggestTheNearest) {
    fail(1, "encode x.rgb --qualty 40", {"unknown option --qualty; did you mean --quality?"});
    fail(1, "encode x.rgb -o x.tess --qualty=40",
         {"unknown option --qualty; did you mean --quality?"});
    fail(1, "encode x.rgb -o x.tess 40 --thread 2",
         {"unknown option --thread; did you mean --threads?"});
    fail(1, "encode x.rgb -o x.tess --psnr 40", {"did you mean --target-psnr?"});
    fail(1, "encode x.rgb -o x.tess --target 40",
         {"did you mean --target-psnr, --target-bpt or --target-bytes?"});
    fail(1, "decode x.tess -o x.rgb --quality 40",
         {"unknown option --quality; it belongs to bake, fit, encode and rd",
          "tessera decode --help"});
    fail(1, "info x.tess --jsn", {"did you mean --json?"});
    const Outcome far = run("encode x.rgb -o x.tess --frobnicate");
    EXPECT_NE(far.err.find("unknown option --frobnicate (see"), std::string::npos) << far.err;
    fail(1, "encode x.rgb y.rgb -o x.tess", {"'y.rgb' is one argument too many"});
    for (const auto& [typed, meant] :
         {std::pair("enocde", "encode"), std::pair("inf", "info"), std::pair("valid", "validate"),
          std::pair("comp", "compare")})
        EXPECT_NE(
            run(std::string(typed) + " x")
                .err.find(std::string("unknown verb ") + typed + "; did you mean " + meant + "?"),
            std::string::npos)
            << run(std::string(typed) + " x").err;
    EXPECT_EQ(run("frobnicate x").err.find("did you mean"), std::string::npos);
    EXPECT_TRUE(names().empty());
}

TEST_F(CliUsage, UnknownValuesSuggestTheNearest) {
    succeed(usage_scene + "-q -o a.tess");
    const auto before = names();
    for (const char* scene :
         {"bake compsed -o x.tess", "bake compsed -o x.tess --proxy mesh",
          "render --scene compsed -o x.png", "render a.tess -o x.png --truth compsed",
          "rd compsed -o report", "rd --views compsed -o report", "compare a.tess --bake compsed"})
        fail(1, scene, {"compsed", "; did you mean composed?"});
    fail(1, "shaders -o x --dialect vulcan",
         {"--dialect: 'vulcan' is not one of: glsl, es, vulkan, hlsl, msl, wgsl; "
          "did you mean vulkan?"});
    fail(1, "render a.tess -o x.png --via lod", {"--via", "; did you mean load?"});
    fail(1, "rd a.tess -o report --rivals x266", {"'x266'", "; did you mean x265"});
    fail(1, usage_scene + "-o x.tess --transfer srbg", {"--transfer: ", "; did you mean srgb?"});
    EXPECT_EQ(names(), before);
}

TEST_F(CliUsage, LinesHaveNoTrailingSpaces) {
    succeed(usage_scene + "-q -o a.tess --layers");
    const std::string text = run("info a.tess").out;
    EXPECT_NE(text.find("levels\n"), std::string::npos) << text;
    EXPECT_EQ(text.find(" \n"), std::string::npos) << text;
}

TEST_F(CliUsage, QuietTakesNoQuality) {
    for (const char* words :
         {"x.rgb -o x.tess -q 50", "-q 50 x.rgb -o x.tess", "x.rgb -o x.tess -q50"})
        fail(1, std::string("encode ") + words,
             {"-q is --quiet and takes no number; did you mean --quality 50?"});
    make_raw("x.rgb", 4 * 3 * 2 * 2 * 3);
    succeed("encode -q x.rgb --size 4x3x2x2 -o x.tess --effort 0");
}

TEST_F(CliUsage, SizesAcceptUnitsAndReportTheirRange) {
    make_raw("x.rgb", 16 * 8 * 4 * 4 * 3);
    const std::string encode = "encode x.rgb --size 16x8x4x4 --effort 0 -q -o x.tess ";
    for (const auto& [text, bytes] :
         {std::pair("2k", 2048), std::pair("3K", 3072), std::pair("2KiB", 2048),
          std::pair("4000", 4000), std::pair("2.5k", 2560)}) {
        succeed(encode + "--target-bytes " + text);
        EXPECT_LE(fs::file_size(at("x.tess")), static_cast<std::uintmax_t>(bytes));
        const std::string with_unit = slurp(at("x.tess"));
        succeed(encode + "--target-bytes " + std::to_string(bytes));
        EXPECT_EQ(slurp(at("x.tess")) == with_unit, true) << text;
    }
    succeed(encode + "--target-bytes 1G");
    for (const char* text :
         {"20q", "k", "1.5", "1.k", ".5k", "1.5B", "-5", "0", "99999999999999999999", "9999T"}) {
        const Outcome o = run(encode + "--target-bytes " + text);
        EXPECT_EQ(o.code, 1) << text;
        EXPECT_NE(o.err.find("--target-bytes: '" + std::string(text) + "' is not a size"),
                  std::string::npos)
            << o.err;
        EXPECT_LT(o.err.size(), 200u) << o.err; // does not print a number of 309 digits
    }
    fail(1, encode + "--target-bytes 9999T", {"from 1 to 1024T bytes"});
    for (const char* text : {"0", "-1", "1e9", "much", "nan"}) {
        const Outcome o = run(encode + "--target-bpt " + text);
        EXPECT_NE(o.err.find("--target-bpt: '" + std::string(text) +
                             "' is not a number from 1e-06 to 1000"),
                  std::string::npos)
            << o.err;
    }
    fail(1, encode + "--quality 101", {"--quality: '101' is not a number from 1 to 100"});
    fail(1, "decode x.tess -o y.rgb --memory 1Q", {"--memory: '1Q' is not a size such as"});
    for (const char* budget : {"1Q", "0", "2T", "", "512"})
        fail(1, std::string("render x.tess -o x.png --budget '") + budget + "'",
             {"--budget", "512M"});
    EXPECT_EQ(names(), (std::vector<std::string>{"x.rgb", "x.tess"}));
}

TEST_F(CliUsage, BudgetsAcceptUnits) {
    succeed(usage_scene + "-q -o a.tess");
    for (const char* budget : {"64M", "1g", "1048576"})
        succeed(std::string("render a.tess -o v.png --pixels 8x6 -q --budget ") + budget);
}

TEST_F(CliUsage, WrongOptionsFailBeforeAnyWork) {
    make_raw("x.rgb", 32 * 16 * 8 * 8 * 3);
    spit(at("m.gray"), std::string(16, 'x'));
    const std::string encode = "encode x.rgb --size 32x16x8x8 --effort 0 ";
    const std::string bake = "bake composed --size 512x256x32x32 --spp 64 "; // would take hours
    for (const std::string& verb : {encode, bake}) {
        const auto refused = [&](const std::string& options,
                                 const std::vector<std::string>& words) {
            fail(1, verb + "-o new/x.tess " + options, words);
            EXPECT_EQ(run(verb + "-o new/x.tess " + options).err.find("resum"), std::string::npos);
            EXPECT_EQ(names(), (std::vector<std::string>{"m.gray", "x.rgb"})) << verb << options;
        };
        refused("--alpha straight", {"--alpha straight", "2 or 4 channels", "has 3"});
        refused("--target-bytes 100", {"--target-bytes: ", "100"});
        refused("--target-bpt 0.0000011", {"--target-bpt: "});
        refused("--max-error 256", {"--max-error", "0 to 255", "unorm8"});
        refused("--max-error 1.5", {"--max-error", "whole number"});
        refused("--max-error -1", {"--max-error: '-1' is not a number from 0 to 65535"});
        refused("--meta Author", {"--meta: 'Author' is not key=value"});
        refused("--meta =x", {"--meta"});
        refused("--meta tessera:rate=x", {"--meta", "tessera:rate"});
        refused("--meta 'a=\xff'", {"UTF-8"});
        refused("--tile 257x1x1x1", {"--tile", "256"});
        refused("--tile 64x64x32x32", {"--tile", "393216"});
        refused("--tile 64x64x8x8 --max-error 1", {"64x64x8x8", "65536"});
        refused("--tile 8x8", {"--tile", "'8x8'"});
        refused("--transfer gamma", {"--transfer", "linear"});
        refused("--quality 5 --target-psnr 40", {"--quality and --target-psnr: only one"});
        refused("--memory 1M", {"--memory"});
    }
    fail(1, encode + "-o new/x.tess --mask m.gray --mask-size 4x4x1x1", {"m.gray", "4x4x1x1"});
    fail(3, encode + "-o new/x.tess --mask m.gray", {"m.gray"});
    EXPECT_EQ(names(), (std::vector<std::string>{"m.gray", "x.rgb"}));
}

TEST_F(CliUsage, PlainOutputsRefuseOptionsThatTheyCannotStore) {
    const std::string bake = "bake composed --size 512x256x32x32 --spp 64 "; // would take hours
    for (const char* option :
         {"--quality 40", "--target-bytes 9k", "--effort 3", "--lossless", "--tile 8x8x8x8",
          "--layers", "--no-verify", "--strict", "--resume", "--meta a=b"}) {
        const std::string name = std::string(option).substr(0, std::string(option).find(' '));
        for (const char* output : {"x.exr", "x.rgb", "views/"})
            fail(1, bake + "-o " + output + " " + option, {name + ": needs a .tess output"});
    }
    fail(1, bake + "-o x.rgb --transfer linear", {"--transfer: ", "x.rgb"});
    fail(1, bake + "-o x.rgb --viewing-radius 4,9", {"--viewing-radius: ", "x.rgb"});
    fail(1, bake + "-o x.rgb --proxy none", {"--proxy: ", "x.rgb"});
    EXPECT_TRUE(names().empty());
    succeed(plain_scene + "-q -o x.exr --transfer linear --viewing-radius 4,9");
    succeed("encode x.exr --effort 0 -q -o x.tess");
    const Json description = json("info x.tess --json")["description"];
    EXPECT_EQ(description["transfer"], "linear");
    EXPECT_EQ(description["viewing-radius"], "4,9");
}

// The smallest size is known only after coding. The journal is then removed, because resuming could
// not do better.
TEST_F(CliUsage, ATargetThatIsMissedLeavesNoJournal) {
    succeed("bake composed --size 32x16x8x8 --spp 1 -q -o x.rgb");
    // Larger than a file of background only, so that checking the options cannot detect it.
    fail(1, "encode x.rgb --size 32x16x8x8 --effort 0 -o x.tess --target-bytes 128",
         {"--target-bytes: the target cannot be met", "smallest file of this texture has about"});
    EXPECT_EQ(names(), (std::vector<std::string>{"x.rgb"}));
}

TEST_F(CliUsage, MessagesNameOptionsAsTheyAreTyped) {
    succeed(usage_scene + "-q -o a.tess --layers");
    const std::string whole = slurp(at("a.tess"));
    spit(at("part.tess"), whole.substr(0, whole.size() - 100));
    for (const char* verb :
         {"decode part.tess -o x.rgb", "compare part.tess a.tess", "compare a.tess part.tess",
          "render part.tess -o x.png", "info part.tess", "sheet part.tess -o x.png",
          "sheet a.tess part.tess -o x.png"})
        fail(3, verb, {"cut off", "; --allow-partial reads the part that is present"});
    EXPECT_NE(run("validate part.tess").err.find("--allow-partial"), std::string::npos);
    succeed("info part.tess --allow-partial");
    EXPECT_EQ(json("info part.tess --allow-partial --json")["received_bytes"], whole.size() - 100);
    EXPECT_FALSE(json("info a.tess --json").contains("received_bytes"));
    succeed("sheet part.tess -q -o x.png --allow-partial");
    succeed("decode part.tess -o x.rgb -q --allow-partial");
    spit(at("part.tess"), whole.substr(0, 200)); // without its index the file cannot be read
    EXPECT_EQ(run("decode part.tess -o x.rgb").err.find("allow"), std::string::npos);
}

TEST_F(CliUsage, ParentFoldersOfOutputsAreCreated) {
    succeed(usage_scene + "-q -o new/bake/a.tess");
    succeed(plain_scene + "-q -o raw/bake/a.rgb");
    succeed("encode raw/bake/a.rgb --size 16x8x4x4 --effort 0 -q -o new/encode/a.tess");
    succeed("decode new/bake/a.tess -q -o views/deep/sub/");
    EXPECT_TRUE(fs::exists(at("views/deep/sub/view_t000_s000.png")));
    for (const char* name : {"x/y/a.rgb", "x/z/a.exr"})
        succeed(std::string("decode new/bake/a.tess -q -o ") + name);
    EXPECT_EQ(json("compare new/bake/a.tess x/z/a.exr --json")["identical"], true);
    succeed("sheet new/bake/a.tess -q -o sheets/s.png");
    succeed("render new/bake/a.tess -q --pixels 8x6 -o views/v/v.png --sheet views/w/s.png");
    succeed("render new/bake/a.tess -q --pixels 8x6 -o views/e/v.exr");
    for (const char* name : {"sheets/s.png", "views/v/v.png", "views/w/s.png", "views/e/v.exr"})
        EXPECT_TRUE(fs::exists(at(name))) << name;
}

TEST_F(CliUsage, HelpIsCompleteWithoutThePages) {
    for (const tessera::Verb& each : tessera::all_verbs()) {
        const std::string verb = each.name, help = run(verb + " --help").out;
        std::istringstream lines(help);
        for (std::string line; std::getline(lines, line);)
            EXPECT_LE(line.size(), 100u) << verb << ": " << line;
        for (const char* words : {"Examples:", "Exit codes: 0 success, 1 usage"})
            EXPECT_NE(help.find(words), std::string::npos) << verb << help;
        EXPECT_EQ(help.find(".md"), help.find(".md,")) << help; // rd may mention its own .md output
    }
    const std::string help = run("help").out;
    for (const char* words : {"U x V points", "standard input", "powers of 1024", "--type"})
        EXPECT_NE(help.find(words), std::string::npos) << words << help;
    for (const char* verb : {"bake", "encode", "decode"})
        EXPECT_NE(run(std::string("help ") + verb).out.find("--json"), std::string::npos);
}

} // namespace
