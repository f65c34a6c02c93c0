// Tests the verb bake on scenes and models with their own surfaces.
#include "tests/support/cli_fixture.h"
#include "tests/support/model_files.h"
#include "tools/picture/picture.h"
#include "tools/support/parse.h"

#include <glm/vec3.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

namespace {

using namespace tessera::test;

class BakeVerb : public CliFixture {};

const std::string mesh_scene =
    "bake aliasing-near --proxy mesh --single --density 6 --directions 6x5 --spp 1 --effort 0 ";

TEST_F(BakeVerb, PutsScenesOnTheirOwnSurfaces) {
    const Json baked = json(mesh_scene + "--json --threads 1 -o a.tess");
    EXPECT_EQ(baked["texels_per_unit"], 6);
    EXPECT_EQ(baked["charts"], 3);
    EXPECT_GT(baked["triangles"], 50);
    EXPECT_LT(baked["mesh_bytes"], baked["bytes"]);
    succeed("validate a.tess -q");
    const std::string info = run("info a.tess").out;
    for (const char* word : {"mesh", "octahedral", "aliasing-near"})
        EXPECT_NE(info.find(word), std::string::npos) << info;
    fail(5, "compare a.tess --bake aliasing-near", {"a.tess", "mesh"});
    succeed(mesh_scene + "-q --threads 2 -o b.tess");
    EXPECT_TRUE(slurp(at("a.tess")) == slurp(at("b.tess")));
    succeed(mesh_scene + "-q --resume -o c.tess");
    EXPECT_TRUE(slurp(at("a.tess")) == slurp(at("c.tess")));
    succeed(mesh_scene + "-q --angular-map octahedral-mirrored -o d.tess");
    EXPECT_NE(run("info d.tess").out.find("mirrored"), std::string::npos);
}

// Rendered views of a small mesh file look like the scene. A texture of the sphere with a hundred
// times as many texels is 10 dB worse.
TEST_F(BakeVerb, MeshesAreSeenSharp) {
    succeed("bake composed --proxy mesh --density 12 --directions 8x8 --spp 2 --effort 1 "
            "--quality 40 -q -o a.tess");
    EXPECT_LT(slurp(at("a.tess")).size(), 12000u);
    const Json views = json("render a.tess -o v.png --eye 9,4,5 --pixels 160x120 --truth composed "
                            "--truth-spp 4 --json")["views"];
    EXPECT_GT(views[0]["compressed_truth"]["psnr"], 36);
    succeed("render a.tess -o inside.png --eye 0.1,0.2,0.1 --look 3,0,0 --pixels 16x12 -q");
    fail(1, "rd --views composed x.tess -o r", {"--views"});
    fail(1, "rd -o r", {"--views"});
    fail(1, "rd --views nowhere -o r", {"nowhere", "composed"});
}

// A roof over a floor, lit by a studio and a sun.
const std::string roof = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 0\nv 1 1 0\n"
                         "f 1 2 3 4\nf 4 3 6 5\nf 2 1 5 6\n";

TEST_F(BakeVerb, ModelsLookLikeTheirTruth) {
    spit(at("roof.obj"), roof);
    const std::string lit =
        "bake roof.obj --single --light 1,2,1 --exposure 0.3 --roughness 0.6 --metal 0 ";
    succeed(lit + "--density 6 --directions 4x4 --tile 8x8x4x4 --spp 16 --effort 0 -q -o a.tess");
    const std::string view = " -o v.png --eye 3.9,3,2.1 --pixels 80x60 ";
    const auto psnr = [&](const std::string& file, const std::string& more) {
        return json("render " + file + view + "--truth roof.obj --truth-spp 64 --json " +
                    more)["views"][0]["compressed_truth"]["psnr"]
            .get<double>();
    };
    const double right = psnr("a.tess", "");
    EXPECT_GT(right, 30);
    EXPECT_EQ(psnr("a.tess", "--threads 1"), right);
    // Every file holds its own light: with another light the same model gives another picture.
    succeed("bake roof.obj --single --light -1,2,-1 --exposure 0.5 --roughness 0.6 --metal 0 "
            "--density 6 "
            "--directions 4x4 --tile 8x8x4x4 --spp 4 --effort 0 -q -o b.tess");
    succeed("render a.tess" + view + "-q");
    const std::string one = slurp(at("v.png"));
    succeed("render b.tess" + view + "-q");
    EXPECT_FALSE(slurp(at("v.png")) == one);
    EXPECT_GT(psnr("b.tess", ""), 30);

    fail(1, "render a.tess" + view + "--truth composed", {"a.tess", "roof.obj", "composed"});
    fail(2, "render a.tess" + view + "--truth nowhere.obj", {"nowhere.obj"});
    fail(1, "render a.tess" + view + "--truth composed --env a.exr", {"--env"});
    fail(2, "render a.tess" + view + "--truth roof.obj --env nowhere.exr", {"nowhere.exr"});
    succeed(mesh_scene + "-q -o scene.tess");
    fail(1, "render scene.tess" + view + "--truth roof.obj", {"scene.tess", "roof.obj"});
}

// The same roof elsewhere and in other units: place -> scale * place + offset.
std::string roof_at(double scale, const glm::dvec3& offset) {
    std::istringstream lines(roof);
    std::string out;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string kind;
        glm::dvec3 p;
        if (words >> kind >> p.x >> p.y >> p.z && kind == "v") {
            p = scale * p + offset;
            line = "v " + tessera::format_digits(p.x, 9) + " " + tessera::format_digits(p.y, 9) +
                   " " + tessera::format_digits(p.z, 9);
        }
        out += line + "\n";
    }
    return out;
}

