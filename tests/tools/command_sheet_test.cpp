#include "tests/support/cli_fixture.h"
#include "tests/support/cli_scenes.h"

#include <gtest/gtest.h>

namespace {

using namespace tessera::test;
using namespace tessera::test::cli_scenes;

class SheetVerb : public CliFixture {};

TEST_F(SheetVerb, DrawsSheets) {
    succeed(small_scene + quick + "-q -o a.tess");
    succeed(small_scene + "-q -o a.rgb");
    succeed("sheet a.rgb a.tess -o s.png -q"); // a.rgb gets the size of a.tess
    EXPECT_EQ(slurp(at("s.png")).substr(1, 3), "PNG");
    succeed("sheet a.tess -o t.png -q --views 1 --angular 0");
    fail(1, "sheet a.tess -o t.jpg", {".png"});
    succeed("bake lamps -q --spp 1 --size 4x3x2x1 -o l.exr");
    succeed("sheet l.exr -o l.png -q");
    fail(7, "sheet a.tess l.exr -o x.png", {});
    fail(7, "compare a.tess l.exr", {"32x16x9x5", "4x3x2x1"});
}

TEST_F(SheetVerb, SetsPicturesSideBySide) {
    succeed(small_scene + quick + "-q -o a.tess");
    succeed("render a.tess -o v.png --views paper --pixels 16x12 -q");
    const Outcome o = run("sheet v-1.png v-2.png v-3.png --columns 2 --middle 10 -o m.png");
    EXPECT_EQ(o.out, "m.png: 44 x 76 pixels\n") << o.err; // gaps of 8, labels of 16
    EXPECT_EQ(run("sheet v-1.png v-2.png v-3.png -o m.png").out, "m.png: 80 x 44 pixels\n");
    succeed("sheet v-1.png --label 'one, two' -o m.png -q");
    fail(1, "sheet -o m.png", {"inputs"});
    fail(1, "sheet v-1.png v-2.png --label one -o m.png", {"1 labels for 2"});
    fail(1, "sheet v-1.png -o m.jpg", {"m.jpg"});
    fail(7, "sheet v-1.png a.tess -o m.png", {"differ"}); // a picture is a texture with one view
    fail(1, "sheet a.tess a.tess a.tess -o m.png", {"two textures"});
    fail(2, "sheet none.png -o m.png", {"none.png"});
    spit(at("bad.png"), "no picture");
    fail(3, "sheet bad.png -o m.png", {"bad.png"});
}

} // namespace
