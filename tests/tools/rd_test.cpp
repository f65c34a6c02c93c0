// `tessera rd`: its figures, running the rivals' tools (replaced by scripts here), the cache of
// measurements, and the report.
#include "tests/support/test_folder.h"
#include "tools/lab/rd/bd_rate.h"
#include "tools/lab/rd/plot.h"
#include "tools/lab/rd/plot_labels.h"
#include "tools/lab/rd/rivals.h"
#include "tools/lab/rd/subprocess.h"
#include "tools/lab/rd/sweep.h"
#include "tools/lab/rd/tessera_codec.h"
#include "tools/lab/rd/view_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// --- BD-rate -------------------------------------------------------------------------------------

TEST(BdRate, HalfTheBitsIsMinus50Percent) {
    const std::vector<RatePoint> anchor = {{1, 30}, {2, 33}, {5, 37}, {9, 40}};
    std::vector<RatePoint> half = anchor;
    for (RatePoint& p : half)
        p.rate /= 2;
    const auto rate = bd_rate(anchor, half);
    ASSERT_TRUE(rate);
    EXPECT_NEAR(rate->percent, -50, 1e-9);
    EXPECT_DOUBLE_EQ(rate->low, 30);
    EXPECT_DOUBLE_EQ(rate->high, 40);
    EXPECT_NEAR(bd_rate(half, anchor)->percent, 100, 1e-9);
    EXPECT_NEAR(bd_rate(anchor, anchor)->percent, 0, 1e-12);
}

// Both curves are straight lines: log10 of the rate is (psnr - 30) / 10 and (psnr - 32) / 8. Their
// means over 34..38 dB are 0.6 and 0.5.
TEST(BdRate, IntegratesOverTheCommonInterval) {
    const std::vector<RatePoint> anchor = {
        {1, 30}, {std::pow(10, 0.4), 34}, {std::pow(10, 0.8), 38}};
    const std::vector<RatePoint> test = {{std::pow(10, 0.25), 34}, {std::pow(10, 1.25), 42}};
    const auto rate = bd_rate(anchor, test);
    ASSERT_TRUE(rate);
    EXPECT_DOUBLE_EQ(rate->low, 34);
    EXPECT_DOUBLE_EQ(rate->high, 38);
    EXPECT_NEAR(rate->percent, (std::pow(10, 0.5 - 0.6) - 1) * 100, 1e-9);
}

// Test data of the package bjontegaard (FAU Erlangen). The expected value comes from an independent
// program that sums 200,000 samples of the curves.
TEST(BdRate, AgreesWithAnIndependentProgram) {
    const auto rate =
        bd_rate({{9487.76, 40.037}, {4593.60, 38.615}, {2486.44, 36.845}, {1358.24, 34.851}},
                {{9787.80, 40.121}, {4469.00, 38.651}, {2451.52, 36.970}, {1356.24, 34.987}});
    ASSERT_TRUE(rate);
    EXPECT_NEAR(rate->percent, -4.41748535, 1e-6);
}

TEST(BdRate, IgnoresDominatedAndLosslessPoints) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<RatePoint> anchor = {{1, 30}, {2, 35}, {4, 40}};
    // Rate 3 at 33 dB is worse than rate 2 at 35 dB. The lossless point is not part of the curve.
    const auto rate = bd_rate(anchor, {{4, 40}, {1, 30}, {3, 33}, {2, 35}, {9, inf}});
    ASSERT_TRUE(rate);
    EXPECT_NEAR(rate->percent, 0, 1e-9);
    EXPECT_FALSE(bd_rate(anchor, {{1, 35}}));
    EXPECT_FALSE(bd_rate(anchor, {{1, 41}, {2, 45}}));
    EXPECT_FALSE(bd_rate(anchor, {{1, 40}, {2, 45}}));
    EXPECT_FALSE(bd_rate(anchor, {{2, 33}, {1, 36}}));
    EXPECT_FALSE(bd_rate({}, anchor));
}