TEST_F(BakeVerb, MeshesKeepTheUnitsAndThePlaceOfTheModel) {
    const auto bake = [&](const std::string& name, const std::string& density) {
        return run("bake " + name +
                   ".obj --single --light 1,2,1 --exposure 0.3 --roughness 0.6 "
                   "--metal 0 --directions 4x4 --tile 8x8x4x4 --spp 16 --effort 0 -q -o " +
                   name + ".tess --density " + density);
    };
    const auto seen_from = [&](const std::string& name, const std::string& eye,
                               const std::string& look) {
        const Json view =
            json("render " + name + ".tess -o " + name + ".png --eye " + eye + " --look " + look +
                 " --pixels 80x60 --truth " + name + ".obj --truth-spp 64 --json")["views"][0];
        return view["compressed_truth"]["psnr"].get<double>();
    };
    spit(at("roof.obj"), roof);
    spit(at("large.obj"), roof_at(1000.0, {2000, 5000, -3000}));
    EXPECT_EQ(bake("roof", "6").err, "");
    EXPECT_EQ(bake("large", "0.006").err, "");
    const Json mesh = json("info roof.tess --json")["mesh"];
    const Json large = json("info large.tess --json");
    EXPECT_EQ(large["metadata"]["Mesh scale"], "1");
    EXPECT_EQ(large["metadata"]["Mesh offset"], "0,0,0");
    EXPECT_EQ(large["metadata"]["Texels per unit"], "0.006");
    const double offset[] = {2000, 5000, -3000};
    for (const char* corner : {"low", "high"})
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(large["mesh"][corner][axis].get<double>(),
                        1000 * mesh[corner][axis].get<double>() + offset[axis], 1);
    EXPECT_GT(seen_from("roof", "4,3,2", "0,0.5,0"), 28);
    EXPECT_GT(seen_from("large", "6000,8000,-1000", "2000,5500,-3000"), 28);
    EXPECT_GT(json("compare roof.png large.png --json")["psnr"], 35);
    // The standard views show both from the same side and distance.
    succeed("render roof.tess -o roof.png --views 4 --pixels 80x60 -q");
    succeed("render large.tess -o large.png --views 4 --pixels 80x60 -q");
    EXPECT_GT(json("compare roof.png large.png --json")["psnr"], 35);
}

