// The container: writing, opening, finding tiles, and refusing everything that is damaged.
#include "format/container/syntax.h"
#include "format/container/index.h"
#include "format/io/bytes.h"
#include "format/container_reader.h"
#include "format/container/container_writer.h"
#include "format/io/crc32c.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <thread>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;

class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }
    Bytes bytes(std::size_t count) {
        Bytes result(count);
        for (std::byte& b : result)
            b = static_cast<std::byte>((*this)() & 0xFF);
        return result;
    }

private:
    std::mt19937 engine_;
};

// A texture of one texel a tile, with random tiles.
struct Sample {
    std::vector<Bytes> tiles;
    Bytes code;
    ContainerContents contents;

    explicit Sample(std::vector<Bytes> tile_bytes) : tiles(std::move(tile_bytes)) {
        code = Random(1).bytes(40);
        contents.desc.size = {static_cast<std::uint32_t>(tiles.size()), 1, 1, 1};
        contents.tile_extent = {1, 1, 1, 1};
        contents.codec_parameters = code;
        contents.tile = [this](std::uint64_t tile) {
            return std::span(std::as_const(tiles)[tile]);
        };
    }
    Sample(const Sample&) = delete;
    Sample& operator=(const Sample&) = delete;

    Bytes write() const {
        Bytes out;
        VectorSink sink(out);
        const Result<std::uint64_t> size = write_container(contents, sink);
        EXPECT_TRUE(size) << size.status().message();
        EXPECT_EQ(size ? *size : 0, out.size());
        const Result<std::uint64_t> planned = container_bytes(contents);
        EXPECT_EQ(planned ? *planned : 0, out.size());
        return out;
    }
};

std::vector<Bytes> random_tiles(std::size_t count, std::uint32_t seed, bool with_large = false) {
    Random random(seed);
    std::vector<Bytes> tiles(count);
    for (Bytes& tile : tiles)
        if (random() % 4 != 0)
            tile = random.bytes(1 + random() % 300);
    if (with_large)
        for (const std::size_t length : {65535u, 65536u, 65537u, 131072u, 200000u})
            tiles[random() % count] = random.bytes(length);
    return tiles;
}

// A small file that has everything: metadata, mesh, an optional section, two groups, empty tiles.
std::unique_ptr<Sample> rich_sample() {
    std::vector<Bytes> tiles = random_tiles(12, 3);
    tiles.resize(258);
    tiles[257] = Random(4).bytes(30);
    auto sample = std::make_unique<Sample>(std::move(tiles));
    static const Bytes mesh = Random(5).bytes(20), extra = Random(6).bytes(10);
    sample->contents.description.proxy = Proxy::mesh;
    sample->contents.metadata = {{"Author", "someone"}, {"Software", "test"}};
    sample->contents.proxy_mesh = mesh;
    sample->contents.extra = {{"xtra", extra}};
    sample->contents.page_bytes = 256;
    return sample;
}

Status open_status(const Bytes& file) {
    return ContainerReader::open(*wrap_memory(file)).status();
}

bool any_fatal(const std::vector<Finding>& findings) {
    return std::ranges::any_of(findings, &Finding::fatal);
}