// --- a small texture -----------------------------------------------------------------------------

RdTexture small_texture(const Extent4& size = {8, 6, 5, 4}) {
    RdTexture texture;
    texture.name = "small, \"odd\".rgb";
    texture.label = "small";
    texture.desc = {size, SampleType::unorm8, 3};
    texture.texels.resize(texture.texel_count() * 3, std::byte{128});
    for (std::size_t i = 0; i < texture.texels.size() / 3; ++i) // three in four are background
        if (i % 4 == 0)
            for (std::size_t c = 0; c < 3; ++c)
                texture.texels[3 * i + c] = std::byte(static_cast<std::uint8_t>(i * (c + 3) % 200));
    describe_texels(texture);
    return texture;
}

TEST(RdQuality, ComputesEveryMeasure) {
    const RdTexture texture = small_texture();
    EXPECT_EQ(texture.background, std::vector<std::byte>(3, std::byte{128}));
    auto decoded = texture.texels;
    QualityMeter meter(texture, 2);
    const auto exact = meter.measure(decoded);
    ASSERT_TRUE(exact.ok());
    EXPECT_TRUE(std::isinf(exact->psnr_rgb) && std::isinf(*exact->psnr_yuv));
    EXPECT_FALSE(exact->psnr_rendered || exact->psnr_pu21);

    // One green sample of a foreground texel of view (3, 2) is off by 10.
    const std::size_t view = 2 * 5 + 3, index = 20 * (4 * 8 + 5) + view;
    std::size_t foreground = 0;
    for (std::size_t i = 0; i < texture.texel_count(); ++i)
        foreground += i % 4 == 0;
    const std::size_t at = index - index % 4; // a foreground texel, maybe of another view
    decoded[3 * at + 1] =
        std::byte(static_cast<std::uint8_t>(std::to_integer<int>(decoded[3 * at + 1]) + 10));
    const auto q = meter.measure(decoded);
    ASSERT_TRUE(q.ok());
    const double texels = static_cast<double>(texture.texel_count());
    EXPECT_NEAR(q->psnr_rgb, psnr_of(100 / (texels * 3), 255), 1e-9);
    EXPECT_NEAR(q->psnr_worst_view, psnr_of(100 / (48.0 * 3), 255), 1e-9);
    EXPECT_EQ(q->worst_t * 5 + q->worst_s, at % 20);
    EXPECT_NEAR(*q->psnr_foreground, psnr_of(100 / (static_cast<double>(foreground) * 3), 255),
                1e-9);
    EXPECT_EQ(q->max_error, 10u);
    const double dy = 7.152, db = dy / 1.8556, dr = dy / 1.5748;
    const double yuv = (6 * psnr_of(dy * dy / texels, 255) + psnr_of(db * db / texels, 255) +
                        psnr_of(dr * dr / texels, 255)) /
                       8;
    EXPECT_NEAR(*q->psnr_yuv, yuv, 1e-9);
    EXPECT_FALSE(meter.measure(std::span(decoded).first(3)).ok());
}

TEST(RdQuality, DrawsViewsOfASphere) {
    RdTexture texture = small_texture();
    texture.window = SphereWindow{};
    auto decoded = texture.texels;
    QualityMeter meter(texture, 2);
    EXPECT_TRUE(std::isinf(*meter.measure(decoded)->psnr_rendered));
    for (std::byte& sample : decoded)
        sample ^= std::byte{16};
    const double psnr = *meter.measure(decoded)->psnr_rendered;
    EXPECT_GT(psnr, 20);
    EXPECT_LT(psnr, 60);
}

TEST(RdQuality, HalfFloatsHaveTheirOwnMeasures) {
    RdTexture texture = small_texture();
    texture.desc.type = SampleType::half16;
    texture.texels.assign(texture.texel_count() * 6, std::byte{0x3C}); // about 1.06
    describe_texels(texture);
    auto decoded = texture.texels;
    decoded[0] = std::byte{0x3D}; // one ulp
    const auto q = QualityMeter(texture, 1).measure(decoded);
    ASSERT_TRUE(q.ok());
    EXPECT_EQ(q->max_error, 1u);
    EXPECT_TRUE(q->psnr_pu21 && q->psnr_log2);
    EXPECT_FALSE(q->psnr_yuv || q->psnr_foreground); // there is no foreground
}