TEST_F(BakeVerb, MovesModelsThatAreTooSmallOrTooFarAwayAndSaysSo) {
    spit(at("far.obj"), roof_at(1e-4, {1, 0, 0}));
    const std::string bake = "bake far.obj --single --light 1,2,1 --exposure 0.3 --roughness 0.6 "
                             "--metal 0 --directions 1x1 --tile 8x8x1x1 --spp 16 --effort 0 "
                             "-o far.tess --density 4 ";
    const Outcome o = run(bake + "-q");
    EXPECT_EQ(o.code, 0);
    EXPECT_NE(o.err.find("moved to the origin"), std::string::npos) << o.err;
    fail(5, bake + "--strict -q", {"moved to the origin"});
    const Json info = json("info far.tess --json");
    EXPECT_GT(std::stod(info["metadata"]["Mesh scale"].get<std::string>()), 1000);
    EXPECT_LT(std::abs(info["mesh"]["low"][0].get<double>()), 4);
    const Json view = json("render far.tess -o v.png --views 4 --pixels 80x60 "
                           "--truth far.obj --truth-spp 64 --json")["views"][0];
    EXPECT_GT(view["compressed_truth"]["psnr"], 28);
}

TEST_F(BakeVerb, SaysThatAMaterialFileIsMissing) {
    spit(at("roof.obj"), "mtllib gone.mtl\n" + roof);
    const Outcome o =
        run("bake roof.obj --single --density 1 --directions 1x1 --tile 8x8x1x1 --spp 1 "
            "--effort 0 -q -o a.tess");
    EXPECT_EQ(o.code, 0);
    EXPECT_EQ(o.err, "tessera bake: warning: the material file 'gone.mtl' is missing; its "
                     "materials are grey (in roof.obj)\n");
}

// The camera lies on its side, so the green half of the triangles is on the right of its picture.
TEST_F(BakeVerb, CamerasOfTheModelSeeItsTexture) {
    tessera::corpus::support::GltfText text;
    text.positions = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    text.indices = {0, 1, 2, 0, 2, 3};
    text.buffers = R"(,{"byteLength":48,"uri":"data:application/octet-stream;base64,)" +
                   tessera::corpus::support::base64_of(
                       std::vector<float>{1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0}) +
                   R"("})";
    text.views = R"(,{"buffer":2,"byteLength":48})";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":4})";
    text.attributes = R"(,"COLOR_0":2)";
    text.primitive = R"(,"material":0)";
    text.nodes = R"({"mesh":0,"children":[1,2]},{"name":"Side cam","camera":0,)"
                 R"("translation":[0,0,2],"rotation":[0,0,0.7071067811865476,0.7071067811865476]},)"
                 R"({"name":"Other","camera":0,"translation":[0,0,2]})";
    text.more = R"(,"materials":[{"extensions":{"KHR_materials_unlit":{}}}],)"
                R"("cameras":[{"type":"perspective","perspective":{"yfov":0.6,"znear":0.1}}])";
    spit(at("cams.gltf"), text.text());
    succeed("bake cams.gltf --density 4 --directions 1x1 --tile 8x8x1x1 --spp 1 --effort 0 -q "
            "-o a.tess");
    succeed("render a.tess -o v.png --camera \"Side cam\" --pixels 20x20 -q");
    const auto picture = tessera::read_png(at("v.png"));
    ASSERT_TRUE(picture.ok());
    const auto colour = [&](std::size_t x, std::size_t y, std::size_t c) {
        return std::to_integer<int>(picture->rgb[3 * (y * 20 + x) + c]);
    };
    EXPECT_GT(colour(15, 10, 1), colour(15, 10, 0) + 40);
    EXPECT_GT(colour(4, 10, 0), colour(4, 10, 1) + 40);
    const Json info = json("info a.tess --json");
    ASSERT_EQ(info["cameras"].size(), 2u);
    EXPECT_EQ(info["cameras"][0]["name"], "Side cam");
    EXPECT_NEAR(info["cameras"][0]["fov"], 34.3775, 1e-3);
    fail(1, "render a.tess -o v.png --camera Sidecam",
         {"a.tess", "Sidecam", "'Side cam', 'Other'"});
    fail(1, "render a.tess -o v.png --camera Other --eye 1,2,3", {"--camera", "--eye"});
    fail(1, "render --scene composed -o v.png --camera Other", {"--camera", ".tess"});
    spit(at("roof.obj"), roof);
    succeed("bake roof.obj --density 1 --directions 1x1 --tile 8x8x1x1 --spp 1 --effort 0 -q "
            "-o b.tess");
    fail(1, "render b.tess -o v.png --camera Other", {"b.tess", "the file has no cameras"});
}

