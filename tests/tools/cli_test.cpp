// Tests the built tool as a person or a script uses it: exit codes, messages and JSON.
#include "tests/support/cli_fixture.h"
#include "tests/support/cli_scenes.h"
#include "tests/support/meshes.h"
#include "tools/verbs/command.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>

namespace {

using namespace tessera::test;
using namespace tessera::test::cli_scenes;

class Cli : public CliFixture {};

TEST_F(Cli, PrintsHelpAndVersion) {
    for (const tessera::Verb& each : tessera::all_verbs()) {
        const std::string verb = each.name;
        const Outcome help = run(verb + " --help");
        EXPECT_EQ(help.code, 0);
        EXPECT_NE(help.out.find("Examples:"), std::string::npos) << verb;
        EXPECT_NE(help.out.find("tessera " + verb), std::string::npos);
        EXPECT_EQ(run("help " + verb).out, help.out);
        EXPECT_NE(run("help").out.find(verb), std::string::npos) << run("help").out;
    }
    EXPECT_EQ(run("--help").code, 0);
    EXPECT_NE(run("version").out.find("file format 0.7"), std::string::npos);
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
    fail(1, "bake composed -o x.txt", {"x.txt"});
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
    EXPECT_EQ(encoded.err, ""); // a pipe gets no progress
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

TEST_F(Cli, KeepsWithinItsMemoryOrSaysWhatItNeeds) {
    succeed(small_scene + quick + "-q -o a.tess");
    for (const char* size : {"1G", "512MiB", "300000k", "999999999", "1.5G"})
        succeed(std::string("decode a.tess -q -o a.rgb --threads 1 --memory ") + size);
    for (const char* size : {"", "1.5", "G", "-1", "1GX", "99999999999T"})
        fail(1, "decode a.tess -o b.rgb --memory '" + std::string(size) + "'", {"--memory"});
    for (const char* verb : {"decode a.tess -o b.rgb", "encode a.rgb --size 32x16x9x5 -o b.tess",
                             "bake composed -o b.tess", "compare a.tess a.tess"})
        fail(1, verb + std::string(" --threads 2 --memory 64M"), {"--memory", "at least"});
    EXPECT_EQ(names(), (std::vector<std::string>{"a.rgb", "a.tess"}));
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
    // Pictures keep the description, and .tess files also keep the metadata.
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

TEST_F(Cli, KeepsTheMesh) {
    const std::vector<std::byte> mesh = *encode_mesh(six_charts(2, false), {});
    std::ofstream(at("box.drc"), std::ios::binary)
        .write(reinterpret_cast<const char*>(mesh.data()), static_cast<long>(mesh.size()));
    std::ofstream(at("a.gray")) << std::string(16, 'x');
    succeed("encode a.gray --size 2x2x2x2 -q --mesh box.drc --proxy mesh --surface-map mesh-uv "
            "--angular-map octahedral-mirrored -o a.tess");
    succeed("encode a.tess -q --quality 10 -o b.tess"); // keeps the mesh
    const Json info = json("info b.tess --json");
    EXPECT_EQ(info["description"]["proxy"], "mesh");
    EXPECT_EQ(info["description"]["angular-map"], "octahedral-mirrored");
    EXPECT_EQ(info["mesh"]["triangles"], 48);
    EXPECT_EQ(info["mesh"]["bytes"], mesh.size());
    EXPECT_EQ(info["mesh"]["high"], Json({1, 1, 1}));
    EXPECT_EQ(run("validate b.tess").out, "b.tess: valid\n");
    succeed("encode b.tess -q --proxy sphere-inside:0,0,0,2 -o c.tess");
    EXPECT_EQ(json("info c.tess --json")["description"]["proxy"], "sphere-inside:0,0,0,2");
    EXPECT_FALSE(json("info c.tess --json").contains("mesh"));
    fail(1, "encode c.tess --proxy mesh -o x.tess", {"--proxy mesh", "--mesh"});
    fail(3, "encode a.tess --mesh a.gray -o x.tess", {"a.gray", "Draco"});
    fail(2, "encode a.tess --mesh nowhere.drc -o x.tess", {"nowhere.drc"});
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
    const std::string command = "cd '" + folder_.string() + "' && '" + tool_under_test() +
                                "' info a.tess >/dev/full 2>/dev/null";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2);
}

TEST_F(Cli, CleansUpWhenInterrupted) {
    for (const char* output : {"x.tess", "x.rgb", "x.exr", "views/"}) {
        const Outcome o =
            run(std::string("bake gallery --spp 16 --size 256x128x16x16 -o ") + output,
                "timeout --signal=INT --preserve-status 0.3");
        EXPECT_EQ(o.code, 128 + SIGINT) << output << o.err;
        EXPECT_NE(o.err.find("interrupted"), std::string::npos) << o.err;
        // A journal may stay (resume_test.cpp). A command that is ended after one second does not
        // mention it.
        const bool said = o.err.find("--resume continues") != std::string::npos;
        if (said || !names().empty()) {
            EXPECT_EQ(names(), std::vector<std::string>{"x.tess.journal"});
        }
        fs::remove_all(at("x.tess.journal"));
    }
}

TEST_F(Cli, DrawsViews) {
    succeed(small_scene + quick + "-q -o a.tess");
    succeed("render a.tess -o v.png --views paper --pixels 16x12 -q");
    succeed("render a.tess -o v.exr --eye 6,2,-8 --look 0,1,0 --fov 30 --pixels 16x12 -q");
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
    fail(1, "render a.tess -o x.png --pixels 99999x1", {"--pixels"});
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
    // Without a driver, or in a build without GPU support, the advice is the same.
    fail(5, "render a.tess -o x.png --via load", {"--via cpu"}, "__EGL_VENDOR_LIBRARY_DIRS=none");
    fs::remove(at("f.rgb"));
    fs::remove(at("f.tess"));
    EXPECT_EQ(names(), before);
}

} // namespace