TEST(RdLayout, ViewsSurviveARoundTrip) {
    const RdTexture texture = small_texture();
    const auto order = serpentine(texture.desc.size);
    ASSERT_EQ(order.size(), 20u);
    EXPECT_EQ(order[4].s, 4u);
    EXPECT_EQ(order[5].s, 4u); // the second row runs backwards
    EXPECT_EQ(order[5].t, 1u);
    EXPECT_EQ(order[10].s, 0u);

    std::vector<std::byte> back(texture.texels.size());
    store_mosaic(mosaic_picture(texture), texture.desc.size, back);
    EXPECT_EQ(back, texture.texels);

    // Ten bits hold YCgCo exactly; eight bits round it.
    for (const auto& [samples, width, limit] :
         {std::tuple(VideoSamples::bits8, 1u, 2), std::tuple(VideoSamples::bits10, 2u, 0)}) {
        const auto video = video_of(texture, samples);
        EXPECT_EQ(video.size(), width * texture.texels.size());
        back.assign(back.size(), std::byte{0});
        store_video(video, samples, texture.desc.size, back);
        int worst = 0;
        for (std::size_t i = 0; i < back.size(); ++i)
            worst = std::max(worst, std::abs(std::to_integer<int>(back[i]) -
                                             std::to_integer<int>(texture.texels[i])));
        EXPECT_LE(worst, limit);
    }
}

// --- the rivals' tools ---------------------------------------------------------------------------

// PATH consists of one folder of scripts, which replace the rivals' tools.
class RdTools : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("rd");
        fs::create_directories(folder_ / "bin");
        path_ = std::getenv("PATH");
        setenv("PATH", (folder_ / "bin").c_str(), 1);
    }
    void TearDown() override {
        setenv("PATH", path_.c_str(), 1);
        fs::remove_all(folder_);
    }
    void script(const std::string& name, const std::string& body) const {
        const fs::path file = folder_ / "bin" / name;
        std::ofstream(file) << "#!/bin/sh\n" << body << "\n";
        fs::permissions(file, fs::perms::owner_all);
    }
    SweepOptions options() const {
        SweepOptions o;
        o.threads = 2;
        o.timeout = 5;
        o.cache = (folder_ / "cache").string();
        return o;
    }
    std::size_t kept() const {
        std::size_t count = 0;
        if (fs::exists(folder_ / "cache"))
            for (const auto& entry : fs::directory_iterator(folder_ / "cache"))
                count += entry.path().extension() == ".json";
        return count;
    }
    fs::path folder_;
    std::string path_;
};

TEST_F(RdTools, RunsToolsAndCapturesTheirOutput) {
    script("well", "echo \"$2\"; echo two >&2");
    script("badly", "echo first; echo 'no such codec' >&2; exit 3");
    script("dead", "kill -9 $$");
    const auto run = run_tool({"well", "a b", "$(no shell)"}, 5);
    ASSERT_TRUE(run.ok()) << run.status().message();
    EXPECT_EQ(run->exit_code, 0);
    EXPECT_EQ(run->said, "$(no shell)\ntwo\n");
    EXPECT_EQ(run_tool({"badly"}, 5)->exit_code, 3);
    const Status failed = run_tool_well({"badly"}, 5).status();
    EXPECT_EQ(failed.code(), ErrorCode::runtime);
    EXPECT_EQ(failed.message(), "badly: exit code 3: no such codec");
    EXPECT_NE(run_tool({"dead"}, 5).status().message().find("signal 9"), std::string::npos);
    EXPECT_EQ(run_tool({"absent"}, 5).status().code(), ErrorCode::io);
    EXPECT_TRUE(find_tool("well"));
    EXPECT_FALSE(find_tool("absent"));
}

