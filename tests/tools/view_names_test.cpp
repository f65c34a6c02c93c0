// Recognising and ordering views by their file names.
#include "tools/texture_io/view_layout.h"
#include "tools/texture_io/view_names.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

std::vector<std::string> numbered(const std::string& before, int first, int count,
                                  const std::string& after) {
    std::vector<std::string> names;
    for (int i = first; i < first + count; ++i) {
        const std::string digits = std::to_string(i);
        names.push_back(before + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') +
                        digits + after);
    }
    return names;
}

std::string pattern_of(const std::vector<std::string>& names, const ViewOrder& order = {}) {
    const auto pattern = recognise_view_names(names, order);
    return pattern.ok() ? pattern->text() : pattern.status().message();
}

TEST(ViewPattern, ReadsAndWritesNames) {
    const auto usual = ViewPattern::parse(usual_view_pattern);
    ASSERT_TRUE(usual.ok());
    EXPECT_EQ(usual->name_of({12, 3, {}}), "view_t003_s012.png");
    const auto numbers = usual->match("VIEW_t1003_s12.PNG");
    ASSERT_TRUE(numbers.has_value());
    EXPECT_EQ(numbers->s, 12);
    EXPECT_EQ(numbers->t, 1003);
    for (const char* name : {"view_t1_s2.jpg", "view_t_s2.png", "view_t1_s.png", "view_t1.png",
                             "xview_t1_s2.png", "view_t1_s2.png.png", "view_t9999999999_s1.png"})
        EXPECT_FALSE(usual->match(name).has_value()) << name;
    // Matching must not backtrack: the stars can be matched in 160 million ways.
    const auto stars = ViewPattern::parse("*a*a*a*a{n}.png");
    EXPECT_FALSE(stars->match(std::string(250, 'a') + ".png"));
    const auto joined = ViewPattern::parse("{t:2}{s:2}*.exr");
    ASSERT_TRUE(joined.ok());
    EXPECT_EQ(joined->match("1203_x.exr")->t, 12);
    EXPECT_EQ(joined->match("1203_x.exr")->s, 3);
    EXPECT_EQ(ViewPattern::parse("v{n}.jpg")->match("v-4.jpg")->n, -4);
}

TEST(ViewPattern, NumbersMayBeginAnywhere) {
    const auto one = ViewPattern::parse("cam{n:3+1}.png");
    ASSERT_TRUE(one.ok()) << one.status().message();
    EXPECT_EQ(one->match("cam001.png")->n, 0);
    EXPECT_EQ(one->name_of({.n = 8}), "cam009.png");
    auto both = ViewPattern::parse("{t}_{s-3}*.exr");
    ASSERT_TRUE(both.ok());
    EXPECT_EQ(both->match("4_-3x.exr")->s, 0);
    both->begin_at({.s = 1, .t = 4});
    EXPECT_EQ(both->text(), "{t+4}_{s-2}*.exr");
    EXPECT_EQ(both->match("4_-2x.exr")->t, 0);
    EXPECT_EQ(both->name_of({.s = 0, .t = 0}), "4_-2.exr");
    both->begin_at({.s = 2, .t = -4});
    EXPECT_EQ(both->text(), "{t}_{s}*.exr");
}

TEST(ViewPattern, RefusesInvalidPatterns) {
    for (const char* text :
         {"", "view.png", "{n}", "{n}{s}.png", "{n}_{n}.png", "{n.png", "{x}.png", "{n:0}.png",
          "{n:12}.png", "{n+}.png", "{n:3*1}.png", "{n+1234567890}.png", "{n1}.png", "a/{n}.png",
          ".{n}.png", "****{n}*.png", "{n}.gif", "{n}\n.png"}) {
        const auto pattern = ViewPattern::parse(text);
        ASSERT_FALSE(pattern.ok()) << text;
        EXPECT_EQ(pattern.status().code(), ErrorCode::bad_argument);
    }
}