void expect_round_trip(const Sample& sample) {
    const Bytes file = sample.write();
    const auto source = wrap_memory(file);
    const Result<ContainerReader> reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    ASSERT_EQ(reader->tile_count(), sample.tiles.size());
    for (std::size_t i = 0; i < sample.tiles.size(); ++i) {
        Bytes plain, checked;
        ASSERT_TRUE(reader->read_tile(i, plain));
        ASSERT_TRUE(reader->read_tile_checked(i, checked));
        ASSERT_EQ(plain, sample.tiles[i]);
        ASSERT_EQ(checked, sample.tiles[i]);
        ASSERT_EQ(reader->locate(i)->length, sample.tiles[i].size());
    }
    EXPECT_TRUE(reader->validate().empty());
    EXPECT_EQ(reader->locate(sample.tiles.size()).status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(reader->group(reader->group_count()).status().code(), ErrorCode::bad_argument);
}

// ---------------------------------------------------------------- round trips

TEST(Container, RoundTripOfManySizes) {
    for (const std::size_t count : {1u, 2u, 255u, 256u, 257u, 512u, 1000u})
        expect_round_trip(Sample(random_tiles(count, static_cast<std::uint32_t>(count))));
    expect_round_trip(Sample(std::vector<Bytes>(600))); // all background: DATA is empty
    expect_round_trip(Sample({Bytes(1)}));
}

TEST(Container, RoundTripOfLargeTiles) {
    for (const std::uint32_t page_bytes : {256u, 4096u, 65536u}) {
        Sample sample(random_tiles(300, page_bytes, true));
        sample.contents.page_bytes = page_bytes;
        expect_round_trip(sample);
    }
    Sample sample(random_tiles(20, 9));
    for (const std::size_t length : {65536u, 65537u, 131072u, 131073u, 65535u})
        sample.tiles[length % 20] = Random(8).bytes(length);
    expect_round_trip(sample);
}

TEST(Container, ThousandGroups) {
    std::vector<Bytes> tiles(256 * 1000 - 3);
    for (std::size_t i = 0; i < tiles.size(); i += 97)
        tiles[i] = Bytes(1 + i % 50, static_cast<std::byte>(i & 0xFF));
    const Sample sample(std::move(tiles));
    const Bytes file = sample.write();
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->group_count(), 1000u);
    for (std::size_t i = 0; i < sample.tiles.size(); i += 89) {
        Bytes tile;
        ASSERT_TRUE(reader->read_tile_checked(i, tile));
        ASSERT_EQ(tile, sample.tiles[i]);
    }
    EXPECT_TRUE(reader->validate().empty());
}

TEST(Container, HeaderFieldsSurvive) {
    auto sample = rich_sample();
    ContainerContents& c = sample->contents;
    c.desc = {{43, 3, 2, 1}, SampleType::half16, 4};
    c.description = {Proxy::sphere,
                     SurfaceMap::sphere_longitude_latitude,
                     AngularMap::planar_views,
                     Transfer::linear,
                     Primaries::bt709,
                     AlphaMode::premultiplied,
                     {1, -2, 3.5},
                     4,
                     {5, 6}};
    c.proxy_mesh = {};
    c.colour = ColourTransform::ycocg_r;
    c.background = {0x3C00, 0, 0x7BFF, 0xBC00};
    c.required_features = feature_corrections;
    const Bytes file = sample->write();
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    EXPECT_EQ(reader->desc(), c.desc);
    EXPECT_EQ(reader->description(), c.description);
    EXPECT_EQ(reader->metadata(), c.metadata);
    EXPECT_EQ(reader->header().colour, c.colour);
    EXPECT_EQ(reader->header().background, c.background);
    EXPECT_EQ(reader->header().required_features, feature_corrections);
    EXPECT_EQ(reader->header().page_bytes(), 256u);
    EXPECT_EQ(reader->header().tile_extent, c.tile_extent);
    EXPECT_EQ(reader->grid().count(), c.desc.size);
    EXPECT_EQ(reader->levels().size(), 1u);
    EXPECT_TRUE(std::ranges::equal(reader->codec_parameters(), sample->code));
    EXPECT_TRUE(std::ranges::equal(reader->section_bytes("xtra"), c.extra[0].bytes));
    EXPECT_TRUE(reader->section_bytes("none").empty());
    EXPECT_EQ(reader->sections().size(), 7u);
    EXPECT_EQ(reader->sections()[0].type, "meta");
}

TEST(Container, SameContentsGiveSameBytes) {
    EXPECT_EQ(rich_sample()->write(), rich_sample()->write());
    auto other = rich_sample();
    other->tiles[257][0] ^= std::byte{1};
    const Bytes a = rich_sample()->write(), b = other->write();
    EXPECT_FALSE(std::equal(a.begin() + 112, a.begin() + 120, b.begin() + 112)) << "identity";
}

