// Tests the verb bake on built-in scenes in layers.
#include "tests/support/cli_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using namespace tessera::test;

class LayeredScenes : public CliFixture {
protected:
    // PSNR of a view beside a direct ray trace, of a scene of patterns and mirrors.
    double decibels(const std::string& file) {
        const std::string view =
            " -o v.png --eye 10,0,0 --pixels 160x120 --truth mirror --truth-spp 4 --json";
        return json("render " + file + view)["views"][0]["compressed_truth"]["psnr"].get<double>();
    }
};

const std::string coarse = " --proxy mesh --directions 12x12 --spp 2 --effort 1 ";

TEST_F(LayeredScenes, PatternsAndMirrorsAreSharperThanInOneTexture) {
    const std::string bake = "bake mirror --density 32" + coarse;
    succeed(bake + "--quality 50 -q -o layers.tess");
    const std::size_t bytes = slurp(at("layers.tess")).size();
    succeed(bake + "--target-bytes " + std::to_string(bytes) + " -q --single -o one.tess");
    EXPECT_GT(decibels("layers.tess"), 27);
    EXPECT_GT(decibels("layers.tess"), decibels("one.tess") + 0.5);
    succeed("validate layers.tess -q");
}

// Matte objects need no differences, and those that face down no light from above.
TEST_F(LayeredScenes, ShowTheSameAsOneTextureWithManyTexels) {
    const std::string bake = "bake composed --density 16" + coarse + "--quality 80 -q ";
    succeed(bake + "-o layers.tess");
    succeed(bake + "--single -o one.tess");
    for (const char* file : {"layers.tess", "one.tess"})
        for (const char* eye : {"2,9,3", "3,-9,2"})
            EXPECT_GT(json(std::string("render ") + file + " -o v.png --eye " + eye +
                           " --pixels 160x120 --truth composed --truth-spp 4 --json")
                          ["views"][0]["compressed_truth"]["psnr"]
                              .get<double>(),
                      36)
                << file << eye;
}

TEST_F(LayeredScenes, AreChosenWhereSomethingShines) {
    const auto layers = [&](const std::string& scene, const std::string& options) {
        const Outcome o = run("bake " + scene + " --proxy mesh --density 1 --spp 1 --effort 0 " +
                              options + " -o a.tess");
        EXPECT_EQ(o.code, 0) << o.err;
        const bool layered = o.err.find("tessera bake: layers, because") == 0;
        EXPECT_EQ(o.err.find("tessera bake: one texture, because") == 0, !layered) << o.err;
        EXPECT_NE(o.err.find("; about "), std::string::npos) << o.err;
        EXPECT_EQ(json("info a.tess --json").contains("layers"), layered);
        return layered;
    };
    EXPECT_TRUE(layers("composed", ""));
    EXPECT_TRUE(layers("mirror", "--layered --directions 3x5"));
    EXPECT_FALSE(layers("mirror", "--single"));
    EXPECT_FALSE(layers("mirror", "--directions 1x1"));
    EXPECT_FALSE(layers("mirror", "--target-psnr 30"));
    EXPECT_FALSE(layers("gallery", ""));
    EXPECT_FALSE(layers("lambert", ""));
    EXPECT_FALSE(layers("lamps", "--directions 4x4"));
}

TEST_F(LayeredScenes, DoNotDependOnThreads) {
    const std::string bake = "bake aliasing-near --density 8" + coarse;
    const Json baked = json(bake + "--threads 1 --json -o a.tess");
    EXPECT_EQ(baked["layers"].size(), 2u);
    EXPECT_EQ(baked["scene"], "aliasing-near");
    succeed(bake + "--threads 3 -q -o b.tess");
    EXPECT_TRUE(slurp(at("a.tess")) == slurp(at("b.tess")));
}

TEST_F(LayeredScenes, RefuseWhatLayersCannotHold) {
    fail(5, "bake lamps --proxy mesh --layered -o a.tess", {"lamps", "scene-linear"});
    fail(5, "bake gallery --proxy mesh --layered -o a.tess", {"gallery", "shines"});
    fail(5, "bake hard --proxy mesh --layered -o a.tess", {"hard", "--density"});
    fail(1, "bake mirror --proxy mesh --layered --target-psnr 30 -o a.tess",
         {"--target-psnr", "--quality"});
    fail(1, "bake mirror --proxy mesh --single --layered -o a.tess", {"--single", "--layered"});
    fail(5, "bake mirror --proxy mesh --layered --directions 1x1 -o a.tess", {"direction"});
    fail(1, "bake mirror --proxy mesh --texels 2000 -o a.tess", {"--texels", "model"});
    fail(1, "bake mirror --proxy mesh --env x.exr -o a.tess", {"--env"});
    EXPECT_TRUE(names().empty());
}

} // namespace