TEST(ViewNames, RecognisesCommonNames) {
    EXPECT_EQ(pattern_of(numbered("input_Cam", 0, 81, ".png")), "input_Cam{n:3}.png");
    EXPECT_EQ(pattern_of({"out_00_00_-780.1_-355.2_.png", "out_00_01_-780.3_3.7_.png",
                          "out_01_00_7.25_-355_.png"}),
              "out_{t:2}_{s:2}_*_*_.png");
    EXPECT_EQ(pattern_of({"00_00.JPG", "00_01.JPG", "01_00.JPG"}), "{t:2}_{s:2}.JPG");
    EXPECT_EQ(pattern_of({"0_9.png", "0_10.png", "1_9.png"}, {true}), "{s}_{t}.png");
    EXPECT_EQ(pattern_of({"x00_y00.png", "x01_y00.png", "x00_y01.png"}), "x{s:2}_y{t:2}.png");
    EXPECT_EQ(pattern_of({"Y0-X0.png", "Y0-X1.png", "Y1-X0.png"}), "Y{t}-X{s}.png");
    EXPECT_EQ(pattern_of({"a_col1_row1.png", "a_col2_row1.png", "a_col1_row2.png"}),
              "a_col{s}_row{t}.png");
    EXPECT_EQ(pattern_of({"r1c1.png", "r1c2.png", "r2c1.png"}), "r{t}c{s}.png");
    EXPECT_EQ(pattern_of({"(0,0).png", "(0,1).png", "(1,0).png"}), "({t},{s}).png");
    EXPECT_EQ(pattern_of({"(-1,-1).png", "(-1,0).png", "(0,0).png"}), "({t},{s}).png");
    EXPECT_EQ(pattern_of({"scene2-cam-01.png", "scene2-cam-02.png"}), "scene2-cam-{n:2}.png");
    EXPECT_EQ(pattern_of({"shot5.exr"}), "shot{n}.exr");
    EXPECT_EQ(pattern_of({"view_t000_s000.png", "view_t000_s001.png", "sheet.png"}),
              usual_view_pattern);
    EXPECT_EQ(pattern_of({"cam0.png", "cam1.png", "preview.png"}), "cam{n}.png");
}

TEST(ViewNames, RefusesAmbiguousNames) {
    const auto both = pattern_of({"a0.png", "a1.png", "b0.png", "b1.png"});
    EXPECT_NE(both.find("more than one pattern"), std::string::npos) << both;
    EXPECT_NE(both.find("a0.png (2 like it), b0.png (2 like it)"), std::string::npos) << both;
    EXPECT_NE(pattern_of({"a0.png", "a1.png", "a0.jpg", "a1.jpg"}).find("more than one"),
              std::string::npos);
    EXPECT_NE(pattern_of({"1_1_1.png", "1_2_2.png", "2_1_3.png"}).find("3 numbers differ"),
              std::string::npos);
    EXPECT_NE(pattern_of({"left.png", "right.png"}).find("nothing in common"), std::string::npos);
}

std::string arranged(const std::vector<std::string>& names, const ViewHints& hints = {}) {
    const auto views = arrange_views(names, hints, {});
    if (!views.ok())
        return views.status().message();
    std::string text = to_string(views->grid) + ":";
    for (const std::string& name : views->names)
        text += " " + name.substr(0, name.find('.'));
    return text;
}

TEST(ViewNames, ArrangesByOrder) {
    const std::vector<std::string> four = {"1.png", "2.png", "3.png", "4.png"};
    EXPECT_EQ(arranged(four), "2x2: 1 2 3 4");
    ViewHints hints;
    const auto by = [&](const std::string& order) {
        hints.order = *parse_view_order(order);
        return arranged(four, hints);
    };
    EXPECT_EQ(by("serpentine"), "2x2: 1 2 4 3");
    EXPECT_EQ(by("columns"), "2x2: 1 3 2 4");
    EXPECT_EQ(by("bottom-up"), "2x2: 3 4 1 2");
    EXPECT_EQ(by("right-left"), "2x2: 2 1 4 3");
    EXPECT_EQ(by("columns,serpentine,bottom-up,right-left"), "2x2: 3 2 4 1");
    hints.order.reset();
    hints.grid = ViewGrid{4, 1};
    EXPECT_EQ(arranged(four, hints), "4x1: 1 2 3 4");
    EXPECT_EQ(arranged({"r1c1.png", "r1c2.png", "r1c3.png", "r2c1.png", "r2c2.png", "r2c3.png"}),
              "3x2: r1c1 r1c2 r1c3 r2c1 r2c2 r2c3");
    EXPECT_EQ(arranged({"v_-1_0.png", "v_0_0.png", "v_-1_7.png", "v_0_7.png"}).substr(0, 29),
              "v_-1_1.png: this view is miss");
}