TEST(Container, WriterRefusesWhatAReaderWould) {
    const auto refused = [](auto change) {
        auto sample = rich_sample();
        change(sample->contents);
        Bytes out;
        VectorSink sink(out);
        const ErrorCode planned = container_bytes(sample->contents).status().code();
        const ErrorCode written = write_container(sample->contents, sink).status().code();
        return planned == ErrorCode::bad_argument && written == planned && out.empty();
    };
    EXPECT_TRUE(refused([](auto& c) { c.page_bytes = 255; }));
    EXPECT_TRUE(refused([](auto& c) { c.page_bytes = 240; }));
    EXPECT_TRUE(refused([](auto& c) { c.page_bytes = 65552; }));
    EXPECT_TRUE(refused([](auto& c) { c.tile_extent[1] = 0; }));
    EXPECT_TRUE(refused([](auto& c) { c.tile_extent = {32, 32, 32, 32}; }));
    EXPECT_TRUE(refused([](auto& c) { c.desc.size = {1u << 20, 1u << 13, 1, 1}; })) << "tiles";
    EXPECT_TRUE(refused([](auto& c) { c.desc.channels = 5; }));
    EXPECT_TRUE(refused([](auto& c) { c.required_features = 1; }));
    EXPECT_TRUE(refused([](auto& c) { c.background[3] = 1; }));
    EXPECT_TRUE(refused([](auto& c) { c.description.proxy = Proxy::none; })) << "mesh";
    EXPECT_TRUE(refused([](auto& c) { c.extra[0].type = "CODE"; }));
    EXPECT_TRUE(refused([](auto& c) { c.extra[0].type = "abc"; }));
    EXPECT_TRUE(refused([](auto& c) { c.extra.push_back(c.extra[0]); }));
    EXPECT_TRUE(refused([](auto& c) { c.metadata[""] = "x"; }));
}

TEST(Container, WriterPassesOnSinkErrors) {
    struct FullSink : ByteSink {
        Status append(std::span<const std::byte>) override { return {ErrorCode::io, "full"}; }
    } sink;
    EXPECT_EQ(write_container(rich_sample()->contents, sink).status().code(), ErrorCode::io);
}

// ---------------------------------------------------------------- reads

// A sample whose head is exactly the first read, which brings nothing else then.
void fill_head(Sample& sample) {
    sample.contents.codec_parameters = {};
    sample.code.resize(first_read_bytes - load_le<std::uint32_t>(sample.write().data() + 40));
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
    EXPECT_EQ(source.reads().size(), 3u) << "the index record is kept";
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
    EXPECT_EQ(source.reads()[1].length, reader->header().head_size - first_read_bytes);
    EXPECT_TRUE(std::ranges::equal(reader->codec_parameters(), sample.code));
}

TEST(Container, WhatTheFirstReadBringsIsNotReadAgain) {
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

// Two requests bring any neighbourhood that fits the window; loading its tiles then needs none.
TEST(Container, PrefetchTakesTwoReads) {
    for (const bool large : {false, true}) {
        Sample sample(random_tiles(1000, 15, large));
        sample.code.resize(first_read_bytes); // so that the index lies beyond what open() reads
        sample.contents.codec_parameters = sample.code;
        const Bytes file = sample.write();
        const auto memory = wrap_memory(file);
        CountingByteSource source(*memory, true);
        const auto reader = ContainerReader::open(source);
        ASSERT_TRUE(reader);
        EXPECT_TRUE(reader->wants_prefetch());
        source.reset();
        std::vector<std::uint64_t> tiles(40);
        std::iota(tiles.begin(), tiles.end(), 500); // two groups
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
        EXPECT_EQ(source.reads().size(), 2u) << "nothing is missing";
        EXPECT_EQ(*reader->prefetch({}), 0u);
        const std::uint64_t none[] = {1, 1000};
        EXPECT_EQ(reader->prefetch(none).status().code(), ErrorCode::bad_argument);
    }
}

// What is prefetched stays below what the cache holds, so that a walk reads every page once.
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

TEST(Container, ThreadsPrefetchEachPageOnce) {
    Sample sample(random_tiles(1000, 16));
    sample.code.resize(first_read_bytes); // so that the index lies beyond what open() reads
    sample.contents.codec_parameters = sample.code;
    const Bytes file = sample.write();
    const auto memory = wrap_memory(file);
    CountingByteSource source(*memory, true);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader);
    source.reset();
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
    // Not what travels: how wide the gaps between ranges are depends on what other threads claimed.
    EXPECT_EQ(source.asked(), wanted);
}