TEST_F(RdTools, KillsToolsAtTheTimeout) {
    script("slow", "/bin/sleep 30 & /bin/sleep 30");
    script("quiet", "exec >/dev/null 2>&1; /bin/sleep 30");
    for (const char* tool : {"slow", "quiet"}) {
        const auto begun = std::chrono::steady_clock::now();
        const auto run = run_tool({tool}, 0.3);
        EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
        EXPECT_EQ(run.status().message(), std::string(tool) + ": timed out after 0 s");
    }
}

TEST_F(RdTools, ListsMissingTools) {
    const auto all = rivals_named("all");
    ASSERT_TRUE(all.ok());
    const RivalChoice choice = choose_rivals(*all, small_texture().desc);
    EXPECT_EQ(choice.present.size() + choice.absent.size(), all->size());
    ASSERT_EQ(choice.present.size(), 2u); // the built-in rivals
    EXPECT_EQ(choice.present[0].id, "exr:dwaa");
    EXPECT_EQ(choice.present[1].id, "raw");
    for (const RivalChoice::Absent& absent : choice.absent) {
        EXPECT_NE(absent.reason.find("not installed: "), std::string::npos) << absent.id;
        EXPECT_NE(absent.reason.find("install-rivals.sh"), std::string::npos) << absent.id;
    }
    TextureDesc hdr = small_texture().desc;
    hdr.type = SampleType::half16;
    const RivalChoice for_hdr = choose_rivals(*all, hdr);
    EXPECT_EQ(for_hdr.absent[0].id, "x265");
    EXPECT_NE(for_hdr.absent[0].reason.find("not applicable: it takes 8-bit"), std::string::npos);
    EXPECT_TRUE(rivals_named("none")->empty());
    EXPECT_EQ(rivals_named("zfp:rate,raw")->size(), 2u);
    const auto unknown = rivals_named("x264");
    EXPECT_EQ(unknown.status().code(), ErrorCode::bad_argument);
    EXPECT_NE(unknown.status().message().find("x265"), std::string::npos);
}

TEST_F(RdTools, AFailingToolGetsARowWithTheReason) {
    const RdTexture texture = small_texture();
    const struct {
        const char* body;
        const char* says;
    } cases[] = {
        {"echo 'v1.2.3'; echo 'cannot do this' >&2; exit 7", "zfp: exit code 7: cannot do this"},
        {"exit 0", "plane0.zfp: was not written"},
        // Writes garbage to the output file, both when encoding and when decoding.
        {"while [ \"$1\" != -z ]; do shift; done; [ \"$3\" != -o ] || shift 2; echo garbage "
         ">\"$2\"",
         "a different size"},
        {"[ $# = 0 ] || /bin/sleep 30", "zfp: timed out after 1 s"}};
    for (const auto& c : cases) {
        script("zfp", c.body);
        RivalChoice choice = choose_rivals(*rivals_named("zfp:rate"), texture.desc);
        ASSERT_EQ(choice.present.size(), 1u);
        choice.present[0].version = "zfp 1";
        choice.present[0].settings.resize(1);
        SweepOptions o = options();
        o.timeout = 1;
        const auto rows = sweep(texture, choice.present, o);
        ASSERT_TRUE(rows.ok()) << rows.status().message();
        ASSERT_EQ(rows->size(), 1u);
        EXPECT_NE((*rows)[0].failed.find(c.says), std::string::npos) << (*rows)[0].failed;
    }
    EXPECT_EQ(kept(), 0u); // failures are not cached, so that the next run tries again
}

TEST_F(RdTools, ReadsVersions) {
    script("astcenc", "[ $1 = -version ] && echo 'astcenc v4.2.0, 64-bit AVX2'");
    script("zfp", "echo 'zfp version 1.0.0 (August 1, 2022)'; exit 1");
    const RivalChoice choice = choose_rivals(*rivals_named("astc,zfp:rate"), small_texture().desc);
    ASSERT_EQ(choice.present.size(), 2u);
    EXPECT_EQ(choice.present[0].version, "astcenc 4.2.0");
    EXPECT_EQ(choice.present[1].version, "zfp 1.0.0");
}

