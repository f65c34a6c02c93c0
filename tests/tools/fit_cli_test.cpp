// tessera fit: from photographs of a model to a texture, measured on photographs that it has not seen.
#include "tests/support/cli_fixture.h"
#include "tests/support/photographs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace tessera::test;

// A cube with sides of 2 around (4, 5, 6), so that the frame of its file matters.
std::string cube_obj() {
    std::string obj;
    for (int i = 0; i < 8; ++i)
        obj += "v " + std::to_string(i & 1 ? 5 : 3) + " " + std::to_string(i & 2 ? 6 : 4) + " " +
               std::to_string(i & 4 ? 7 : 5) + "\n";
    for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"})
        obj += std::string("f ") + face + "\n";
    return obj;
}

class FitCli : public CliFixture {
protected:
    // Writes cube.obj and the cameras, and draws 14 photographs of a texture that `fit` then has to
    // find: colours by place, and a highlight by direction.
    void write_photographs() const {
        spit(at("cube.obj"), cube_obj());
        std::vector<std::string> frames;
        for (int i = 0; i < 14; ++i)
            frames.push_back(
                frame_json("photos/p" + std::to_string(10 + i),
                           matrix_around({4, 5, 6}, 6, 0.9 * i, 0.9 * std::sin(1.7 * i))));
        spit(at("transforms.json"), transforms_json(R"("w":48,"h":48,"fl_x":60,)", frames));
    }
};

TEST_F(FitCli, FindsTheTextureThatExplainsThePhotographs) {
    write_photographs();
    // The first fit has plain pictures: it makes the file that draws the real photographs.
    fs::create_directories(at("photos"));
    for (int i = 0; i < 14; ++i)
        spit(at("photos/p" + std::to_string(10 + i) + ".png"),
             plain_ppm(48, 48, std::string(1, static_cast<char>(60 + 9 * i)) + "\x80\x40"));
    succeed("fit transforms.json --mesh cube.obj -o seen.tess --background black --texels 4000 "
            "--directions 4 --shared-directions 8 --smoothness 1 --no-corrections --quality 90 -q");
    succeed("render seen.tess --cameras transforms.json -o photos --rays 64 -q");
    const Json fit = json("fit transforms.json --mesh cube.obj -o again.tess --texels 4000 "
                          "--directions 4 --shared-directions 8 --quality 85 --hold-out 5 --json");
    EXPECT_GE(fit["photographs"], 11); // of 12; one may be left out
    EXPECT_EQ(fit["background"], "0.000,0.000,0.000");
    EXPECT_GT(fit["held_out"]["psnr"].get<double>(), 28.0);
    EXPECT_EQ(fit["held_out"]["pictures"].size(), 2u);
    EXPECT_EQ(fit["layers"].size(), 3u);
    succeed("validate again.tess -q");
    const Json info = json("info again.tess --json");
    EXPECT_EQ(info["layers"][1]["role"], "shared_difference");
    // The same bytes on another number of threads.
    const std::string options = " --mesh cube.obj --texels 4000 --directions 4 "
                                "--shared-directions 8 --smoothness 1 --quality 85 -q ";
    EXPECT_EQ(run("fit transforms.json" + options + "--threads 1 -o one.tess").code, 0);
    EXPECT_EQ(run("fit transforms.json" + options + "--threads 3 -o three.tess").code, 0);
    EXPECT_EQ(slurp(at("one.tess")), slurp(at("three.tess")));
}

TEST_F(FitCli, RefusesCamerasThatDoNotSeeTheMesh) {
    write_photographs();
    fs::create_directories(at("photos"));
    for (int i = 0; i < 14; ++i)
        spit(at("photos/p" + std::to_string(10 + i) + ".png"), plain_ppm(48, 48, "\x10\x20\x30"));
    std::string far = cube_obj();
    for (std::size_t i = 0; (i = far.find("v ", i)) != far.npos; i += 2)
        far.insert(i + 2, "9");
    spit(at("far.obj"), far);
    fail(1, "fit transforms.json --mesh far.obj -o x.tess", {"no photograph sees the mesh"});
    EXPECT_FALSE(fs::exists(at("x.tess")));
    fail(1, "fit transforms.json --mesh cube.txt -o x.tess", {"cube.txt", "not a"});
    fail(1, "fit transforms.json -o x.tess", {"--mesh MODEL", "--surface"});
    fail(1, "fit transforms.json --mesh cube.obj -o x.tess --lossless --quality 50",
         {"--lossless", "--quality"});
    fail(1, "fit transforms.json --mesh cube.obj -o x.tess --max-error 1.5", {"--max-error"});
    fail(1, "fit transforms.json --mesh cube.obj -o x.tess --resume", {"--resume"});
    fail(1, "fit transforms.json --mesh cube.obj --surface sphere -o x.tess",
         {"--mesh", "--surface"});
    fail(1, "fit transforms.json --mesh cube.obj --focus 3 -o x.tess", {"--focus", "--surface"});
    fail(1, "fit transforms.json --surface sphere --cell 4 -o x.tess", {"--cell", "--mesh"});
    fail(1, "fit transforms.json --surface sphere --radius 9 -o x.tess",
         {"transforms.json", "frame 'photos/p10'", "inside the sphere"});
    fail(1, "fit transforms.json --surface planar -o x.tess", {"transforms.json", "window"});
    fail(1, "fit transforms.json --mesh cube.obj -o x.tess --masks masks",
         {"masks: has no mask of any photograph", "p10.png.png"});
    fail(2, "fit missing.json --mesh cube.obj -o x.tess", {"missing.json"});
}

} // namespace
