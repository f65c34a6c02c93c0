// `tessera rd`: running the rivals' tools (replaced by scripts here), and the sweep with its cache.
#include "tests/support/rd_texture.h"
#include "tests/support/test_folder.h"
#include "tools/lab/rd/rivals.h"
#include "tools/lab/rd/subprocess.h"
#include "tools/lab/rd/sweep.h"
#include "tools/lab/rd/tessera_codec.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using test::small_texture;

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

} // namespace
} // namespace tessera
