// Tests reading windows of tiles ahead while earlier ones are used.
#include "format/container/tiles_ahead.h"
#include "tests/support/vector_sink.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;

// A file with one texel per tile. The tiles' bytes do not decode, but pages check them.
Bytes file_of(const std::vector<Bytes>& tiles) {
    const Bytes code(40);
    ContainerContents contents;
    contents.desc.size = {static_cast<std::uint32_t>(tiles.size()), 1, 1, 1};
    contents.tile_extent = {1, 1, 1, 1};
    contents.codec_parameters = code;
    contents.tile = [&](std::uint64_t tile) { return std::span(tiles[tile]); };
    Bytes file;
    test::VectorSink sink(file);
    EXPECT_TRUE(write_container(contents, sink).ok());
    return file;
}

class Ahead : public testing::Test {
protected:
    Ahead() {
        for (std::size_t i = 0; i < tiles_.size(); ++i)
            tiles_[i] = Bytes(60'000, static_cast<std::byte>(i)); // 36 MB, seven windows
        file_ = file_of(tiles_);
        memory_ = wrap_memory(file_);
    }
    std::vector<Bytes> tiles_{600};
    Bytes file_;
    std::unique_ptr<ByteSource> memory_;
};

TEST_F(Ahead, ReadsEveryPageOnce) {
    CountingByteSource source(*memory_, true);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    source.reset();
    std::vector<std::uint64_t> order(tiles_.size());
    std::iota(order.rbegin(), order.rend(), 0); // in reverse order
    std::size_t windows = 0;
    {
        TilesAhead ahead(*reader, order);
        for (std::size_t done = 0; done < order.size(); ++windows) {
            const auto ready = ahead.ready(done);
            ASSERT_TRUE(ready.ok()) << ready.status().message();
            ASSERT_GT(*ready, 0u);
            if (*ready > 1) { // using a part of a window leaves the rest
                EXPECT_EQ(*ahead.ready(done + 1), *ready - 1);
            }
            for (const std::size_t end = done + *ready; done < end; ++done)
                ASSERT_TRUE(
                    std::ranges::equal(reader->load_tile(order[done])->bytes, tiles_[order[done]]));
        }
    }
    EXPECT_EQ(windows, 7u);
    std::uint64_t bytes = 0;
    for (const auto& read : source.reads())
        bytes += read.length;
    EXPECT_LE(bytes, file_.size());
    EXPECT_LE(source.reads().size(), 3 + 7 * 2u) << "more requests than needed at 4 MiB each";
}

TEST_F(Ahead, DoesNotReadAheadFromFastSources) {
    CountingByteSource source(*memory_);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok());
    source.reset();
    TilesAhead ahead(*reader, {5, 6, 7});
    EXPECT_EQ(*ahead.ready(0), 3u);
    EXPECT_EQ(*ahead.ready(2), 1u);
    EXPECT_TRUE(source.reads().empty());
}

TEST_F(Ahead, ReturnsErrorsOfTheSource) {
    // A source that opens and then fails.
    class Broken : public CountingByteSource {
    public:
        using CountingByteSource::CountingByteSource;
        Status read_many(std::span<const ReadRequest>) override {
            return {ErrorCode::io, "the line is cut"};
        }
    };
    Broken source(*memory_, true);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader.ok());
    TilesAhead ahead(*reader, {5, 6, 7});
    EXPECT_EQ(ahead.ready(0).status().message(), "the line is cut");
    EXPECT_EQ(*ahead.ready(1), 2u) << "once is enough";
    TilesAhead wrong(*reader, {600}); // no such tile
    EXPECT_EQ(wrong.ready(0).status().code(), ErrorCode::bad_argument);
}

} // namespace
} // namespace tessera
