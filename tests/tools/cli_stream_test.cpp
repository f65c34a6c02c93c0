// Tests that the file type is detected from the first bytes, whatever the name, and that "-" is
// standard input or output.
#include "tests/support/cli_fixture.h"

namespace {

using namespace tessera::test;

const std::string stream_scene = "bake composed --size 16x8x4x3 --spp 1 --effort 0 -q ";
const std::string raw_words = " --size 16x8x4x3 --type unorm8 --channels 3 ";

class CliStream : public CliFixture {
protected:
    void SetUp() override {
        CliFixture::SetUp();
        succeed(stream_scene + "-o a.tess --max-error 0");
        succeed("decode a.tess -q -o a.rgb");
    }
    bool is_lossless(const std::string& name) const {
        return json("compare a.rgb " + name + " --json --size 16x8x4x3")["identical"] == true;
    }
};

TEST_F(CliStream, TypesAreDetectedFromTheFirstBytes) {
    succeed("decode a.tess -q -o a.exr");
    for (const auto& [name, as] :
         {std::pair("a.tess", "t.bin"), std::pair("a.tess", "t.exr"), std::pair("a.exr", "e.tess"),
          std::pair("a.exr", "e.rgb"), std::pair("a.exr", "noending")}) {
        fs::copy_file(at(name), at(as));
        EXPECT_TRUE(is_lossless(as)) << as;
        succeed(std::string("encode ") + as + " -q -o b.tess --max-error 0 --effort 0");
        EXPECT_TRUE(is_lossless("b.tess")) << as;
    }
    EXPECT_EQ(json("info t.bin --json")["kind"], "tess");
    EXPECT_EQ(json("info e.tess --json")["kind"], "exr");
    succeed("decode t.bin -q -o b.rgb");
    EXPECT_EQ(slurp(at("b.rgb")) == slurp(at("a.rgb")), true);
    succeed("validate t.exr -q");
    succeed("render t.bin -q --pixels 8x6 -o v.png");
    fail(1, "decode e.tess -o b.rgb", {"e.tess", "an EXR picture", "decode reads .tess files"});
    fail(1, "decode a.rgb -o b.rgb", {"a.rgb", "a raw file"});
    fail(2, "decode nothing -o b.rgb", {"nothing"});
    // Raw samples may have any name if size and type are given.
    fs::copy_file(at("a.rgb"), at("samples.dat"));
    EXPECT_TRUE(is_lossless("samples.dat --type unorm8 --channels 3"));
    fail(1, "info samples.dat --size 16x8x4x3", {"samples.dat"});
    fail(1, "info samples.dat", {"samples.dat"});
}

TEST_F(CliStream, ASinglePngIsAViewOrAMosaic) {
    succeed("decode a.tess -q --box :,:,2:3,1:2 -o one.rgb");
    succeed("decode a.tess -q -o views/");
    fs::copy_file(at("views/view_t001_s002.png"), at("view.png"));
    const Json info = json("info view.png --json");
    EXPECT_EQ(info["size"], "16x8x1x1");
    EXPECT_EQ(info["kind"], "picture");
    EXPECT_EQ(json("compare one.rgb view.png --json")["identical"], true);
    succeed("encode view.png -q -o b.tess --max-error 0 --effort 0");
    EXPECT_EQ(json("compare one.rgb b.tess --json")["identical"], true);
    // The same pixels as angular images side by side: x = 4u + s, y = 4v + t.
    EXPECT_EQ(json("info view.png --size 4x2x4x4 --json")["size"], "4x2x4x4");
    succeed("encode view.png --size 4x2x4x4 -q -o m.tess --max-error 0 --effort 0");
    succeed("decode m.tess -q -o m.rgb");
    const std::string picture = slurp(at("one.rgb")), mosaic = slurp(at("m.rgb"));
    ASSERT_EQ(mosaic.size(), picture.size());
    std::size_t differing = 0;
    for (std::size_t v = 0, i = 0; v < 2; ++v)
        for (std::size_t u = 0; u < 4; ++u)
            for (std::size_t t = 0; t < 4; ++t)
                for (std::size_t s = 0; s < 4; ++s, i += 3)
                    differing += mosaic.substr(i, 3) !=
                                 picture.substr(((v * 4 + t) * 16 + u * 4 + s) * 3, 3);
    EXPECT_EQ(differing, 0u);
    fail(1, "info view.png --size 5x2x4x4", {"view.png", "20x8", "16x8"});
    EXPECT_EQ(json("info view.png --type half --json")["type"], "half16");
    spit(at("cut.png"), slurp(at("view.png")).substr(0, 60));
    fail(3, "encode cut.png -o x.tess", {"cut.png"});
    fail(1, "decode a.tess -o x.txt", {"x.txt", "folder/"});
}

TEST_F(CliStream, StandardInputMayHoldAnySingleFile) {
    for (const char* how : {"cat a.tess |", ""}) { // a pipe, and a file
        const std::string input = *how != 0 ? "" : "<a.tess";
        const Outcome info = run("info - --json", how, input);
        EXPECT_EQ(info.code, 0) << info.err;
        EXPECT_EQ(Json::parse(info.out, nullptr, false)["size"], "16x8x4x3");
        for (const char* verb :
             {"validate - -q", "decode - -q -o b.rgb", "compare a.rgb - -q --max-error 0",
              "encode - -q -o b.tess --max-error 0 --effort 0", "render - -q --pixels 8x6 -o v.png",
              "sheet a.rgb - -q -o s.png"}) {
            const Outcome o = run(verb, how, input);
            EXPECT_EQ(o.code, 0) << verb << o.err;
        }
        EXPECT_EQ(slurp(at("b.rgb")) == slurp(at("a.rgb")), true);
        EXPECT_TRUE(is_lossless("b.tess"));
    }
    succeed("decode a.tess -q -o a.exr");
    EXPECT_EQ(run("encode - -q -o b.tess --max-error 0 --effort 0", "cat a.exr |", "").code, 0);
    EXPECT_TRUE(is_lossless("b.tess"));
    EXPECT_EQ(
        run("encode -" + raw_words + "-q -o b.tess --max-error 0 --effort 0", "cat a.rgb |", "")
            .code,
        0);
    EXPECT_TRUE(is_lossless("b.tess"));
    EXPECT_EQ(run("compare - -", "cat a.tess |", "").code, 0); // the same input twice

    const auto refused = [&](int code, const std::string& arguments, const std::string& before,
                             const std::vector<std::string>& words) {
        const Outcome o = run(arguments, before, before.empty() ? "</dev/null" : "");
        EXPECT_EQ(o.code, code) << arguments << o.err;
        for (const std::string& word : words)
            EXPECT_NE(o.err.find(word), std::string::npos) << arguments << o.err;
    };
    refused(1, "encode - -o x.tess", "cat a.rgb |",
            {"standard input", "--size, --type and --channels"});
    refused(1, "info -", "", {"standard input"});
    refused(3, "encode -" + raw_words + "-o x.tess", "head -c 100 a.rgb |",
            {"standard input", "100"});
    refused(3, "decode - -o x.rgb", "head -c 300 a.tess |", {"standard input"});
    refused(1, "decode - -o x.rgb", "cat a.exr |", {"an EXR picture"});
    EXPECT_FALSE(fs::exists(at("x.tess")) || fs::exists(at("x.rgb")));
}

TEST_F(CliStream, StandardOutputTakesFilesAndRawSamples) {
    const std::string encode = "encode a.rgb --size 16x8x4x3 --effort 0 ";
    succeed(encode + "-q -o b.tess");
    const Outcome coded = run(encode + "-o -");
    EXPECT_EQ(coded.code, 0);
    EXPECT_EQ(coded.out == slurp(at("b.tess")), true);                 // same bytes as in a file
    EXPECT_NE(coded.err.find("PSNR"), std::string::npos) << coded.err; // still has the summary
    EXPECT_EQ(run(encode + "-q -o -").err, "");
    const Outcome baked = run(stream_scene + "--max-error 0 -o -");
    EXPECT_EQ(baked.out == slurp(at("a.tess")), true) << baked.err;
    const Outcome decoded = run("decode a.tess -o -");
    EXPECT_EQ(decoded.out == slurp(at("a.rgb")), true);
    EXPECT_NE(decoded.err.find("16x8x4x3"), std::string::npos) << decoded.err;
    succeed("decode a.tess -q -o part.rgb --box 3:9,2:7,1:3,:");
    EXPECT_EQ(run("decode a.tess -q -o - --box 3:9,2:7,1:3,:").out == slurp(at("part.rgb")), true);
    const Outcome piped = run("decode - -q -o -", "cat a.tess |", "");
    EXPECT_EQ(piped.out == slurp(at("a.rgb")), true) << piped.err;

    for (const char* verb : {"decode a.tess", "encode a.rgb --size 16x8x4x3", "bake composed"})
        fail(1, std::string(verb) + " -o - --json", {"--json and -o -"});
    fail(1, encode + "-o - --resume", {"--resume", "journal"});
    EXPECT_EQ(names(), (std::vector<std::string>{"a.rgb", "a.tess", "b.tess", "part.rgb"}));
    const std::string full = "cd '" + folder_.string() + "' && '" + tool_under_test() +
                             "' decode a.tess -q -o - >/dev/full 2>/dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(full.c_str())), 2);
}

} // namespace