TEST(ViewNames, KnowsWhetherAxesAreGuessed) {
    const auto guessed = [](const std::vector<std::string>& names, const ViewHints& hints = {}) {
        const auto views = arrange_views(names, hints, {});
        EXPECT_TRUE(views.ok()) << views.status().message();
        return views.ok() && views->axes_are_guessed;
    };
    const std::vector<std::string> clear{"x0_y0.png", "x0_y1.png", "x1_y0.png", "x1_y1.png"},
        unclear{"(0,0).png", "(0,1).png", "(1,0).png", "(1,1).png"};
    EXPECT_FALSE(guessed(clear));
    EXPECT_TRUE(guessed(unclear));
    EXPECT_TRUE(guessed({"1.png", "2.png", "3.png", "4.png"}));
    ViewHints hints;
    hints.order = ViewOrder{};
    EXPECT_FALSE(guessed(unclear, hints));
    hints = {};
    hints.pattern = "({s},{t}).png";
    EXPECT_FALSE(guessed(unclear, hints));
}

TEST(ViewNames, ReportsViewsThatDoNotFit) {
    const auto expect_words = [](const std::vector<std::string>& names, const std::string& words,
                                 const ViewHints& hints = {}) {
        const std::string text = arranged(names, hints);
        EXPECT_NE(text.find(words), std::string::npos) << text;
    };
    expect_words({"a00.png", "a01.png", "a03.png"}, "a02.png: this view is missing from 2x2 views");
    expect_words(numbered("c", 0, 6, ".png"), "no square of views; say --grid");
    expect_words({"0_0.png", "0_1.png", "1_1.png"}, "1_0.png: this view is missing");
    expect_words({"0_0.png", "00_0.png", "0_1.png"},
                 "two files for one view: 0_0.png and 00_0.png");
    expect_words({"0_0.png", "1_999999999.png"}, "apart");
    ViewHints hints;
    hints.grid = ViewGrid{1, 2};
    expect_words(numbered("c", 0, 3, ".png"), "c002.png: outside the 1x2 views", hints);
    hints = {};
    hints.pattern = "x{n}.png";
    expect_words({"c000.png"}, "no picture whose name fits 'x{n}.png', but c000.png", hints);
}

TEST(ViewOrder, ConvertsBothWays) {
    const ViewGrid grid{3, 4};
    for (int bits = 0; bits < 16; ++bits) {
        const ViewOrder order{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0};
        EXPECT_EQ(*parse_view_order(to_string(order)), order);
        for (std::uint32_t s = 0; s < grid.s; ++s)
            for (std::uint32_t t = 0; t < grid.t; ++t) {
                const ViewStep at = step_of(grid, order, {s, t});
                EXPECT_EQ(place_in(grid, order, at.line, at.step), (ViewPlace{s, t})) << bits;
            }
    }
    for (const char* text : {"", "0x1", "3", "3x", "x3", "2000x2000", "3x3x3"})
        EXPECT_FALSE(parse_view_grid(text).ok()) << text;
}

TEST(ViewLayout, SurvivesConversionToText) {
    ViewLayout layout{"cam {n:3}.png", {}, {false, true, false, false}, {}};
    EXPECT_EQ(to_string(layout), "order:serpentine names:cam {n:3}.png");
    EXPECT_EQ(parse_view_layout(to_string(layout)).pattern, layout.pattern);
    EXPECT_EQ(parse_view_layout(to_string(layout)).order, layout.order);
    EXPECT_EQ(to_string(parse_view_layout("quilt:8x6 order:bottom-up")),
              "quilt:8x6 order:bottom-up");
    EXPECT_EQ(to_string(ViewLayout{usual_view_pattern, {}, {}, {}}), "");
    for (const char* text : {"names:../{n}.png", "quilt:0x0", "order:no", "nonsense", "names:"})
        EXPECT_EQ(to_string(parse_view_layout(text)), "") << text;
    EXPECT_EQ(quilt_in_name("a/b_qs8x6a0.75.png"), (ViewGrid{8, 6}));
    EXPECT_EQ(quilt_in_name("b_qs8x6.png"), (ViewGrid{8, 6}));
    for (const char* name : {"b_qs8.png", "b_qs8x6b.png", "qs8x6a1.png", "b_qs0x6a1.png"})
        EXPECT_FALSE(quilt_in_name(name).has_value()) << name;
}

} // namespace
} // namespace tessera