// The scripts copy the picture, so AVIF is lossless here.
TEST_F(RdTools, ComparesTwoChannelsWithPlanesOfAvif) {
    script("avifenc", "[ \"$1\" = --version ] && { echo 'Version: 1.0.1'; exit; }\n"
                      "[ \"$1 $2\" = '--cicp 1/13/0' ] || exit 3\n"
                      "for out; do in=$last; last=$out; done; exec /bin/cp \"$in\" \"$out\"");
    script("avifdec", "for out; do in=$last; last=$out; done; exec /bin/cp \"$in\" \"$out\"");
    RdTexture normals = small_texture({16, 12, 1, 1});
    normals.desc.channels = 2;
    normals.texels.resize(normals.texel_count() * 2);
    describe_texels(normals);
    const RivalChoice choice = choose_rivals(*rivals_named("avif,avif:planes"), normals.desc);
    ASSERT_EQ(choice.absent.size(), 1u); // avif takes three channels
    EXPECT_EQ(choice.absent[0].id, "avif");
    ASSERT_EQ(choice.present.size(), 1u);
    EXPECT_EQ(choice.present[0].version, "avifenc 1.0.1");
    for (const unsigned channels : {2u, 3u}) {
        const RdTexture texture = channels == 2 ? normals : small_texture({16, 12, 1, 1});
        const auto rows = sweep(texture, choice.present, options());
        ASSERT_TRUE(rows.ok()) << rows.status().message();
        ASSERT_EQ((*rows)[0].failed, "");
        EXPECT_TRUE(std::isinf((*rows)[0].quality.psnr_rgb)) << channels;
    }
    normals.desc.channels = 4;
    EXPECT_NE(choose_rivals(*rivals_named("avif:planes"), normals.desc)
                  .absent[0]
                  .reason.find("4 channels"),
              std::string::npos);
}

// --- the sweep and its cache ---------------------------------------------------------------------

// A codec with known PSNR: it adds `setting` to every sample. Counts its runs.
CodecUnderTest adding_codec(int& runs, std::vector<std::string> settings) {
    CodecUnderTest codec;
    codec.id = "adding";
    codec.version = "1";
    codec.settings = std::move(settings);
    codec.run = [&runs](const CodingJob& job, const std::string& setting) -> Result<Coded> {
        ++runs;
        Coded coded;
        coded.texels = job.texture.texels;
        const int error = std::stoi(setting);
        if (error < 0)
            return Status(ErrorCode::runtime, "does not add " + setting);
        for (std::byte& sample : coded.texels)
            sample = std::byte(static_cast<std::uint8_t>(std::to_integer<int>(sample) + error));
        coded.bytes = static_cast<std::uint64_t>(1000 / (error + 1));
        coded.encode_seconds = coded.decode_seconds = 0.5;
        return coded;
    };
    return codec;
}