TEST(Container, PrefetchLeavesDamageToReading) {
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

// ---------------------------------------------------------------- damage

TEST(Damage, EveryTruncationIsRefused) {
    const Bytes file = rich_sample()->write();
    for (std::size_t length = 0; length < file.size(); ++length) {
        const Status status =
            open_status(Bytes(file.begin(), file.begin() + std::ptrdiff_t(length)));
        ASSERT_EQ(status.code(), ErrorCode::invalid_file) << length;
        ASSERT_NE(status.message().find("<memory>"), std::string::npos);
    }
    Bytes longer = file;
    longer.push_back(std::byte{0});
    EXPECT_EQ(open_status(longer).code(), ErrorCode::invalid_file);
}

// Whether opening the file or reading a tile with its check fails.
bool found_by_reading(const Bytes& file) {
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    if (!reader)
        return true;
    Bytes tile;
    for (std::uint64_t i = 0; i < reader->tile_count(); ++i)
        if (!reader->read_tile_checked(i, tile))
            return true;
    return false;
}

TEST(Damage, EveryFlipIsFound) {
    Bytes file = rich_sample()->write();
    ASSERT_FALSE(found_by_reading(file));
    for (std::size_t i = 0; i < file.size(); ++i)
        for (const unsigned flip : {1u << (i % 8), 0xFFu}) {
            file[i] ^= static_cast<std::byte>(flip);
            ASSERT_TRUE(found_by_reading(file)) << i;
            ASSERT_TRUE(any_fatal(validate_container(*wrap_memory(file)))) << i;
            file[i] ^= static_cast<std::byte>(flip);
        }
}

TEST(Damage, PageFindingNamesTheTiles) {
    auto sample = rich_sample();
    Bytes file = sample->write();
    file.back() ^= std::byte{1};
    const std::vector<Finding> findings = validate_container(*wrap_memory(file));
    ASSERT_EQ(findings.size(), 2u); // and the note about section xtra
    EXPECT_EQ(findings[0].number, static_cast<int>(ContainerRule::unknown_optional));
    EXPECT_FALSE(findings[0].fatal);
    EXPECT_EQ(findings[1].number, static_cast<int>(ContainerRule::page_crc));
    EXPECT_EQ(findings[1].first_tile, 257u);
    EXPECT_EQ(findings[1].tile_count, 1u);
    for (const char* words :
         {"page 0 of group 1", "tiles 257..257", "257:258,0:1,0:1,0:1", "at offset"})
        EXPECT_NE(findings[1].text.find(words), std::string::npos) << findings[1].text;
}

TEST(Damage, IndexFindingNamesTheGroup) {
    Bytes file = rich_sample()->write();
    const auto source = wrap_memory(file);
    const std::uint64_t index = ContainerReader::open(*source)->header().head_size;
    file[index] ^= std::byte{4};
    const std::vector<Finding> findings = validate_container(*source);
    ASSERT_EQ(findings.size(), 2u);
    EXPECT_EQ(findings[1].number, static_cast<int>(ContainerRule::index_crc));
    EXPECT_EQ(findings[1].tile_count, 256u);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->locate(3).status().code(), ErrorCode::invalid_file);
    EXPECT_TRUE(reader->locate(257)) << "the other group is whole";
}

TEST(Damage, PagesOfAnotherFileAreNotTaken) {
    // Same lengths, other bytes: DATA of one under the head of the other.
    auto a = rich_sample(), b = rich_sample();
    b->tiles[257] = Random(77).bytes(30);
    Bytes file = a->write();
    const Bytes other = b->write();
    ASSERT_EQ(file.size(), other.size());
    const std::uint64_t head = ContainerReader::open(*wrap_memory(file))->header().head_size;
    std::copy(other.begin() + std::ptrdiff_t(head), other.end(),
              file.begin() + std::ptrdiff_t(head));
    const auto findings = validate_container(*wrap_memory(file));
    EXPECT_EQ(
        std::ranges::count(findings, static_cast<int>(ContainerRule::index_crc), &Finding::number),
        2);
}

TEST(Damage, FindingsAreLimited) {
    Sample sample(std::vector<Bytes>(3000, Bytes(200, std::byte{1})));
    sample.contents.page_bytes = 256;
    Bytes file = sample.write();
    for (std::size_t i = file.size() - 600000; i < file.size(); i += 100)
        file[i] ^= std::byte{1};
    const auto findings = validate_container(*wrap_memory(file));
    EXPECT_EQ(findings.size(), 1001u);
    EXPECT_EQ(findings.back().number, static_cast<int>(ContainerRule::more));
}

// ---------------------------------------------------------------- hostile headers and tables

void seal_header(Bytes& file) {
    const std::size_t count = load_le<std::uint16_t>(file.data() + 44);
    const auto table = std::span(file).subspan(128, count * 24);
    store_le(file.data() + 124, crc32c(table, crc32c(std::span(file).first(124))));
}

