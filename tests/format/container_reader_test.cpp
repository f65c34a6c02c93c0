// Tests how many reads a container costs, and its errors.
#include "format/container/container_writer.h"
#include "format/container/index.h"
#include "format/container/open_container.h"
#include "format/container_reader.h"
#include "format/io/bytes.h"
#include "tests/support/container_samples.h"

#include <algorithm>
#include <atomic>
#include <gtest/gtest.h>
#include <numeric>
#include <thread>

namespace tessera {
namespace {

using namespace tessera::test;

using Bytes = std::vector<std::byte>;

std::uint64_t head_bytes(const ContainerReader& reader) {
    return std::ranges::find(reader.sections(), "INDX", &SectionInfo::type)->offset;
}
std::uint64_t head_bytes(const Bytes& file) {
    return head_bytes(*ContainerReader::open(*wrap_memory(file)));
}

// Fills the sample's head to the size of the first read, which then contains nothing else.
void fill_head(Sample& sample) {
    sample.contents.codec_parameters = {};
    sample.code.resize(first_read_bytes - head_bytes(sample.write()));
    sample.contents.codec_parameters = sample.code;
}

TEST(Container, ColdTileTakesThreeReads) {
    Sample sample(random_tiles(1000, 11));
    fill_head(sample);
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    CountingByteSource source(*memory);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    ASSERT_EQ(source.reads().size(), 1u);
    EXPECT_EQ(source.reads()[0].length, first_read_bytes);
    std::uint64_t tile = 700;
    while (sample.tiles[tile].empty())
        ++tile;
    Bytes bytes;
    ASSERT_TRUE(reader->read_tile(tile, bytes));
    ASSERT_EQ(source.reads().size(), 3u);
    EXPECT_EQ(source.reads()[2].length, sample.tiles[tile].size());
    EXPECT_EQ(source.reads()[2].offset, reader->locate(tile)->offset);
    EXPECT_EQ(source.reads().size(), 3u) << "the index record is read again";
}

TEST(Container, LongHeadTakesASecondRead) {
    Sample sample(random_tiles(5, 12));
    sample.code = Random(13).bytes(50000);
    sample.contents.codec_parameters = sample.code;
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    CountingByteSource source(*memory);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader) << reader.status().message();
    ASSERT_EQ(source.reads().size(), 2u);
    EXPECT_EQ(source.reads()[1].offset, first_read_bytes);
    EXPECT_EQ(source.reads()[1].length, head_bytes(*reader) - first_read_bytes);
    EXPECT_TRUE(std::ranges::equal(reader->codec_parameters(), sample.code));
}

TEST(Container, HeadsLargerThanTheLimitAreRefused) {
    const Bytes file = rich_sample()->write();
    const auto memory = wrap_memory(file);
    const auto reader = ContainerReader::open(*memory);
    ASSERT_TRUE(reader);
    const std::uint64_t head = head_bytes(*reader);
    EXPECT_TRUE(ContainerReader::open(*memory, {.most_head_bytes = head}));
    EXPECT_EQ(ContainerReader::open(*memory, {.most_head_bytes = head - 1}).status().code(),
              ErrorCode::over_budget);
}

TEST(Container, BytesOfTheFirstReadAreNotReadAgain) {
    const Sample sample(random_tiles(5, 12));
    const Bytes file = sample.write();
    ASSERT_LT(file.size(), first_read_bytes);
    const auto memory = wrap_memory(file);
    CountingByteSource source(*memory);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    EXPECT_TRUE(reader->validate().empty());
    EXPECT_EQ(source.reads().size(), 1u);
}

TEST(Container, PagesAreReadOnce) {
    Sample sample(random_tiles(1000, 14));
    fill_head(sample);
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    CountingByteSource source(*memory);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    std::vector<std::thread> threads;
    std::atomic<std::uint64_t> next{0};
    std::atomic<int> wrong{0};
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&] {
            for (std::uint64_t tile; (tile = next++) < sample.tiles.size();) {
                const Result<TileBytes> bytes = reader->load_tile(tile);
                wrong += !bytes || !std::ranges::equal(bytes->bytes, sample.tiles[tile]);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(wrong, 0);
    std::size_t pages = 0;
    for (std::uint32_t g = 0; g < reader->group_count(); ++g)
        pages += (*reader->group(g))->pages.size();
    EXPECT_EQ(source.reads().size(), 1 + reader->group_count() + pages);
}

TEST(Container, ListsAndSumsTheTilesThatHaveBytes) {
    std::vector<Bytes> tiles = random_tiles(600, 15);
    tiles[255] = Random(16).bytes(20);
    tiles.back() = Random(17).bytes(500); // the largest tile, and the last of its group
    const Sample sample(std::move(tiles));
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    const auto reader = ContainerReader::open(*memory);
    ASSERT_TRUE(reader);
    std::vector<std::uint64_t> expected, named;
    std::uint64_t bytes = 0;
    for (std::uint64_t tile = 0; tile < sample.tiles.size(); ++tile) {
        bytes += sample.tiles[tile].size();
        if (!sample.tiles[tile].empty())
            expected.push_back(tile);
    }
    for (std::uint32_t group = 0; group < reader->group_count(); ++group) {
        const auto of_group = reader->nonempty_tiles(group);
        ASSERT_TRUE(of_group);
        named.insert(named.end(), of_group->begin(), of_group->end());
    }
    EXPECT_EQ(named, expected);
    const auto sum = reader->summarise_tiles();
    ASSERT_TRUE(sum);
    EXPECT_EQ(sum->tiles, sample.tiles.size());
    EXPECT_EQ(sum->empty, sample.tiles.size() - expected.size());
    EXPECT_EQ(sum->bytes, bytes);
    EXPECT_EQ(sum->largest, 500u);
}

// Two requests fetch any set of tiles that fits the window. Loading these tiles then reads nothing.
TEST(Container, PrefetchTakesTwoReads) {
    for (const bool large : {false, true}) {
        Sample sample(random_tiles(1000, 15, large));
        sample.code.resize(first_read_bytes); // puts the index beyond what open() reads
        sample.contents.codec_parameters = sample.code;
        const Bytes file = sample.write();
        const auto memory = wrap_memory(file);
        CountingByteSource source(*memory, true);
        const auto reader = ContainerReader::open(source);
        ASSERT_TRUE(reader);
        EXPECT_TRUE(reader->wants_prefetch());
        source.reset();
        std::vector<std::uint64_t> tiles(40);
        std::iota(tiles.begin(), tiles.end(), 500); // in two groups
        const Result<std::size_t> brought = reader->prefetch(tiles);
        ASSERT_TRUE(brought) << brought.status().message();
        EXPECT_EQ(*brought, tiles.size());
        EXPECT_EQ(source.reads().size(), 2u);
        for (const std::uint64_t tile : tiles) {
            const Result<TileBytes> bytes = reader->load_tile(tile);
            ASSERT_TRUE(bytes) << bytes.status().message();
            EXPECT_TRUE(std::ranges::equal(bytes->bytes, sample.tiles[tile]));
        }
        EXPECT_EQ(source.reads().size(), 2u);
        EXPECT_EQ(*reader->prefetch(tiles), tiles.size());
        EXPECT_EQ(source.reads().size(), 2u) << "fetched tiles are read again";
        EXPECT_EQ(*reader->prefetch({}), 0u);
        const std::uint64_t none[] = {1, 1000};
        EXPECT_EQ(reader->prefetch(none).status().code(), ErrorCode::bad_argument);
    }
}

// A prefetch stays within the cache, so that a sequential walk reads every page once.
TEST(Container, PrefetchIsBounded) {
    std::vector<Bytes> tiles(600);
    for (std::size_t i = 0; i < tiles.size(); ++i)
        tiles[i] = Bytes(60'000, static_cast<std::byte>(i)); // 36 MB
    const Sample sample(std::move(tiles));
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    CountingByteSource source(*memory, true);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    source.reset();
    std::vector<std::uint64_t> all(sample.tiles.size());
    std::iota(all.begin(), all.end(), 0);
    std::uint64_t longest = 0, windows = 0;
    for (std::size_t done = 0; done < all.size(); ++windows) {
        const auto brought = reader->prefetch(std::span(all).subspan(done));
        ASSERT_TRUE(brought);
        ASSERT_GT(*brought, 0u);
        longest = std::max<std::uint64_t>(longest, *brought * 60'000);
        const std::size_t reads = source.reads().size();
        for (const std::size_t end = done + *brought; done < end; ++done)
            ASSERT_TRUE(std::ranges::equal(reader->load_tile(done)->bytes, sample.tiles[done]));
        EXPECT_EQ(source.reads().size(), reads);
    }
    EXPECT_LE(longest, (16u << 20) / 3);
    EXPECT_EQ(windows, 7u);
    std::uint64_t bytes = 0;
    for (const auto& read : source.reads())
        bytes += read.length;
    EXPECT_LE(bytes, file.size());
}

// Counts the bytes of the requested ranges, without the gaps between them that are read, too.
class RequestedBytes : public CountingByteSource {
public:
    using CountingByteSource::CountingByteSource;
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        requested += out.size();
        return CountingByteSource::read(offset, out);
    }
    Status read_many(std::span<const ReadRequest> requests) override {
        for (const ReadRequest& request : requests)
            requested += request.out.size();
        return CountingByteSource::read_many(requests);
    }
    std::atomic<std::uint64_t> requested{0};
};

TEST(Container, ThreadsPrefetchEachPageOnce) {
    Sample sample(random_tiles(1000, 16));
    sample.code.resize(first_read_bytes); // puts the index beyond what open() reads
    sample.contents.codec_parameters = sample.code;
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    RequestedBytes source(*memory, true);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    source.requested = 0;
    std::vector<std::uint64_t> all(sample.tiles.size());
    std::iota(all.begin(), all.end(), 0);
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < 4; ++i)
        threads.emplace_back([&, i] {
            wrong += !reader->prefetch(std::span(all).subspan(i * 100));
            for (std::uint64_t tile = i * 100; tile < all.size(); ++tile) {
                const Result<TileBytes> bytes = reader->load_tile(tile);
                wrong += !bytes || !std::ranges::equal(bytes->bytes, sample.tiles[tile]);
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(wrong, 0);
    std::uint64_t wanted = 0;
    for (const SectionInfo& section : reader->sections())
        if (section.type == "INDX" || section.type == "DATA")
            wanted += section.length;
    // The gaps between ranges are not counted, because their widths depend on the other threads.
    EXPECT_EQ(source.requested, wanted);
}

TEST(Container, PrefetchIgnoresDamageThatLoadingReports) {
    const Sample sample(random_tiles(600, 17));
    const Bytes good = sample.write();
    const auto intact = wrap_memory(good);
    const auto before = ContainerReader::open(*intact);
    ASSERT_TRUE(before);
    std::uint64_t tile = 300;
    while (sample.tiles[tile].empty())
        ++tile;
    const std::uint64_t at_page = before->locate(tile)->offset;
    const auto index = std::ranges::find(before->sections(), "INDX", &SectionInfo::type);
    for (const std::uint64_t at : {at_page, index->offset + index->length - 1}) {
        Bytes bad = good;
        bad[at] ^= std::byte{1};
        const auto source = wrap_memory(bad);
        const auto reader = ContainerReader::open(*source);
        ASSERT_TRUE(reader);
        std::vector<std::uint64_t> all(sample.tiles.size());
        std::iota(all.begin(), all.end(), 0);
        EXPECT_EQ(*reader->prefetch(all), all.size());
        std::size_t damaged = 0;
        for (const std::uint64_t t : all) {
            const Result<TileBytes> bytes = reader->load_tile(t);
            damaged += !bytes;
            EXPECT_TRUE(bytes ? std::ranges::equal(bytes->bytes, sample.tiles[t])
                              : bytes.status().code() == ErrorCode::invalid_file);
        }
        EXPECT_GT(damaged, 0u);
        EXPECT_LT(damaged, all.size());
    }
}

TEST(Container, SurvivesBeingMoved) {
    const auto sample = rich_sample();
    const Bytes file = sample->write();
    const auto source = wrap_memory(file);
    auto opened = ContainerReader::open(*source);
    ASSERT_TRUE(opened);
    const ContainerReader moved = std::move(*opened);
    Bytes tile;
    ASSERT_TRUE(moved.read_tile_checked(257, tile));
    EXPECT_EQ(tile, sample->tiles[257]);
}

using u64 = std::uint64_t;

TEST(Container, ReadErrorsAreReported) {
    class Failing : public SparseSource {
    public:
        using SparseSource::SparseSource;
        Status read(u64 offset, std::span<std::byte> out) override {
            if (offset + out.size() > good)
                return {ErrorCode::io, "bad disk"};
            return SparseSource::read(offset, out);
        }
        u64 good = 0;
    };
    const Sample sample(random_tiles(1000, 21));
    const Bytes file = sample.write();
    Failing source(file, file.size());
    EXPECT_EQ(ContainerReader::open(source).status().code(), ErrorCode::io);
    EXPECT_EQ(validate_container(source).front().number, static_cast<int>(ContainerRule::readable));
    source.good = file.size() / 2;
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    Bytes out;
    EXPECT_EQ(reader->read_tile_checked(990, out).code(), ErrorCode::io);
    EXPECT_TRUE(reader->read_tile_checked(1, out));
    const auto findings = reader->validate();
    ASSERT_FALSE(findings.empty());
    for (const Finding& f : findings)
        EXPECT_EQ(f.number, static_cast<int>(ContainerRule::readable));
}

} // namespace
} // namespace tessera