TEST_F(RdTools, ContinuesWhereItStopped) {
    const RdTexture texture = small_texture();
    int runs = 0;
    const auto first = sweep(texture, {adding_codec(runs, {"4", "2"})}, options());
    ASSERT_TRUE(first.ok());
    EXPECT_EQ(runs, 2);
    EXPECT_EQ(kept(), 2u);
    EXPECT_NEAR((*first)[0].quality.psnr_rgb, psnr_of(16, 255), 1e-9);
    EXPECT_NEAR((*first)[0].bits_per_texel, 200 * 8 / 960.0, 1e-9);

    std::vector<bool> cached;
    SweepOptions o = options();
    o.done = [&](const Measurement& m, std::size_t, std::size_t) { cached.push_back(m.cached); };
    const auto second = sweep(texture, {adding_codec(runs, {"4", "3", "2", "-1"})}, o);
    ASSERT_TRUE(second.ok());
    EXPECT_EQ(runs, 4);
    EXPECT_EQ(cached, std::vector<bool>({true, false, true, false}));
    EXPECT_EQ(kept(), 3u);
    for (const Measurement& m : *second)
        if (m.setting == "4") {
            EXPECT_EQ(m.quality.psnr_rgb, (*first)[0].quality.psnr_rgb);
            EXPECT_EQ(m.bytes, 200u);
        }

    // Measures again for another version, another texture and a damaged cache.
    CodecUnderTest newer = adding_codec(runs, {"4"});
    newer.version = "2";
    ASSERT_TRUE(sweep(texture, {newer}, options()).ok());
    EXPECT_EQ(runs, 5);
    RdTexture other = texture;
    other.texels[0] ^= std::byte{1};
    describe_texels(other);
    ASSERT_TRUE(sweep(other, {adding_codec(runs, {"4"})}, options()).ok());
    EXPECT_EQ(runs, 6);
    for (const auto& entry : fs::directory_iterator(folder_ / "cache"))
        fs::resize_file(entry.path(), 20);
    ASSERT_TRUE(sweep(texture, {adding_codec(runs, {"4"})}, options()).ok());
    EXPECT_EQ(runs, 7);
    ASSERT_TRUE(sweep(texture, {adding_codec(runs, {"4"})}, options()).ok());
    EXPECT_EQ(runs, 7);
}

TEST_F(RdTools, AddsSettingsToCoverThePsnrsOfInterest) {
    int runs = 0;
    CodecUnderTest codec = adding_codec(runs, {"3", "2"}); // 38.6 and 42.1 dB
    codec.coarser = {"6", "20", "40"};                     // 32.6 dB
    codec.finer = {"1", "0"};
    SweepOptions o = options();
    o.low_psnr = 34;
    o.high_psnr = 48; // 1 reaches 48.1 dB
    const auto rows = sweep(small_texture(), {codec}, o);
    ASSERT_TRUE(rows.ok());
    std::string order;
    for (const Measurement& m : *rows)
        order += m.setting + " ";
    EXPECT_EQ(order, "6 3 2 1 ");
}

TEST_F(RdTools, AddsSettingsToCoverTheRangeOfTheFirstCodec) {
    int runs = 0;
    const CodecUnderTest ours = adding_codec(runs, {"6", "1"}); // 32.6 and 48.1 dB
    CodecUnderTest other = adding_codec(runs, {"3", "2"});      // enough for the usual 36 to 42 dB
    other.id = "other";
    other.coarser = {"6", "20"};
    other.finer = {"1", "0"};
    SweepOptions o = options();
    o.low_psnr = 39;
    o.high_psnr = 42;
    const auto alone = sweep(small_texture(), {other}, o);
    ASSERT_TRUE(alone.ok());
    EXPECT_EQ(alone->size(), 2u);
    const auto rows = sweep(small_texture(), {ours, other}, o);
    ASSERT_TRUE(rows.ok());
    std::string order;
    for (const Measurement& m : *rows)
        order += m.codec + " " + m.setting + " ";
    EXPECT_EQ(order, "adding 6 adding 1 other 6 other 3 other 2 other 1 ");
}

TEST_F(RdTools, MeasuresTessera) {
    const RdTexture texture = small_texture({16, 16, 8, 8});
    const auto rows = sweep(texture, {tessera_codec(1, {"quality 40", "psnr 45"})}, options());
    ASSERT_TRUE(rows.ok());
    ASSERT_EQ(rows->size(), 2u);
    for (const Measurement& m : *rows) {
        ASSERT_EQ(m.failed, "");
        EXPECT_GT(*m.view_bytes, 0);
        EXPECT_LE(*m.texel_bytes, static_cast<double>(m.bytes));
        EXPECT_GT(m.decode_mbs, 0);
    }
    EXPECT_NEAR((*rows)[1].quality.psnr_rgb, 45, 0.5);
}

// --- the report ----------------------------------------------------------------------------------

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
