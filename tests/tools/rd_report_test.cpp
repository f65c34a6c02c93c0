// The report of `tessera rd`: tables, JSON, text, the page and its plots.
#include "tests/support/rd_texture.h"
#include "tools/lab/rd/plot.h"
#include "tools/lab/rd/plot_labels.h"
#include "tools/lab/rd/report.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace tessera {
namespace {

Measurement point(const std::string& codec, const std::string& setting, double bpt, double psnr) {
    Measurement m;
    m.codec = codec;
    m.setting = setting;
    m.bits_per_texel = bpt;
    m.bytes = static_cast<std::uint64_t>(bpt * 1e6);
    m.quality.psnr_rgb = m.quality.psnr_worst_view = psnr;
    m.encode_mbs = 10;
    m.decode_mbs = 100;
    m.texel_bytes = 16;
    return m;
}

RdReport small_report() {
    TextureReport t;
    t.name = "a <texture>, \"quoted\"";
    t.size = "8x6x5x4";
    t.type = "unorm8";
    t.codecs = {{"tessera:3", "effort 3, tiles", "1", true},
                {"x265", "views", "2", true},
                {"raw", "nothing is coded", "3", false}};
    for (const double db : {34.0, 37.0, 40.0, 43.0}) {
        t.rows.push_back(point("tessera:3", "psnr", 0.05 * std::pow(1.2, db - 34), db));
        t.rows.push_back(point("x265", "crf", 0.1 * std::pow(1.2, db - 34), db));
    }
    t.rows.push_back(point("raw", "as it is", 8, std::numeric_limits<double>::infinity()));
    Measurement failed;
    failed.codec = "x265";
    failed.setting = "crf 1";
    failed.failed = "x265: exit code 1: a, \"b\"";
    t.rows.push_back(failed);
    t.absent = {{"aom", "not installed: aomenc, really"}};
    t.anchor = "x265";
    return {"tessera rd <x>", "a machine", {t}};
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text)
        if (c == '\n')
            lines.emplace_back();
        else
            lines.back() += c;
    lines.pop_back();
    return lines;
}

// The cells of a CSV line, without quotes.
std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line)
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            cells.emplace_back();
        else
            cells.back() += c;
    return cells;
}

TEST(RdReport, WritesCsvAndJson) {
    const RdReport report = small_report();
    const auto lines = lines_of(to_csv(report));
    ASSERT_EQ(lines.size(), 1u + 10 + 1);
    const auto titles = cells_of(lines[0]);
    for (const std::string& line : lines)
        EXPECT_EQ(cells_of(line).size(), titles.size()) << line;
    const auto column = [&](const char* title) {
        return static_cast<std::size_t>(std::find(titles.begin(), titles.end(), title) -
                                        titles.begin());
    };
    EXPECT_EQ(cells_of(lines[1])[column("psnr_rgb")], "34");
    EXPECT_EQ(cells_of(lines[9])[column("psnr_rgb")], "inf");
    EXPECT_NE(cells_of(lines[10])[column("note")].find("exit code 1"), std::string::npos);
    EXPECT_NE(lines[11].find("not installed"), std::string::npos);

    const Json json = Json::parse(to_json(report).dump());
    const Json& texture = json.at("textures").at(0);
    EXPECT_EQ(texture.at("measurements").size(), 10u);
    EXPECT_EQ(texture.at("absent").at(0).at("id"), "aom");
    EXPECT_NEAR(texture.at("bd_rate").at(0).at("psnr_rgb").at("percent").get<double>(), -50, 1e-6);
    EXPECT_TRUE(texture.at("bd_rate").at(2).at("psnr_rgb").is_null());
    const auto back = measurement_from_json(texture.at("measurements").at(8));
    ASSERT_TRUE(back);
    EXPECT_TRUE(std::isinf(back->quality.psnr_rgb));
    EXPECT_FALSE(measurement_from_json(texture.at("measurements").at(9)));
}

TEST(RdReport, WritesTextAndPage) {
    const RdReport report = small_report();
    const std::string text = to_text(report), page = to_page(report);
    for (const std::string& all : {text, page}) {
        for (const char* words :
             {"-50.0 %", "Speed against error", "not installed", "exact", "exit code 1", "anchor"})
            EXPECT_NE(all.find(words), std::string::npos) << words;
    }
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_NE(page.find("a &lt;texture&gt;"), std::string::npos);
    EXPECT_EQ(page.find("<texture>"), std::string::npos);
    for (const char* link : {"src=", "href=", "url(", "@import"}) // the page is self-contained
        EXPECT_EQ(page.find(link), std::string::npos) << link;
    const std::string svg = to_svg(report.textures[0]);
    EXPECT_EQ(svg.rfind("<svg", 0), 0u);
    EXPECT_NE(svg.find(">x265<"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("as it is"), std::string::npos);
    EXPECT_EQ(svg.find(">raw<"), std::string::npos);
    EXPECT_EQ(to_svg(report.textures[0], PlotPart::close_up), ""); // it would show the whole plot
    TextureReport wide = report.textures[0];
    wide.rows.push_back(point("x265", "crf 0", 6, 60));
    const std::string close_up = to_svg(wide, PlotPart::close_up);
    EXPECT_NE(close_up.find("close up"), std::string::npos);
    EXPECT_EQ(close_up.find("crf 0"), std::string::npos);
    TextureReport empty = report.textures[0];
    empty.rows.clear();
    EXPECT_NE(to_svg(empty).find("nothing was measured"), std::string::npos);
}

TEST(RdPlot, NamesDoNotCoverEachOther) {
    std::vector<LabelledLine> lines;
    for (int i = 0; i < 18; ++i) // a narrow fan
        lines.push_back({"codec:" + std::to_string(i),
                         {{100.0 + 3 * i, 400}, {250.0 + 4 * i, 200}, {400.0 + 5 * i, 100}}});
    const PlotBox plot{0, 0, 800, 500};
    const auto places = place_labels(lines, plot);
    ASSERT_EQ(places.size(), lines.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const PlotBox& a = places[i].box;
        EXPECT_TRUE(a.x0 >= 0 && a.y0 >= 0 && a.x1 <= 800 && a.y1 <= 500);
        for (std::size_t j = 0; j < i; ++j) {
            const PlotBox& b = places[j].box;
            EXPECT_FALSE(a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1) << i << " " << j;
        }
    }
}

} // namespace
} // namespace tessera
