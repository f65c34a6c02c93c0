// The tiles of a pass that a later process finds in the journal. journal_test.cpp checks that
// damage does not change the output, but cannot see whether tiles were coded again.
#include "codec/journal/journal_tiles.h"
#include "tests/support/test_folder.h"

#include <cerrno>

namespace tessera {
namespace {

using Payload = std::vector<std::byte>;

class JournalFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("journal_tiles");
        path_ = (folder_ / "pass").string();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static Payload payload_of(std::size_t bytes) {
        Payload payload(bytes);
        for (std::size_t i = 0; i < bytes; ++i)
            payload[i] = static_cast<std::byte>(7 * i + bytes);
        return payload;
    }
    Result<std::unique_ptr<JournalTiles>> open(std::size_t tiles) const {
        std::vector<CodedTile> figures(tiles);
        return JournalTiles::resume(path_, pass_, figures);
    }
    // Writes tile 2, then tile 0, of 3 tiles.
    void write() const {
        const auto store = open(3);
        ASSERT_TRUE(store) << store.status().message();
        EXPECT_TRUE((*store)->put(2, large_, payload_of(300)));
        EXPECT_TRUE((*store)->put(0, small_, payload_of(1)));
        EXPECT_FALSE((*store)->has(1));
        EXPECT_TRUE((*store)->has(2));
    }
    static void expect_same(const CodedTile& a, const CodedTile& b) {
        EXPECT_EQ(a.squared_error, b.squared_error);
        EXPECT_EQ(a.levels_sum, b.levels_sum);
        EXPECT_EQ(a.max_error, b.max_error);
        EXPECT_EQ(a.nan_count, b.nan_count);
        EXPECT_EQ(a.infinity_count, b.infinity_count);
        EXPECT_EQ(a.payload_bytes, b.payload_bytes);
    }

    // All bytes of large_ differ, so that exchanged or lost bytes are noticed.
    const CodedTile large_{0x0102030405060708, 0x11121314, 0x21222324, 0x31323334, 0x41424344, 300};
    const CodedTile small_{1, 2, 3, 4, 5, 1};
    const Payload pass_ = payload_of(20);
    std::filesystem::path folder_;
    std::string path_;
};

TEST_F(JournalFile, ReturnsCompleteTiles) {
    write();
    std::vector<CodedTile> figures(3);
    const auto store = JournalTiles::resume(path_, pass_, figures);
    ASSERT_TRUE(store) << store.status().message();
    EXPECT_TRUE((*store)->has(0) && !(*store)->has(1) && (*store)->has(2));
    using std::filesystem::perms;
    EXPECT_EQ(std::filesystem::status(path_).permissions() & perms::owner_all,
              perms::owner_read | perms::owner_write);
    expect_same(figures[0], small_);
    expect_same(figures[1], {});
    expect_same(figures[2], large_);
    Payload out;
    EXPECT_TRUE((*store)->get(2, out));
    EXPECT_EQ(out, payload_of(300));
    EXPECT_TRUE((*store)->get(0, out));
    EXPECT_EQ(out, payload_of(1));
    EXPECT_EQ((*store)->get(1, out).code(), ErrorCode::bad_argument);
    (*store)->forget(2);
    EXPECT_FALSE((*store)->has(2));
}

TEST_F(JournalFile, AppendsAfterTheLastCompleteTile) {
    write();
    const std::string whole = test::slurp(path_);
    for (const std::string& torn : {whole + "TILE", whole + whole.substr(whole.size() - 40)}) {
        test::spit(path_, torn);
        std::vector<CodedTile> figures(3);
        errno = EINTR; // left by an earlier call; reaching the end is no interruption
        {
            const auto store = JournalTiles::resume(path_, pass_, figures);
            ASSERT_TRUE(store) << store.status().message();
            EXPECT_EQ(std::filesystem::file_size(path_), whole.size());
            EXPECT_TRUE((*store)->put(1, small_, payload_of(1)));
        }
        const auto again = JournalTiles::resume(path_, pass_, figures);
        ASSERT_TRUE(again) << again.status().message();
        EXPECT_TRUE((*again)->has(0) && (*again)->has(1) && (*again)->has(2));
    }
}

TEST_F(JournalFile, StartsEmptyForAnotherPass) {
    write();
    std::vector<CodedTile> figures(3);
    const auto store = JournalTiles::resume(path_, payload_of(21), figures);
    ASSERT_TRUE(store) << store.status().message();
    EXPECT_FALSE((*store)->has(0) || (*store)->has(2));
    EXPECT_EQ(std::filesystem::file_size(path_), 8u + 4 + 21 + 4);
}

// The reader ignores records of more than 16 MiB, so the writer refuses them.
TEST_F(JournalFile, RefusesTilesAbove16MiB) {
    const std::size_t longest = 16u << 20;
    Payload payload(longest + 1);
    std::vector<CodedTile> figures(1);
    {
        const auto store = open(1);
        ASSERT_TRUE(store) << store.status().message();
        EXPECT_EQ((*store)->put(0, {}, payload).code(), ErrorCode::unsupported);
        EXPECT_FALSE((*store)->has(0));
        payload.pop_back();
        EXPECT_TRUE((*store)->put(0, {}, payload));
    }
    const auto store = JournalTiles::resume(path_, pass_, figures);
    ASSERT_TRUE(store) << store.status().message();
    EXPECT_TRUE((*store)->has(0));
    EXPECT_EQ(figures[0].payload_bytes, longest);
}

TEST_F(JournalFile, HoldsTilesOnlyIfOneHasAPayload) {
    EXPECT_FALSE(JournalTiles::holds_any(path_));
    ASSERT_TRUE(open(3));
    EXPECT_FALSE(JournalTiles::holds_any(path_));
    const std::string head = test::slurp(path_);
    test::spit(path_, head + std::string(44, 'x')); // a record without payload
    EXPECT_FALSE(JournalTiles::holds_any(path_));
    write();
    EXPECT_TRUE(JournalTiles::holds_any(path_));
}

} // namespace
} // namespace tessera
