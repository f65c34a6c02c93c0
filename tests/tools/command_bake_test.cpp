// The verb bake: scenes on their own surfaces.
#include "tests/support/cli_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using namespace tessera::test;

class BakeVerb : public CliFixture {};

const std::string mesh_scene =
    "bake aliasing-near --proxy mesh --density 6 --directions 6x5 --spp 1 --effort 0 ";

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
    succeed(mesh_scene + "-q --angular-map mirrored -o d.tess");
    EXPECT_NE(run("info d.tess").out.find("mirrored"), std::string::npos);
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