// What layers approximate of a material is said, once a kind.
TEST_F(BakeVerb, LayersNameWhatTheyApproximate) {
    tessera::corpus::support::GltfText text;
    text.primitive = R"(,"material":0)";
    text.more = R"(,"materials":[{"extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":1},)"
                R"("KHR_materials_transmission":{"transmissionFactor":1}}}])";
    spit(at("coat.gltf"), text.text());
    const std::string bake =
        "bake coat.gltf --texels 1024 --lights 1 --spp 1 --effort 0 -o a.tess ";
    const Json whole = json(bake + "--layered --json");
    ASSERT_EQ(whole["warnings"].size(), 2u);
    EXPECT_EQ(whole["warnings"][0]["warning"],
              "in layers a clear coat and the mirror below it share a highlight");
    EXPECT_EQ(whole["warnings"][1]["warning"], "in layers transmitted light is blurred");
    fail(5, bake + "--layered --strict -q", {"coat.gltf", "clear coat"});
}

// Pixels at an edge have as many shades as rays.
TEST_F(BakeVerb, TruthOfModelsHasTheRaysOfThePicture) {
    spit(at("glow.mtl"), "newmtl glow\nKd 0 0 0\nNs 0\nKe 1 1 1\n");
    spit(at("glow.obj"), "mtllib glow.mtl\nusemtl glow\nv -1 -1 0\nv 1 -0.9 0\nv 0 1 0\nf 1 2 3\n");
    succeed("bake glow.obj --layered --texels 1024 --spp 1 --effort 0 -q -o a.tess");
    const auto shades = [&](const std::string& rays) {
        succeed("render a.tess -o v.png --eye 0,0,4 --pixels 40x40 --truth glow.obj --truth-spp 64 "
                "--write-all -q --rays " +
                rays);
        const auto truth = tessera::read_png(at("v-truth.png"));
        EXPECT_TRUE(truth.ok()) << truth.status().message();
        return std::set<std::byte>(truth->rgb.begin(), truth->rgb.end()).size();
    };
    EXPECT_GT(shades("16"), 2 * shades("4"));
}

TEST_F(BakeVerb, RefusesOptionsThatDoNotGoTogether) {
    const std::string sphere = "bake composed -o x.tess ", mesh = sphere + "--proxy mesh ";
    fail(1, sphere + "--density 8", {"--density", "--proxy mesh"});
    fail(1, sphere + "--directions 8x8", {"--directions", "--proxy mesh"});
    fail(1, mesh + "--size 8x8x4x4", {"--size", "--density"});
    fail(1, mesh + "--seed 3", {"--seed"});
    fail(1, mesh + "--surface-map none", {"--surface-map"});
    fail(1, mesh + "--angular-map planar", {"--angular-map", "mirrored"});
    fail(1, mesh + "--directions 8", {"--directions"});
    fail(1, mesh + "--density 0", {"--density"});
    fail(1, "bake composed --proxy mesh -o x.rgb", {"x.rgb", ".tess"});
    fail(1, "bake nowhere --proxy mesh -o x.tess", {"nowhere", "composed"});
    EXPECT_TRUE(names().empty());
}

} // namespace
