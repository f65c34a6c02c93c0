// A journal on disk may be truncated, corrupted, exchanged or owned by another process.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/journal/journal.h"
#include "format/texture.h"
#include "tests/support/test_folder.h"

#include <atomic>
#include <fstream>

namespace tessera {
namespace {

using test::slurp;
using test::spit;

namespace fs = std::filesystem;

const TextureDesc small{{20, 12, 8, 8}, SampleType::unorm8, 3};

// A smooth texture with a little noise, so that tiles differ and none is empty.
std::vector<std::byte> make_texels(const TextureDesc& desc, unsigned seed) {
    std::vector<std::byte> texels(desc.box_bytes(Box4::whole(desc.size)));
    std::uint32_t noise = seed;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        noise = noise * 1664525u + 1013904223u;
        texels[i] = static_cast<std::byte>(100 + (i / 700) % 90 + (noise >> 28));
    }
    return texels;
}

class Journals : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("journal");
        options_.tile_extent = {8, 8, 4, 4};
        options_.effort = 1;
        options_.threads = 1;
        options_.journal = JournalUse::start;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string output() const { return (folder_ / "x.tess").string(); }
    fs::path inside(const std::string& name) const { return journal_path(output()) + "/" + name; }

    Result<EncodeReport> encode(const EncodeOptions& options) const {
        MemorySource source(small, texels_);
        return encode_file(source, output(), options);
    }
    // Cancels after `checks` calls of cancelled(). Returns false if the encode finished before.
    bool encode_in_part(EncodeOptions options, int checks) const {
        std::atomic<int> left{checks};
        options.cancelled = [&left] { return left-- <= 0; };
        const auto report = encode(options);
        EXPECT_TRUE(report || report.status().code() == ErrorCode::runtime);
        return !report && report.status().code() == ErrorCode::runtime;
    }
    std::string expected(EncodeOptions options) const {
        MemorySource source(small, texels_);
        std::vector<std::byte> bytes;
        const auto report = encode_memory(source, bytes, options);
        EXPECT_TRUE(report) << report.status().message();
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    void resume_and_compare(EncodeOptions options, const std::string& bytes) const {
        options.journal = JournalUse::resume;
        const auto report = encode(options);
        ASSERT_TRUE(report) << report.status().message();
        EXPECT_TRUE(slurp(output()) == bytes);
        EXPECT_FALSE(fs::exists(journal_path(output())));
        fs::remove(output());
    }

    fs::path folder_;
    EncodeOptions options_;
    std::vector<std::byte> texels_ = make_texels(small, 1);
};

TEST_F(Journals, LeaveNothingAfterSuccess) {
    const auto report = encode(options_);
    ASSERT_TRUE(report) << report.status().message();
    EXPECT_EQ(slurp(output()), expected(options_));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(Journals, ResumeFromEveryCancellationPoint) {
    for (const auto& [kind, value] :
         {std::pair(RateTarget::Kind::quality, 60.0), std::pair(RateTarget::Kind::psnr, 39.0),
          std::pair(RateTarget::Kind::bytes, 9000.0),
          std::pair(RateTarget::Kind::max_error, 3.0)}) {
        options_.rate = {kind, value};
        const std::string bytes = expected(options_);
        int stops = 0;
        const int step = kind == RateTarget::Kind::quality ? 5 : 31;
        for (int checks = 1; encode_in_part(options_, checks); checks += step, ++stops)
            resume_and_compare(options_, bytes);
        EXPECT_GT(stops, 5) << static_cast<int>(kind);
        EXPECT_EQ(slurp(output()), bytes);
    }
}

TEST_F(Journals, ResumeAfterRepeatedStops) {
    options_.rate = {RateTarget::Kind::psnr, 39.0};
    const std::string bytes = expected(options_);
    options_.journal = JournalUse::resume; // starts a new one if there is none
    int runs = 0;
    while (encode_in_part(options_, 100 + 15 * runs))
        ASSERT_LT(++runs, 100);
    EXPECT_GT(runs, 3);
    EXPECT_EQ(slurp(output()), bytes);
}

TEST_F(Journals, AreDeletedWithoutFinishedTiles) {
    ASSERT_TRUE(encode_in_part(options_, 1));
    EXPECT_FALSE(fs::exists(journal_path(output())));
    ASSERT_TRUE(encode_in_part(options_, 60));
    EXPECT_TRUE(fs::exists(inside("pass-1")));
    // A new start discards the old journal.
    ASSERT_TRUE(encode_in_part(options_, 1));
    EXPECT_TRUE(fs::exists(inside("pass-1"))); // but only after the input was read
    ASSERT_TRUE(encode(options_));
    EXPECT_FALSE(fs::exists(journal_path(output())));
}

TEST_F(Journals, ResumeUnderTheSameMaskOnly) {
    const auto mask_of = [](std::size_t period) {
        std::vector<std::byte> values(8 * 8);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<std::byte>(i % period != 0);
        return values;
    };
    const std::vector<std::byte> thirds = mask_of(3), fifths = mask_of(5);
    const TextureDesc directions{{1, 1, 8, 8}, SampleType::unorm8, 1};
    MemorySource mask(directions, thirds), other(directions, fifths);
    options_.mask = &mask;
    const std::string bytes = expected(options_);
    ASSERT_TRUE(encode_in_part(options_, 60));
    EncodeOptions changed = options_;
    changed.journal = JournalUse::resume;
    for (TexelSource* now :
         {static_cast<TexelSource*>(&other), static_cast<TexelSource*>(nullptr)}) {
        changed.mask = now;
        const auto refused = encode(changed);
        EXPECT_EQ(refused.status().code(), ErrorCode::bad_argument);
        EXPECT_NE(refused.status().message().find("checksum of sampled"), std::string::npos)
            << refused.status().message();
    }
    resume_and_compare(options_, bytes);
}

// Keeps a copy of a journal of an unfinished first pass, which the tests damage in many ways.
class DamagedJournals : public Journals {
protected:
    void SetUp() override {
        Journals::SetUp();
        bytes_ = expected(options_);
        ASSERT_TRUE(encode_in_part(options_, 75));
        copy_ = folder_ / "copy";
        fs::rename(journal_path(output()), copy_);
    }
    void restore() const {
        fs::remove_all(journal_path(output()));
        fs::copy(copy_, journal_path(output()));
    }
    std::string bytes_;
    fs::path copy_;
};

TEST_F(DamagedJournals, ResumeAfterTruncationAnywhere) {
    const std::string whole = slurp(copy_ / "pass-1");
    ASSERT_GT(whole.size(), 2000u);
    for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 40) {
        restore();
        spit(inside("pass-1"), whole.substr(0, length));
        resume_and_compare(options_, bytes_);
    }
    for (const std::string& tail : {std::string("TILE"), std::string(1000, '\0'), std::string("x"),
                                    whole.substr(0, 60), whole}) {
        restore();
        spit(inside("pass-1"), whole + tail);
        resume_and_compare(options_, bytes_);
    }
}

TEST_F(DamagedJournals, ResumeAfterAFlippedBitAnywhere) {
    for (const char* name : {"pass-1", "head"}) {
        const std::string whole = slurp(copy_ / name);
        for (std::size_t i = 0; i < whole.size(); i += 1 + whole.size() / 60) {
            restore();
            std::string flipped = whole;
            flipped[i] = static_cast<char>(flipped[i] ^ (1 << (i % 8)));
            spit(inside(name), flipped);
            resume_and_compare(options_, bytes_);
        }
    }
}

TEST_F(DamagedJournals, ResumeWithReorderedAndRepeatedTiles) {
    restore();
    const std::string whole = slurp(copy_ / "pass-1");
    const std::size_t first = whole.find("TILE");
    const std::size_t second = whole.find("TILE", first + 4);
    ASSERT_NE(second, std::string::npos);
    const std::string record = whole.substr(first, second - first);
    spit(inside("pass-1"), whole.substr(0, first) + whole.substr(second) + record + record);
    resume_and_compare(options_, bytes_);
}

TEST_F(DamagedJournals, AreNotUsedForAnotherTextureOrRate) {
    // The checksum of sampled texels detects other texels of the same size.
    texels_ = make_texels(small, 2);
    restore();
    options_.journal = JournalUse::resume;
    const auto refused = encode(options_);
    EXPECT_EQ(refused.status().code(), ErrorCode::bad_argument);
    EXPECT_NE(refused.status().message().find("checksum of sampled texels"), std::string::npos)
        << refused.status().message();
    EXPECT_TRUE(fs::exists(inside("pass-1")));
    EXPECT_FALSE(fs::exists(output()));
    // Tiles of one encode lie beside the head of another. The pass file records other steps, so its
    // tiles are ignored.
    options_.rate.value = 40;
    options_.journal = JournalUse::start;
    const std::string other = expected(options_);
    ASSERT_TRUE(encode_in_part(options_, 60));
    fs::remove(inside("pass-1"));
    fs::copy_file(copy_ / "pass-1", inside("pass-1"));
    resume_and_compare(options_, other);
}

TEST_F(DamagedJournals, ResumeWithDamagedFinishedPasses) {
    options_.rate = {RateTarget::Kind::bytes, 9000};
    const std::string bytes = expected(options_);
    int checks = 100;
    while (encode_in_part(options_, checks) && !fs::exists(inside("done-2")))
        checks += 50;
    ASSERT_TRUE(fs::exists(inside("done-2")));
    fs::remove_all(copy_);
    fs::rename(journal_path(output()), copy_);
    for (const char* name : {"done-1", "done-2"}) {
        const std::string whole = slurp(copy_ / name);
        for (std::size_t i = 0; i < whole.size(); i += 1 + whole.size() / 8) {
            restore();
            std::string flipped = whole;
            flipped[i] = static_cast<char>(flipped[i] ^ 4);
            spit(inside(name), flipped);
            resume_and_compare(options_, bytes);
        }
    }
    for (const char* name : {"pass-1", "pass-2"}) { // finished passes without their tiles
        restore();
        fs::remove(inside(name));
        resume_and_compare(options_, bytes);
    }
}

TEST_F(Journals, KeepUnrelatedFiles) {
    spit(journal_path(output()), "a file");
    EXPECT_EQ(encode(options_).status().code(), ErrorCode::io);
    EXPECT_EQ(slurp(journal_path(output())), "a file");
    fs::remove(journal_path(output()));
    // Unrelated files in the folder and the targets of links are kept.
    fs::create_directory(journal_path(output()));
    const auto strangers = {"notes.txt", "pass-", "pass-1b", "done-1234567890", "head.old"};
    for (const char* name : strangers)
        spit(inside(name), "mine");
    spit(folder_ / "precious", "mine");
    std::error_code no_links; // libstdc++ makes none on Windows
    fs::create_symlink(folder_ / "precious", inside("pass-1"), no_links);
    ASSERT_TRUE(encode(options_));
    for (const char* name : strangers)
        EXPECT_EQ(slurp(inside(name)), "mine") << name;
    if (no_links)
        GTEST_SKIP() << "no links here: " << no_links.message();
    EXPECT_EQ(slurp(folder_ / "precious"), "mine");
    fs::create_symlink(folder_ / "precious", inside("lock"));
    EXPECT_EQ(encode(options_).status().code(), ErrorCode::io);
    EXPECT_EQ(slurp(folder_ / "precious"), "mine");
}

// Checked here, because a pass without valid totals is repeated and the output would not show it.
TEST_F(Journals, ReturnTheTotalsOfFinishedPasses) {
    const auto journal = Journal::open(output());
    ASSERT_TRUE(journal && (*journal)->begin({{"a", "b"}}, false));
    CodingParameters parameters, others;
    others.dependent = !parameters.dependent;
    for (const double squared_error : {0.0, 0.25, 1e20}) { // 0: lossless
        PassTotals totals{squared_error, 2, 3, 4, 5, {}};
        totals.statistics.stops.back() = 6;
        totals.statistics.goes.front() = 7;
        ASSERT_TRUE((*journal)->finish(1, parameters, totals));
        const auto found = (*journal)->finished(1, parameters);
        ASSERT_TRUE(found) << squared_error;
        EXPECT_EQ(found->squared_error, squared_error);
        EXPECT_EQ(found->max_error, 2u);
        EXPECT_EQ(found->nan_count, 3u);
        EXPECT_EQ(found->infinity_count, 4u);
        EXPECT_EQ(found->file_bytes, 5u);
        EXPECT_EQ(found->statistics.stops, totals.statistics.stops);
        EXPECT_EQ(found->statistics.goes, totals.statistics.goes);
        EXPECT_FALSE((*journal)->finished(2, parameters));
        EXPECT_FALSE((*journal)->finished(1, others));
    }
    ASSERT_TRUE((*journal)->finish(1, parameters, {-1.0, 2, 3, 4, 5, {}}));
    EXPECT_FALSE((*journal)->finished(1, parameters)) << "a sum of squares is not negative";
}

TEST_F(Journals, AreKeptForOneFinishedTile) {
    for (const bool with_tile : {false, true}) {
        {
            const auto journal = Journal::open(output());
            ASSERT_TRUE(journal && (*journal)->begin({{"a", "b"}}, false));
            std::vector<CodedTile> figures(2);
            const auto store = (*journal)->pass(1, {}, figures);
            ASSERT_TRUE(store) << store.status().message();
            if (with_tile)
                ASSERT_TRUE((*store)->put(1, {}, make_texels(small, 1)));
            EXPECT_EQ((*journal)->can_resume(), with_tile);
        }
        EXPECT_EQ(fs::exists(journal_path(output())), with_tile);
        EXPECT_EQ(holds_finished_tiles(output()), with_tile);
    }
}

// Rate control makes the next store before it drops the last one.
TEST_F(Journals, KeepSeveralScratchStoresApart) {
    const auto journal = Journal::open(output());
    ASSERT_TRUE(journal && (*journal)->begin({{"a", "b"}}, false));
    const auto first = (*journal)->scratch(1), second = (*journal)->scratch(1);
    ASSERT_TRUE(first && second);
    const std::vector<std::byte> long_one = make_texels(small, 1), short_one(3, std::byte{7});
    ASSERT_TRUE((*first)->put(0, {}, long_one) && (*second)->put(0, {}, short_one));
    std::vector<std::byte> found;
    ASSERT_TRUE((*first)->get(0, found));
    EXPECT_TRUE(found == long_one);
    ASSERT_TRUE((*second)->get(0, found));
    EXPECT_TRUE(found == short_one);
}

TEST_F(Journals, AreLockedByOneProcess) {
    const auto held = Journal::open(output());
    ASSERT_TRUE(held);
    const auto report = encode(options_);
    EXPECT_EQ(report.status().code(), ErrorCode::io);
    EXPECT_NE(report.status().message().find("another process"), std::string::npos);
}

} // namespace
} // namespace tessera