// A valid file with other bytes in its header or section table, and a right header checksum.
template <class T> Bytes patched(std::size_t offset, T value) {
    static const Bytes good = rich_sample()->write();
    Bytes file = good;
    if constexpr (std::is_same_v<T, float>)
        store_le(file.data() + offset, std::bit_cast<std::uint32_t>(value));
    else
        store_le(file.data() + offset, value);
    seal_header(file);
    return file;
}

void expect_refused(const Bytes& file, ContainerRule rule, const std::string& word,
                    ErrorCode code = ErrorCode::invalid_file) {
    const Status status = open_status(file);
    EXPECT_EQ(status.code(), code) << word;
    EXPECT_NE(status.message().find(word), std::string::npos) << word << ": " << status.message();
    const auto findings = validate_container(*wrap_memory(file));
    ASSERT_EQ(findings.size(), 1u) << word;
    EXPECT_TRUE(findings[0].fatal);
    EXPECT_EQ(findings[0].number, static_cast<int>(rule)) << findings[0].text;
}

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;

TEST(Hostile, IdentifierAndVersion) {
    using enum ContainerRule;
    expect_refused(patched(0, u8{0x88}), identifier, "not a Tessera file");
    expect_refused(patched(8, u8{'\n'}), identifier, "transfer as text");
    expect_refused(patched(12, u16{1}), version, "version 1.1", ErrorCode::unsupported);
    expect_refused(patched(14, u16{2}), version, "version 0.2", ErrorCode::unsupported);
    expect_refused(patched(14, u16{0}), version, "version 0.0", ErrorCode::unsupported);
    Bytes file = patched(14, u16{1});
    file[124] ^= std::byte{1};
    expect_refused(file, header_crc, "checksum of the header");
    expect_refused(Bytes(127), length, "too few");
}

TEST(Hostile, Features) {
    for (const unsigned bit : {2u, 3u, 5u, 6u, 63u})
        expect_refused(patched(16, u64{1} << bit), ContainerRule::features, feature_name(bit),
                       ErrorCode::unsupported);
    EXPECT_TRUE(open_status(patched(16, u64{2})));
    expect_refused(patched(16, u64{1}), ContainerRule::header_field, "level_count");
    const auto findings = validate_container(*wrap_memory(patched(24, u64{1} << 40)));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::unknown_optional));
    EXPECT_FALSE(any_fatal(findings));
}

TEST(Hostile, FieldsOutOfRange) {
    const auto field = [](const Bytes& file, const char* word) {
        expect_refused(file, ContainerRule::header_field, word);
    };
    field(patched(40, (1u << 28) + 1), "head_size");
    field(patched(44, u16{4}), "section_count");
    field(patched(46, u16{15}), "page_target");
    field(patched(46, u16{4097}), "page_target");
    for (std::size_t axis = 0; axis < 4; ++axis) {
        field(patched(48 + 4 * axis, u32{0}), "size");
        field(patched(48 + 4 * axis, (1u << 20) + 1), "size");
        field(patched(48 + 4 * axis, 0xFFFFFFFFu), "size");
        field(patched(64 + axis, u8{0}), "tile_extent");
        field(patched(64 + axis, axis < 2 ? u8{65} : u8{33}), "tile_extent");
    }
    field(patched(64, u32{0x20202020}), "tile_extent (product)");
    field(patched(68, u8{2}), "sample_type");
    field(patched(69, u8{0}), "channels");
    field(patched(69, u8{5}), "channels");
    field(patched(70, u8{2}), "colour");
    field(patched(69, u16{0x0102}), "colour"); // two channels
    field(patched(71, u8{3}), "alpha");
    field(patched(71, u8{1}), "alpha"); // three channels
    field(patched(77, u8{0}), "level_count");
    field(patched(77, u8{2}), "level_count");
    field(patched(78, u16{1}), "reserved");
    field(patched(120, u32{1}), "reserved");
}

