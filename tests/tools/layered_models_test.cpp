// Tests models in layers, from the verb bake to the picture.
#include "tests/support/cli_fixture.h"
#ifdef TESSERA_GPU
#include "tests/support/gpu_fixture.h"
#endif

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace {

using namespace tessera::test;

class LayeredModels : public CliFixture {};

// A glossy roof over a floor, which throws a shadow.
const std::string glossy_roof = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 0\nv 1 1 0\n"
                                "f 1 2 3 4\nf 4 3 6 5\nf 2 1 5 6\n";

TEST_F(LayeredModels, LookLikeTheirTruth) {
    spit(at("roof.obj"), glossy_roof);
    const std::string lit = "bake roof.obj --light 1,2,1 --exposure 0.3 --roughness 0.4 --metal 0 "
                            "--layered --texels 20000 --lights 8 --spp 8 --effort 1 ";
    const Json baked = json(lit + "--quality 70 --json -o a.tess");
    ASSERT_EQ(baked["layers"].size(), 6u);
    EXPECT_EQ(baked["bytes"], slurp(at("a.tess")).size());
    EXPECT_GT(baked["noise_db"], 45);
    succeed("validate a.tess -q");
    const Json views =
        json("render a.tess -o v.png --eye 3.9,3,2.1 --pixels 80x60 --truth roof.obj "
             "--truth-spp 64 --json")["views"];
    EXPECT_GT(views[0]["compressed_truth"]["psnr"], 30);
    const Json info = json("info a.tess --json");
    ASSERT_EQ(info["layers"].size(), 6u);
    EXPECT_EQ(info["layers"][0]["role"], "diffuse");
    EXPECT_EQ(info["lights"], 9); // with the sun
    EXPECT_EQ(info["metadata"]["Model"], "roof.obj");
    std::uint64_t bytes = 0;
    for (const Json& layer : info["layers"])
        bytes += layer["bytes"].get<std::uint64_t>();
    EXPECT_EQ(bytes, slurp(at("a.tess")).size());
    // The first layer alone is an ordinary texture.
    succeed("decode a.tess -o a.png");
    succeed("decode a.tess --layer diffuse -o diffuse.png -q");
    EXPECT_TRUE(slurp(at("a.png")) == slurp(at("diffuse.png")));
    const Json visibility = json("decode a.tess --layer visibility -o visibility.raw --json");
    EXPECT_EQ(visibility["size"], info["layers"][4]["size"]);
    EXPECT_EQ(visibility["raw_bytes"], slurp(at("visibility.raw")).size());
    fail(1, "decode a.tess --layer opacity -o x.png",
         {"--layer", "a.tess", "opacity", "diffuse, specular, roughness"});
    succeed(lit + "--quality 70 --threads 1 -q -o new/folder/b.tess");
    EXPECT_TRUE(slurp(at("a.tess")) == slurp(at("new/folder/b.tess")));
    EXPECT_TRUE(slurp(at("a.tess")) == run(lit + "--quality 70 -q -o -").out);
}

#ifdef TESSERA_GPU
TEST_F(LayeredModels, LookTheSameOnTheGpu) {
    if (no_gpu_asked())
        GTEST_SKIP() << "TESSERA_NO_GPU=1";
    spit(at("roof.obj"), glossy_roof);
    succeed("bake roof.obj --light 1,2,1 --exposure 0.3 --roughness 0.4 --metal 0 --layered "
            "--texels 4000 --lights 4 "
            "--spp 2 --effort 0 -q -o a.tess");
    const std::string view = " --eye 1.29,1.36,0.86 --fov 12 --pixels 80x60 -q"; // no edges
    succeed("render a.tess -o cpu.png" + view);
    for (const std::string via : {"gpu", "load"}) {
        succeed("render a.tess -o gpu.png --via " + via + view);
        EXPECT_GT(json("compare cpu.png gpu.png --json")["psnr"], 50) << via;
    }
    fail(5, "render a.tess -o v.png --via load --budget 32M", {"a.tess", "--budget 33M"});
}
#endif

TEST_F(LayeredModels, DamageIsFoundInEveryLayer) {
    spit(at("roof.obj"), glossy_roof);
    succeed("bake roof.obj --layered --texels 4000 --lights 2 --spp 2 --effort 0 -q -o a.tess");
    const std::string file = slurp(at("a.tess"));
    std::size_t at_byte = file.size();
    const Json layers = json("info a.tess --json")["layers"];
    // DATA of the layers ends the file, in their order.
    for (auto layer = layers.rbegin(); layer + 1 != layers.rend(); ++layer) {
        std::string damaged = file;
        damaged[at_byte - 2] = static_cast<char>(damaged[at_byte - 2] ^ 0x55);
        spit(at("d.tess"), damaged);
        fail(3, "validate d.tess -q", {"d.tess"});
        break; // offsets of the others are not known here
    }
    spit(at("cut.tess"), file.substr(0, file.size() - 1));
    fail(3, "render cut.tess -o v.png --pixels 8x8", {"cut.tess"});
    fail(3, "validate cut.tess", {"cut.tess"});
}

// A trial chooses, unless an option does.
TEST_F(LayeredModels, AreTheDefaultWhereTheyHoldTheLight) {
    // A floor and a wall. As mirrors they show each other, which layers blur.
    spit(at("corner.obj"), "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\n"
                           "f 4 3 2 1\nf 1 2 6 5\n");
    const std::string quick = " --spp 1 --effort 0 -o a.tess";
    const auto layers = [&](const std::string& options) {
        const Outcome o = run("bake corner.obj " + options + quick);
        EXPECT_EQ(o.code, 0) << o.err;
        const bool layered = o.err.find("tessera bake: layers, because") == 0;
        EXPECT_EQ(o.err.find("tessera bake: one texture, because") == 0, !layered) << o.err;
        EXPECT_EQ(json("info a.tess --json").contains("layers"), layered);
        return layered;
    };
    const std::string small = "--density 8 --directions 1x1 ";
    EXPECT_TRUE(layers(small + "--roughness 0.4 --metal 0"));
    EXPECT_FALSE(layers(small + "--roughness 0.4 --metal 0 --single"));
    EXPECT_FALSE(layers(small + "--roughness 0.4 --metal 0 --tile 8x8x1x1"));
    EXPECT_FALSE(layers(small + "--roughness 0 --metal 1"));
    EXPECT_TRUE(layers(small + "--roughness 0 --metal 1 --texels 2000"));
}

TEST_F(LayeredModels, OptionsThatDoNotApplyAreRefused) {
    spit(at("roof.obj"), glossy_roof);
    fail(1, "bake roof.obj --layered --target-psnr 40 -o a.tess", {"--target-psnr", "--quality"});
    fail(1, "bake roof.obj --layered --texels 2000 --spp 1 --target-bytes 300 -q -o a.tess",
         {"--target-bytes", "mesh"});
    fail(1, "bake roof.obj --layered --size 8x8x8x8 -o a.tess", {"--size"});
    fail(1, "bake roof.obj --layered -o a.exr", {".tess"});
    fail(1, "bake roof.obj --layered --angular-map octahedral-mirrored -o a.tess",
         {"--angular-map"});
    fail(1, "bake composed --layered -o a.tess", {"--layered", "--proxy mesh"});
    fail(1, "bake roof.obj --single --lights 3 -o a.tess", {"--lights", "--single"});
    fail(1, "bake roof.obj --single --noise 40 -o a.tess", {"--noise", "--single"});
    fail(1, "bake roof.obj --noise 5 -o a.tess", {"--noise", "10", "80"});
    fail(1, "bake roof.obj --single --layered -o a.tess", {"--layered", "--single"});
    fail(1, "bake roof.obj --texels 2000 --target-psnr 30 -q -o a.tess",
         {"--texels", "--target-psnr"});
    fail(1, "bake composed --single -o a.tess", {"--single", "--proxy mesh"});
    fail(2, "bake nowhere.obj --layered -o a.tess", {"nowhere.obj"});
}

// Most of the file may be the mesh, which the quality does not change.
TEST_F(LayeredModels, TargetBytesAreUsedBesideALargeMesh) {
    std::string hills;
    constexpr int side = 24;
    for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x)
            hills += "v " + std::to_string(x) + " " + std::to_string(std::sin(x * 1.3 + y * y)) +
                     " " + std::to_string(y) + "\n";
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const int a = y * (side + 1) + x + 1, b = a + side + 1;
            for (const auto& [p, q, r] : {std::array{a, b, a + 1}, std::array{a + 1, b, b + 1}})
                hills += "f " + std::to_string(p) + " " + std::to_string(q) + " " +
                         std::to_string(r) + "\n";
        }
    spit(at("hills.obj"), hills);
    const std::string bake =
        "bake hills.obj --layered --texels 8000 --lights 4 --spp 2 --effort 0 -q -o a.tess";
    succeed(bake);
    const Json usual = json("info a.tess --json");
    const double all = usual["file_bytes"], mesh = usual["mesh"]["bytes"];
    ASSERT_GT(mesh, 0.2 * all);
    const double wanted = mesh + 0.6 * (all - mesh);
    succeed(bake + " --target-bytes " + std::to_string(static_cast<int>(wanted)));
    const double bytes = json("info a.tess --json")["file_bytes"];
    EXPECT_LE(bytes, wanted);
    EXPECT_GT(bytes, 0.97 * wanted);
}

} // namespace
