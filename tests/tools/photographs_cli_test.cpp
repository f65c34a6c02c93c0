// From cameras to pictures and figures: render --cameras and compare with photographs.
#include "tests/support/cli_fixture.h"
#include "tests/support/photographs.h"
#include "tools/picture/picture.h"
#include "tools/picture/picture_encoders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

namespace {

using namespace tessera::test;

// Two cameras that are 8 and 10 away from the middle of the paper's sphere of radius 3.5.
const char* const sphere_frames[] = {"[[1,0,0,0],[0,1,0,0],[0,0,1,8],[0,0,0,1]]",
                                     "[[0,0,1,10],[0,1,0,0],[-1,0,0,0],[0,0,0,1]]"};

std::string sphere_set(const std::string& head) {
    return transforms_json(head, {frame_json("./photos/a", sphere_frames[0]),
                                  frame_json("./photos/b", sphere_frames[1])});
}

class PhotographsCli : public CliFixture {
protected:
    void write_sphere(const std::string& name) const {
        succeed("bake lambert --size 16x8x4x4 --spp 1 --effort 0 -q -o " + name);
    }
    static int grey_at(const tessera::Picture& picture, unsigned x, unsigned y) {
        return std::to_integer<int>(*picture.pixel(x, y));
    }
    tessera::Picture picture(const std::string& name) const {
        auto read = tessera::read_png(at(name).string());
        EXPECT_TRUE(read.ok()) << read.status().message();
        return read.ok() ? std::move(*read) : tessera::blank_picture(1, 1, 0);
    }
};

TEST_F(PhotographsCli, DrawsTheViewsOfPhotographs) {
    write_sphere("s.tess");
    // The same camera as --eye 0,0,8 with a field of view of 2 atan(12 / 30) degrees.
    spit(at("c.json"), sphere_set(R"("w":32,"h":24,"fl_x":30,)"));
    succeed("render s.tess -o drawn --cameras c.json -q");
    EXPECT_EQ(names(), (std::vector<std::string>{"c.json", "drawn", "s.tess"}));
    succeed("render s.tess -o eye.png --eye 0,0,8 --pixels 32x24 --fov 43.602818972703624 -q");
    EXPECT_EQ(picture("drawn/a.png").rgb, picture("eye.png").rgb);
    succeed("render s.tess -o eye.png --eye 10,0,0 --pixels 32x24 --fov 43.602818972703624 -q");
    EXPECT_EQ(picture("drawn/b.png").rgb, picture("eye.png").rgb);
    EXPECT_EQ(json("render s.tess -o drawn --cameras c.json --strict --json")["warnings"].size(),
              0u);
    spit(at("twice.json"), transforms_json(R"("w":32,"h":24,"fl_x":30,)",
                                           {frame_json("./photos/a", sphere_frames[0]),
                                            frame_json("photos/a", sphere_frames[1])}));
    EXPECT_EQ(json("render s.tess -o drawn --cameras twice.json --json")["warnings"][0]["count"],
              1);
    fail(5, "render s.tess -o none --cameras twice.json --strict",
         {"photos/a", "repeats", "--strict"});
    EXPECT_FALSE(fs::exists(at("none")));
    succeed("render s.tess -o half.png --cameras c.json --scale 0.5 -q");
    EXPECT_EQ(picture("half-a.png").width, 16u);
    EXPECT_EQ(picture("half-b.png").height, 12u);
    // The sphere's outline moves with the principal point.
    spit(at("c.json"), sphere_set(R"("w":32,"h":24,"fl_x":30,"cx":20,)"));
    const Json views = json("render s.tess -o moved --cameras c.json --json")["views"];
    EXPECT_EQ(views[1]["name"], "b");
    EXPECT_EQ(views[1]["output"], "moved/b.png");
    const tessera::Picture plain = picture("drawn/a.png"), moved = picture("moved/a.png");
    for (unsigned x = 0; x < 28; ++x)
        EXPECT_NEAR(grey_at(moved, x + 4, 12), grey_at(plain, x, 12), 1) << x;
}

// The layers and the path traced model follow the same lens: from above, off the centre, distorted.
TEST_F(PhotographsCli, DrawsLayersAndTheirTruth) {
    spit(at("roof.obj"), "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 0\nv 1 1 0\n"
                         "f 1 2 3 4\nf 4 3 6 5\nf 2 1 5 6\n");
    succeed("bake roof.obj --light 1,2,1 --layered --texels 4000 --lights 2 --spp 2 --effort 0 -q "
            "-o a.tess");
    const auto draw = [&](const std::string& head) {
        spit(at("c.json"),
             transforms_json(R"("w":32,"h":24,"fl_x":30,)" + head,
                             {frame_json("top", "[[1,0,0,0],[0,0,1,12],[0,-1,0,0],[0,0,0,1]]")}));
        return json("render a.tess -o d --cameras c.json --truth roof.obj --truth-spp 16 --json");
    };
    const Json plain = draw("");
    const tessera::Picture centred = picture("d/top.png");
    const Json bent = draw(R"("cx":20,"k1":0.3,)");
    EXPECT_NE(picture("d/top.png").rgb, centred.rgb);
    const double psnr = plain["views"][0]["compressed_truth"]["psnr"];
    EXPECT_GT(psnr, 20);
    EXPECT_NEAR(bent["views"][0]["compressed_truth"]["psnr"].get<double>(), psnr, 3);
}

TEST_F(PhotographsCli, RefusesCamerasThatCannotDraw) {
    write_sphere("s.tess");
    const std::string render = "render s.tess -o drawn --cameras c.json ";
    spit(at("c.json"), sphere_set(R"("w":32,"h":24,"fl_x":30,"k1":0.1,)"));
    fail(5, render + "--via load", {"c.json", "frame 'a'", "--via cpu"});
    fail(5, render + "--via load --pixel-filter gauss", {"--pixel-filter"});
    fail(1, render + "--pixel-filter tent", {"--pixel-filter", "'tent'"});
    fail(1, render + "--eye 1,2,3", {"--eye"});
    fail(1, render + "--scale 0", {"--scale"});
    fail(1, render + "--scale 1000", {"--scale", "16384"});
    fail(1, "render s.tess -o v.png --scale 2", {"--cameras"});
    spit(at("c.json"), transforms_json(R"("w":32,"h":24,"fl_x":30,)",
                                       {frame_json("p/in.png", matrix_at("0", "0", "1"))}));
    fail(1, render, {"in: ", "outside"});
    spit(at("c.json"), transforms_json(R"("fl_x":30,)", {frame_json("p/a.png", sphere_frames[0])}));
    fail(3, render, {"c.json", "frame 'p/a.png'", "no size"});
    fail(2, "render s.tess -o drawn --cameras none.json", {"none.json"});
    EXPECT_FALSE(fs::exists(at("drawn")));
}

// A wide filter blurs the outline of the sphere, a box of one pixel draws today's picture.
TEST_F(PhotographsCli, FiltersPixels) {
    write_sphere("s.tess");
    const std::string view = " --eye 0,0,8 --pixels 32x24 --rays 64 -q";
    succeed("render s.tess -o plain.png" + view);
    succeed("render s.tess -o box.png --pixel-filter box:1" + view);
    succeed("render s.tess -o wide.png --pixel-filter blackman-harris:6" + view);
    EXPECT_EQ(slurp(at("plain.png")), slurp(at("box.png")));
    const auto largest_step = [&](const std::string& name) {
        const tessera::Picture drawn = picture(name);
        int largest = 0;
        for (unsigned x = 0; x + 1 < drawn.width; ++x)
            largest =
                std::max(largest, std::abs(grey_at(drawn, x + 1, 12) - grey_at(drawn, x, 12)));
        return largest;
    };
    EXPECT_LT(4 * largest_step("wide.png"), 3 * largest_step("plain.png"));
}

TEST_F(PhotographsCli, ComparesPhotographs) {
    spit(at("c.json"), sphere_set(R"("w":32,"h":24,"fl_x":30,)"));
    fs::create_directories(at("photos"));
    fs::create_directories(at("drawn"));
    const auto write = [&](const std::string& name, const std::string& rgb) {
        spit(at(name), plain_ppm(32, 24, rgb));
    };
    write("photos/a.png", "ddd");
    write("photos/b.png", "ddd");
    write("drawn/a.png", "fff"); // 2 more everywhere
    write("drawn/b.png", "dgd"); // 3 more in a third of the samples
    const Json figures = json("compare c.json drawn --json");
    const double a = 10 * std::log10(255.0 * 255 / 4), b = 10 * std::log10(255.0 * 255 / 3);
    ASSERT_EQ(figures["pictures"].size(), 2u);
    EXPECT_EQ(figures["pictures"][0]["name"], "a");
    EXPECT_NEAR(figures["pictures"][0]["psnr"].get<double>(), a, 1e-9);
    EXPECT_NEAR(figures["pictures"][1]["psnr"].get<double>(), b, 1e-9);
    EXPECT_NEAR(figures["psnr"].get<double>(), (a + b) / 2, 1e-9);
    EXPECT_NEAR(figures["psnr_of_pixels"].get<double>(), 10 * std::log10(255.0 * 255 / 3.5), 1e-9);
    EXPECT_EQ(figures["worst"]["name"], "a");
    // Of plain pictures, SSIM is (2 m n + c) / (m^2 + n^2 + c) of their means.
    const double c = 0.01 * 255 * 0.01 * 255;
    EXPECT_NEAR(figures["pictures"][0]["ssim"].get<double>(),
                (2 * 100.0 * 102 + c) / (100.0 * 100 + 102 * 102 + c), 1e-5);
    EXPECT_EQ(json("compare photos drawn --pictures --json")["psnr"], figures["psnr"]);
    succeed("compare photos drawn --pictures --min-psnr 42 --min-ssim 0.9 -q");
    fail(7, "compare c.json drawn --min-psnr 60 -q", {"drawn", "mean PSNR", "60"});
    fail(7, "compare c.json drawn --min-ssim 1 -q", {"mean SSIM"});
    fail(1, "compare c.json drawn --max-error 1", {"--max-error"});
    fail(1, "compare photos drawn --pictures --background red", {"--background", "'red'"});
    fail(1, "compare photos drawn --background white", {"--background"});
    fs::remove(at("drawn/b.png"));
    fail(7, "compare c.json drawn", {"drawn/b.png", "does not exist"});
    spit(at("drawn/b.png"), plain_ppm(24, 32, "abc"));
    fail(7, "compare c.json drawn", {"drawn/b.png", "24x32", "photos/b.png", "32x24"});
    fs::remove(at("photos/b.png"));
    const Outcome warned = run("compare c.json drawn -q");
    EXPECT_EQ(warned.code, 0) << warned.err;
    EXPECT_NE(warned.err.find("warning: the picture is missing"), std::string::npos) << warned.err;
    EXPECT_NE(warned.err.find("photos/b"), std::string::npos) << warned.err;
    const Json listed = json("compare c.json drawn --json")["warnings"];
    ASSERT_EQ(listed.size(), 1u);
    EXPECT_EQ(listed[0]["first"], "photos/b");
    fail(5, "compare c.json drawn --strict", {"photos/b", "the picture is missing", "--strict"});
}

// What a mask leaves out does not count. Alpha shows the background.
TEST_F(PhotographsCli, ComparesWhatCounts) {
    fs::create_directories(at("photos"));
    fs::create_directories(at("drawn"));
    spit(at("c.json"),
         transforms_json(R"("fl_x":2,)", {frame_json("photos/a.png", matrix_at("0", "0", "0"),
                                                     R"(,"mask_path":"m.png")")}));
    spit(at("photos/a.png"), "P6\n2 1\n255\nabcabc");
    spit(at("drawn/a.png"), "P6\n2 1\n255\nabdzzz");
    spit(at("m.png"), std::string("P5\n2 1\n255\n\xff\0", 13));
    const Json masked = json("compare c.json drawn --json");
    EXPECT_NEAR(masked["psnr"].get<double>(), 10 * std::log10(255.0 * 255 * 3), 1e-9);
    EXPECT_TRUE(masked["ssim"].is_null());
    EXPECT_EQ(masked["pictures"][0]["pixels"], 1);
    fail(5, "compare c.json drawn --min-ssim 0.5", {"--min-ssim", "masked"});
    // Half transparent grey, and a hole.
    const unsigned char samples[] = {100, 100, 100, 102, 0, 0, 0, 0};
    const auto file = tessera::encode_png({2, 1, 4}, std::as_bytes(std::span(samples)));
    ASSERT_TRUE(file.ok()) << file.status().message();
    spit(at("photos/a.png"),
         std::string(reinterpret_cast<const char*>(file->data()), file->size()));
    spit(at("drawn/a.png"), "P6\n2 1\n255\n" + std::string("\x28\x28\x28\0\0\0", 6));
    const std::string compare = "compare photos drawn --pictures --json";
    EXPECT_TRUE(json(compare)["psnr_of_pixels"].is_null()) << "0.4 * 100 on black";
    spit(at("drawn/a.png"), "P6\n2 1\n255\n" + std::string("\xc1\xc1\xc1\xff\xff\xff", 6));
    EXPECT_TRUE(json(compare + " --background white")["psnr_of_pixels"].is_null())
        << "0.4 * 100 + 0.6 * 255";
    fs::rename(at("photos"), at("elsewhere"));
    fail(1, "compare c.json drawn", {"none of its 1 pictures exists", "--images"});
    succeed("compare c.json drawn --images elsewhere -q");
}

} // namespace