TEST(Hostile, GeometryOutOfRange) {
    const auto field = [](const Bytes& file, const char* word) {
        expect_refused(file, ContainerRule::header_field, word);
    };
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        field(patched(80 + 4 * axis, infinity), "sphere_centre");
        field(patched(80 + 4 * axis, nan), "sphere_centre");
    }
    field(patched(92, 1.0f), "sphere_radius"); // the proxy is a mesh
    field(patched(92, nan), "sphere_radius");
    field(patched(72, u8{1}), "sphere_radius"); // a sphere of radius 0
    field(patched(96, 1.0f), "viewing_radius"); // farther than the far one
    field(patched(96, -1.0f), "viewing_radius");
    field(patched(100, infinity), "viewing_radius");
    field(patched(100, nan), "viewing_radius");
    field(patched(104, u16{256}), "background[0]");
    field(patched(110, u16{1}), "background[3]"); // three channels
    Bytes half = patched(68, u8{1});
    store_le(half.data() + 106, u16{0x7C00});
    seal_header(half);
    field(half, "background[1]");
}

TEST(Hostile, UnknownMeaningsAreOnlyNoted) {
    for (std::size_t offset = 72; offset <= 76; ++offset) {
        const auto findings = validate_container(*wrap_memory(patched(offset, u8{200})));
        EXPECT_FALSE(any_fatal(findings)) << offset;
        EXPECT_EQ(std::ranges::count(findings, static_cast<int>(ContainerRule::unknown_value),
                                     &Finding::number),
                  1)
            << offset;
    }
    const auto findings = validate_container(*wrap_memory(patched(72, u8{0})));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::proxy_section));
}

TEST(Hostile, SizesThatOverflow) {
    // 2^80 texels; 2^48 texels in 2^48 tiles; 2^48 texels in tiles that need more groups than ROOT.
    Bytes file = patched(48, u32{1} << 20);
    for (const std::size_t offset : {52u, 56u, 60u})
        store_le(file.data() + offset, u32{1} << 20);
    seal_header(file);
    expect_refused(file, ContainerRule::header_field, "2^48");
    store_le(file.data() + 52, u32{1} << 14);
    store_le(file.data() + 56, u32{1} << 14);
    store_le(file.data() + 60, u32{1});
    seal_header(file);
    expect_refused(file, ContainerRule::levels, "LEVL");

    const auto copy_size_to_level = [&file] {
        const std::size_t entry = 128 + 2 * 24; // meta, CODE, LEVL
        const auto level = load_le<u64>(file.data() + entry + 8);
        std::copy_n(file.begin() + 48, 16, file.begin() + std::ptrdiff_t(level));
        store_le(file.data() + entry + 4, crc32c(std::span(file).subspan(level, 24)));
        seal_header(file);
    };
    copy_size_to_level();
    expect_refused(file, ContainerRule::levels, "more than 2^32 - 1");
    store_le(file.data() + 56, u32{1} << 12);
    store_le(file.data() + 64, u32{0x01202020}); // 2^31 tiles
    copy_size_to_level();
    expect_refused(file, ContainerRule::root, "ROOT");
}

// The sections of rich_sample: meta 0, CODE 1, LEVL 2, prxy 3, xtra 4, ROOT 5, INDX 6, DATA 7.
constexpr std::size_t entry_at(std::size_t section) {
    return 128 + 24 * section;
}

Bytes renamed(std::size_t section, const char* type) {
    u32 raw = 0;
    for (std::size_t i = 0; i < 4; ++i)
        raw |= u32{static_cast<unsigned char>(type[i])} << (8 * i);
    return patched(entry_at(section), raw);
}

TEST(Hostile, SectionTable) {
    using enum ContainerRule;
    expect_refused(renamed(4, "Xtra"), section_known, "\"Xtra\"", ErrorCode::unsupported);
    EXPECT_TRUE(open_status(renamed(4, "abcd"))) << "optional ones are skipped";
    expect_refused(renamed(4, "ab1d"), section_table, "four letters");
    expect_refused(renamed(4, "meta"), section_table, "twice");
    expect_refused(renamed(4, "CODE"), section_table, "twice");
    for (const std::size_t needed : {1u, 2u, 5u, 6u, 7u})
        expect_refused(renamed(needed, "none"), section_table, "missing");
    for (std::size_t section = 0; section < 8; ++section) {
        const u64 offset = load_le<u64>(patched(0, u8{0x89}).data() + entry_at(section) + 8);
        const u64 length = load_le<u64>(patched(0, u8{0x89}).data() + entry_at(section) + 16);
        for (const u64 wrong : {offset + 1, offset - 1, u64{0}, ~u64{0}, u64{1} << 63})
            expect_refused(patched(entry_at(section) + 8, wrong), section_table, "section");
        for (const u64 wrong : {length + 1, length - 1, ~u64{0}, ~u64{0} - offset, u64{1} << 63})
            expect_refused(patched(entry_at(section) + 16, wrong), section_table, "section");
        const u32 crc = load_le<u32>(patched(0, u8{0x89}).data() + entry_at(section) + 4);
        expect_refused(patched(entry_at(section) + 4, crc + 1),
                       section < 6 ? section_crc : section_table, "checksum");
    }
    expect_refused(patched(44, u16{65}), length, "65 entries");
    expect_refused(patched(40, u32{200}), section_table, "head_size");
    expect_refused(patched(32, u64{1} << 62), file_size, "cut off");
}

