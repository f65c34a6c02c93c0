// tessera fit without a mesh: photographs that `render` has drawn become a sphere or planar views,
// which draw photographs that were kept out.
#include "tests/support/cli_fixture.h"
#include "tests/support/photographs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace tessera::test;

class FitViewsCli : public CliFixture {
protected:
    void write_cameras(const std::string& file, const std::vector<std::string>& matrices,
                       const std::string& lens) const {
        std::vector<std::string> frames;
        for (std::size_t i = 0; i < matrices.size(); ++i)
            frames.push_back(frame_json("photos/p" + std::to_string(10 + i), matrices[i]));
        spit(at(file), transforms_json(R"("w":32,"h":32,)" + lens, frames));
    }
    // The number behind a word of the surface that a fit states.
    static double number_after(const Json& fit, const std::string& word) {
        const std::string text = fit["surface"];
        const std::size_t at = text.find(word);
        EXPECT_NE(at, text.npos) << text;
        return std::stod(text.substr(at + word.size()));
    }
};

TEST_F(FitViewsCli, FindsAPaintedSphere) {
    std::vector<std::string> matrices;
    for (int i = 0; i < 24; ++i)
        matrices.push_back(matrix_around({0, 0, 0}, 12, 2.4 * i, 1.1 * std::sin(1.7 * i)));
    write_cameras("transforms.json", matrices, R"("fl_x":46,)");
    succeed("render --scene lambert --size 64x32x2x2 --spp 4 --rays 4 --cameras transforms.json "
            "-o photos -q");
    const Json fit = json("fit transforms.json --surface sphere -o ball.tess --radius 3.5 "
                          "--directions 2 --texels 16384 --hold-out 6 --smoothness 1 "
                          "--quality 90 --json");
    EXPECT_LT(std::abs(number_after(fit, "around ")), 1e-3);
    EXPECT_GT(fit["held_out"]["psnr"].get<double>(), 25.0);
    EXPECT_EQ(number_after(fit, "focus at the radius "), 3.5); // the paint is on the sphere
    const Json info = json("info ball.tess --json");
    EXPECT_EQ(info["description"]["proxy"].get<std::string>().rfind("sphere:", 0), 0u);
    // The result draws the photographs' own views.
    succeed("render ball.tess --cameras transforms.json -o drawn --rays 4 -q");
    const Json compared = json("compare transforms.json drawn --json");
    EXPECT_GT(compared["psnr"].get<double>(), 25.0);
    // The ball stands before a background of one colour, so its radius can be estimated. The same
    // bytes on any number of threads.
    const std::string options = "fit transforms.json --surface sphere --directions 2 "
                                "--texels 4096 --focus 3 --smoothness 1 --no-corrections --json ";
    const Json one = json(options + "--threads 1 -o one.tess");
    EXPECT_NEAR(number_after(one, "radius "), 3.5, 0.26); // a pixel
    json(options + "--threads 3 -o three.tess");
    EXPECT_EQ(slurp(at("one.tess")), slurp(at("three.tess")));
    // Three cameras do not see the whole ball.
    matrices.resize(3);
    write_cameras("few.json", matrices, R"("fl_x":46,)");
    const std::string few =
        "fit few.json --surface sphere --directions 2 --texels 4096 --radius 3.5 "
        "--focus 3 --smoothness 1 --no-corrections --json ";
    json(few + "-o filled.tess");
    json(few + "--unseen dont-care -o masked.tess");
    EXPECT_NE(slurp(at("masked.tess")), slurp(at("filled.tess")));
}

// A pattern behind the window, as 3x3 views that move by two pixels from camera to camera.
void write_views(const fs::path& folder) {
    fs::create_directories(folder);
    for (int t = 0; t < 3; ++t)
        for (int s = 0; s < 3; ++s) {
            std::string file = "P6\n32 24\n255\n";
            for (int j = 0; j < 24; ++j)
                for (int i = 0; i < 32; ++i) {
                    const double x = i - 2 * s, y = j - 2 * t;
                    for (const double phase : {0.0, 1.0, 2.0})
                        file += static_cast<char>(std::lround(128 + 60 * std::sin(0.9 * x + phase) *
                                                                        std::cos(0.7 * y - phase)));
                }
            spit(folder / ("r" + std::to_string(t) + "c" + std::to_string(s) + ".ppm"), file);
        }
}

TEST_F(FitViewsCli, FindsPlanarViewsAndTheirFocus) {
    write_views(at("rig"));
    succeed("encode rig -o rig.tess --grid 3x3 --camera-spacing 0.375 --camera-fov 36.87 "
            "--camera-focus 3 --quality 95 -q");
    std::vector<std::string> matrices, turned;
    for (int i = 0; i < 25; ++i) {
        const double x = 0.37 * std::sin(2.1 * i), y = 0.3 * std::sin(3.4 * i + 1);
        const auto text = [](double number) { return std::to_string(number); };
        matrices.push_back(matrix_at(text(x), text(y), "3"));
        // The same, when the world is turned about the axis x and moved.
        turned.push_back("[[1,0,0," + text(x + 7) + "],[0,0,-1,-3],[0,1,0," + text(y) +
                         "],[0,0,0,1]]");
    }
    write_cameras("transforms.json", matrices, R"("fl_x":100,)");
    // Views that move by 2 pixels, which are 1/8 wide, coincide at the distance 4.5.
    succeed("render rig.tess --cameras transforms.json --focus 4.5 --rays 4 -o photos -q");
    const std::string options = " --surface planar --smoothness 1 --texels 60000 --hold-out 5 "
                                "--quality 90 --json ";
    const Json fit = json("fit transforms.json -o fit.tess" + options);
    EXPECT_NEAR(number_after(fit, "distance "), 4.5, 0.7);
    EXPECT_GT(fit["held_out"]["psnr"].get<double>(), 28.0);
    succeed("render fit.tess --cameras transforms.json -o drawn --rays 4 -q");
    EXPECT_GT(json("compare transforms.json drawn --json")["psnr"].get<double>(), 28.0);
    // In another world the file states where its window is.
    write_cameras("turned.json", turned, R"("fl_x":100,)");
    const Json again = json("fit turned.json -o turned.tess --focus 4.5" + options);
    EXPECT_GT(again["held_out"]["psnr"].get<double>(), 28.0);
    const Json info = json("info turned.tess --json");
    EXPECT_TRUE(info["metadata"].contains("Window"));
}

} // namespace