// Changes a byte of a section and rights all checksums above it.
Bytes with_section_byte(std::size_t section, std::size_t at, unsigned flip) {
    Bytes file = patched(0, u8{0x89});
    const auto offset = load_le<u64>(file.data() + entry_at(section) + 8);
    const auto length = load_le<u64>(file.data() + entry_at(section) + 16);
    file[offset + at] ^= static_cast<std::byte>(flip);
    store_le(file.data() + entry_at(section) + 4, crc32c(std::span(file).subspan(offset, length)));
    seal_header(file);
    return file;
}

TEST(Hostile, SectionBodies) {
    using enum ContainerRule;
    expect_refused(with_section_byte(0, 0, 2), metadata, "packing");
    for (std::size_t at = 0; at < 24; ++at)
        expect_refused(with_section_byte(2, at, 1), levels, "LEVL");
    // Groups 0 and 1 and the ends; the middle may only move within bounds, which the records see.
    for (const std::size_t at : {0u, 7u, 8u, 11u, 24u, 31u, 32u, 35u})
        expect_refused(with_section_byte(5, at, 1), root, "ROOT");
    for (const std::size_t at : {12u + 7, 12u + 11})
        expect_refused(with_section_byte(5, at, 0x80), root, "ascend");
    for (const std::size_t at : {12u, 12u + 8})
        EXPECT_TRUE(found_by_reading(with_section_byte(5, at, 1))) << at;
}

TEST(Hostile, RandomDamageWithRightChecksumsNeverCrashes) {
    Random random(99);
    for (int round = 0; round < 3000; ++round) {
        Bytes file = with_section_byte(random() % 6, random() % 10, random() % 256);
        for (unsigned flips = random() % 3; flips > 0; --flips)
            file[16 + random() % 300] ^= static_cast<std::byte>(1 << random() % 8);
        if (load_le<u16>(file.data() + 44) <= max_sections)
            seal_header(file);
        found_by_reading(file);
        validate_container(*wrap_memory(file));
    }
}

// Says it is huge and fails the test when somebody believes that.
class SparseSource : public ByteSource {
public:
    SparseSource(Bytes front, u64 size) : front_(std::move(front)), size_(size) {}
    u64 size() const override { return size_; }
    std::string name() const override { return "sparse"; }
    Status read(u64 offset, std::span<std::byte> out) override {
        largest_ = std::max<u64>(largest_, out.size());
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = offset + i < front_.size() ? front_[offset + i] : std::byte{0};
        return {};
    }
    u64 largest_ = 0;

private:
    Bytes front_;
    u64 size_;
};

TEST(Hostile, HugeIndexRecordIsNotRead) {
    // An index of 3 GiB for one group of empty tiles.
    const Sample sample(std::vector<Bytes>(3));
    Bytes file = sample.write();
    const u64 index = u64{3} << 30, head = load_le<u32>(file.data() + 40);
    store_le(file.data() + 32, head + index);
    store_le(file.data() + entry_at(3) + 16, index); // CODE LEVL ROOT INDX DATA
    store_le(file.data() + entry_at(4) + 8, head + index);
    const u64 root = load_le<u64>(file.data() + entry_at(2) + 8);
    store_le(file.data() + root, head + index);
    store_le(file.data() + root + 12, head + index);
    store_le(file.data() + root + 20, static_cast<u32>(index));
    store_le(file.data() + entry_at(2) + 4, crc32c(std::span(file).subspan(root, 24)));
    seal_header(file);
    SparseSource source(file, head + index);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader) << reader.status().message();
    const Status status = reader->locate(0).status();
    EXPECT_EQ(status.code(), ErrorCode::invalid_file);
    EXPECT_NE(status.message().find("too many"), std::string::npos) << status.message();
    EXPECT_LE(source.largest_, 16384u);
}

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
