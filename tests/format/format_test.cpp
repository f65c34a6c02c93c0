// The small parts of format/: bits, checksums, tiles, pages, metadata, files.
#include "format/io/bit_reader.h"
#include "format/io/bit_writer.h"
#include "format/byte_source.h"
#include "format/io/crc32c.h"
#include "format/container/index.h"
#include "format/output_file.h"
#include "format/container/syntax.h"
#include "format/levels.h"
#include "tests/support/test_folder.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

namespace tessera {
namespace {

// std::mt19937 yields 64-bit integers on some systems.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }

private:
    std::mt19937 engine_;
};

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

std::vector<std::byte> random_bytes(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    std::vector<std::byte> bytes(count);
    for (std::byte& b : bytes)
        b = static_cast<std::byte>(random() & 0xFF);
    return bytes;
}

// ---------------------------------------------------------------- bits

TEST(Bits, FirstBitIsLowest) {
    BitWriter writer;
    writer.bits(1, 1);
    writer.bits(0b10, 2);
    writer.bits(0x1FF, 9);
    EXPECT_EQ(writer.position(), 12u);
    const std::vector<std::byte> bytes = writer.take();
    ASSERT_EQ(bytes.size(), 2u);
    EXPECT_EQ(bytes[0], std::byte{0b11111101});
    EXPECT_EQ(bytes[1], std::byte{0b00001111});
    EXPECT_TRUE(writer.take().empty());
}

TEST(Bits, RandomRoundTrip) {
    Random random(1);
    std::vector<std::pair<std::uint32_t, unsigned>> fields;
    BitWriter writer;
    for (int i = 0; i < 20000; ++i) {
        const unsigned count = random() % 33;
        const std::uint32_t value = random();
        fields.emplace_back(value & static_cast<std::uint32_t>((1ull << count) - 1), count);
        writer.bits(value, count);
    }
    const std::uint64_t bits = writer.position();
    const std::vector<std::byte> bytes = writer.take();
    EXPECT_EQ(bytes.size(), (bits + 7) / 8);
    BitReader reader(bytes);
    for (const auto& [value, count] : fields)
        ASSERT_EQ(reader.bits(count), value);
    EXPECT_EQ(reader.position(), bits);
    EXPECT_TRUE(reader.align());
    EXPECT_FALSE(reader.overrun());
    EXPECT_TRUE(reader.rest().empty());
}

TEST(Bits, OnesStopAtZeroAndAtLimit) {
    BitWriter writer;
    writer.ones(3);
    writer.bits(0, 1);
    writer.bits(0, 1);
    writer.ones(32);
    const std::vector<std::byte> bytes = writer.take();
    BitReader reader(bytes);
    EXPECT_EQ(reader.ones(24), 3u);
    EXPECT_EQ(reader.ones(24), 0u);
    EXPECT_EQ(reader.ones(24), 24u);
    EXPECT_EQ(reader.ones(32), 8u); // and its 0
    EXPECT_EQ(reader.position(), 5u + 24 + 9);
}

TEST(Bits, ReadingPastTheEndYieldsZerosAndIsReported) {
    const std::vector<std::byte> bytes(3, std::byte{0xFF});
    BitReader reader(bytes);
    EXPECT_EQ(reader.bits(20), 0xFFFFFu);
    EXPECT_FALSE(reader.overrun());
    EXPECT_EQ(reader.bits(32), 0xFu);
    EXPECT_TRUE(reader.overrun());
    EXPECT_EQ(reader.bits(32), 0u);
    EXPECT_EQ(reader.ones(32), 0u);
    EXPECT_TRUE(reader.rest().empty());
    EXPECT_FALSE(BitReader({}).bit());
}

TEST(Bits, AlignReportsOnes) {
    const std::vector<std::byte> bytes = {std::byte{0x01}, std::byte{0x81}};
    BitReader reader(bytes);
    reader.bit();
    EXPECT_TRUE(reader.align());
    EXPECT_EQ(reader.position(), 8u);
    reader.bit();
    EXPECT_FALSE(reader.align());
}

// ---------------------------------------------------------------- checksums

TEST(Crc32c, KnownVectors) {
    EXPECT_EQ(crc32c(bytes_of("123456789")), 0xE3069283u);
    EXPECT_EQ(crc32c_portable(bytes_of("123456789")), 0xE3069283u);
    EXPECT_EQ(crc32c({}), 0u);
    // RFC 3720, B.4.
    EXPECT_EQ(crc32c(std::vector(32, std::byte{0})), 0x8A9136AAu);
    EXPECT_EQ(crc32c(std::vector(32, std::byte{0xFF})), 0x62A8AB43u);
}

TEST(Crc32c, TablesAndInstructionAgreeAndChain) {
    const std::vector<std::byte> bytes = random_bytes(300, 2);
    for (std::size_t first = 0; first < 20; ++first)
        for (std::size_t count = 0; first + count <= bytes.size(); ++count) {
            const auto part = std::span(bytes).subspan(first, count);
            const std::uint32_t crc = crc32c(part);
            ASSERT_EQ(crc, crc32c_portable(part));
            ASSERT_EQ(crc, crc32c(part.subspan(count / 3), crc32c(part.first(count / 3))));
        }
}

// ---------------------------------------------------------------- tiles

TEST(TileGrid, BalancedAlongAnAxis) {
    for (std::uint32_t size = 1; size <= 70; ++size)
        for (std::uint32_t largest = 1; largest <= 32; ++largest) {
            const TileGrid grid({size, 1, 1, 1}, {largest, 1, 1, 1});
            std::uint32_t at = 0, smallest = size, widest = 0;
            for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
                const Box4 box = grid.box(tile);
                ASSERT_EQ(box.begin[axis_u], at);
                at = box.end[axis_u];
                smallest = std::min(smallest, box.extent()[axis_u]);
                widest = std::max(widest, box.extent()[axis_u]);
            }
            ASSERT_EQ(at, size);
            ASSERT_LE(widest, largest);
            ASSERT_LE(widest - smallest, 1u);
            ASSERT_EQ(grid.tiles(), (size + largest - 1) / largest);
        }
}

TEST(TileGrid, EveryTexelOnceInTileOrder) {
    const Extent4 size{7, 5, 9, 4};
    const TileGrid grid(size, {3, 2, 8, 3});
    EXPECT_EQ(grid.count(), (Extent4{3, 3, 2, 2}));
    std::vector<int> hits(texel_count(size));
    for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
        EXPECT_EQ(grid.number(grid.coordinates(tile)), tile);
        const Box4 b = grid.box(tile);
        ASSERT_TRUE(is_inside(b, size));
        for (auto u = b.begin[0]; u < b.end[0]; ++u)
            for (auto v = b.begin[1]; v < b.end[1]; ++v)
                for (auto s = b.begin[2]; s < b.end[2]; ++s)
                    for (auto t = b.begin[3]; t < b.end[3]; ++t)
                        ++hits[((v * size[0] + u) * size[3] + t) * size[2] + s];
    }
    EXPECT_EQ(std::ranges::count(hits, 1), static_cast<std::ptrdiff_t>(hits.size()));
    EXPECT_EQ(grid.coordinates(1), (Extent4{1, 0, 0, 0})); // u is fastest
}

TEST(TileGrid, TouchedIsWhatMeets) {
    Random random(3);
    for (int round = 0; round < 300; ++round) {
        Extent4 size, largest;
        Box4 box;
        for (int axis = 0; axis < 4; ++axis) {
            size[axis] = 1 + random() % 12;
            largest[axis] = 1 + random() % 5;
            box.begin[axis] = random() % size[axis];
            box.end[axis] = box.begin[axis] + 1 + random() % (size[axis] - box.begin[axis]);
        }
        const TileGrid grid(size, largest);
        std::vector<std::uint64_t> expected, visited;
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile)
            if (intersect(grid.box(tile), box).texels() > 0)
                expected.push_back(tile);
        grid.for_each(grid.touched(box), [&](std::uint64_t tile) { visited.push_back(tile); });
        ASSERT_EQ(visited, expected);
    }
}

TEST(TileGrid, LargestSizes) {
    const TileGrid grid({max_extent, max_extent, 256, 1}, {32, 32, 8, 8});
    EXPECT_EQ(grid.tiles(), std::uint64_t{32768} * 32768 * 32);
    const Box4 last = grid.box(grid.tiles() - 1);
    EXPECT_EQ(last.end, grid.size());
    EXPECT_EQ(grid.number(grid.coordinates(grid.tiles() - 1)), grid.tiles() - 1);
}

// ---------------------------------------------------------------- pages and records

// The rule of 1.4 read word for word, byte by byte.
std::vector<std::uint32_t> pages_word_for_word(const std::vector<std::uint32_t>& tiles,
                                               std::uint64_t target) {
    std::vector<std::uint32_t> pages;
    std::uint64_t p = 0;
    for (std::uint64_t n : tiles) {
        if (n > 65536) {
            if (p > 0)
                pages.push_back(static_cast<std::uint32_t>(p));
            p = 0;
            while (n >= 65536) {
                pages.push_back(65536);
                n -= 65536;
            }
            if (n > 0)
                pages.push_back(static_cast<std::uint32_t>(n));
        } else {
            if (p > 0 && p + n > target) {
                pages.push_back(static_cast<std::uint32_t>(p));
                p = 0;
            }
            p += n;
        }
    }
    if (p > 0)
        pages.push_back(static_cast<std::uint32_t>(p));
    return pages;
}

std::vector<std::uint32_t> random_lengths(Random& random, std::size_t count) {
    std::vector<std::uint32_t> lengths(count);
    const std::uint32_t scale = 1u << (random() % 17);
    for (std::uint32_t& length : lengths)
        switch (random() % 8) {
        case 0:
            length = 0;
            break;
        case 1:
            length = random() % 4 == 0 ? 65535 + random() % 3 : 1;
            break;
        case 2:
            length = random() % 8 == 0 ? 131072 + random() % 2 : 4096;
            break;
        default:
            length = random() % scale;
        }
    return lengths;
}

TEST(Pages, RuleMatchesItsTwin) {
    Random random(4);
    for (int round = 0; round < 2000; ++round) {
        const auto lengths = random_lengths(random, random() % 257);
        const std::uint32_t target = 16 * (16 + random() % 4081);
        ASSERT_EQ(split_into_pages(lengths, target), pages_word_for_word(lengths, target));
    }
    const std::vector<std::uint32_t> exact = {100, 156, 1, 0, 255};
    EXPECT_EQ(split_into_pages(exact, 256), (std::vector<std::uint32_t>{256, 256}));
}

struct Record {
    std::vector<std::byte> bytes;
    GroupKey key;
};

Record make_record(const std::vector<std::uint32_t>& lengths, std::uint32_t page_bytes = 4096) {
    std::uint64_t total = 0;
    for (const std::uint32_t length : lengths)
        total += length;
    const GroupKey key{
        0x1122334455667788u, 7,         static_cast<std::uint32_t>(lengths.size()), 1000,
        1000 + total,        page_bytes};
    std::vector<std::uint32_t> crcs(split_into_pages(lengths, page_bytes).size());
    for (std::size_t i = 0; i < crcs.size(); ++i)
        crcs[i] = static_cast<std::uint32_t>(i * 77);
    return {write_index_record(key.identity, key.group, lengths, crcs), key};
}

void expect_round_trip(const std::vector<std::uint32_t>& lengths) {
    const Record record = make_record(lengths);
    ASSERT_LE(record.bytes.size(), max_index_record_bytes(record.key));
    const Result<GroupIndex> index = read_index_record(record.bytes, record.key);
    ASSERT_TRUE(index) << index.status().message();
    ASSERT_EQ(index->starts.size(), lengths.size() + 1);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        ASSERT_EQ(index->starts[i + 1] - index->starts[i], lengths[i]);
        const auto [begin, end] = index->pages_of(index->starts[i], index->starts[i + 1]);
        ASSERT_EQ(begin == end, lengths[i] == 0);
        if (begin == end)
            continue;
        ASSERT_LE(index->pages[begin].offset, index->starts[i]);
        ASSERT_GE(index->pages[end - 1].offset + index->pages[end - 1].length,
                  index->starts[i + 1]);
        ASSERT_TRUE(lengths[i] > 65536 || end == begin + 1);
        for (std::size_t p = begin; p < end; ++p) {
            const auto [first, last] = index->tiles_of(index->pages[p]);
            ASSERT_TRUE(first <= i && i < last);
            ASSERT_EQ(index->pages[p].crc, p * 77);
        }
    }
}

TEST(IndexRecord, RandomRoundTrip) {
    Random random(5);
    for (int round = 0; round < 500; ++round)
        expect_round_trip(random_lengths(random, 1 + random() % 256));
}

TEST(IndexRecord, SpecialRoundTrips) {
    expect_round_trip({0});
    expect_round_trip({1});
    expect_round_trip(std::vector<std::uint32_t>(256, 0));
    expect_round_trip(std::vector<std::uint32_t>(256, 1));
    // Few long tiles among short ones: q reaches 24 and the 32 plain bits are taken.
    std::vector<std::uint32_t> lengths(200, 3);
    lengths[5] = 400'000'000;
    lengths[100] = 3'000'000'000;
    lengths[199] = 25;
    expect_round_trip(lengths);
    expect_round_trip({0xFFFFFFFF, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1});
}

TEST(IndexRecord, TakesTheSmallestCode) {
    // 6 bits and then, with k = 0, two bits for each 2: 6 + 512 bits.
    const Record record = make_record(std::vector<std::uint32_t>(256, 2));
    EXPECT_EQ(record.bytes.size(), 65u + 4 + 4);
}

void reseal(Record& record) {
    const std::size_t body = record.bytes.size() - 4;
    std::array<std::byte, 12> seed;
    store_le(seed.data(), record.key.identity);
    store_le(seed.data() + 8, record.key.group);
    store_le(record.bytes.data() + body, crc32c(std::span(record.bytes).first(body), crc32c(seed)));
}

TEST(IndexRecord, EveryFlipIsFoundByTheChecksum) {
    const Record good = make_record({5, 0, 9000, 70000, 1});
    for (std::size_t bit = 0; bit < good.bytes.size() * 8; ++bit) {
        Record bad = good;
        bad.bytes[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
        bool crc_error = false;
        ASSERT_FALSE(read_index_record(bad.bytes, bad.key, &crc_error));
        ASSERT_TRUE(crc_error);
    }
}

TEST(IndexRecord, HostileRecordsWithAGoodChecksum) {
    // Whatever the bits say: refused, or a tiling of exactly the group's bytes.
    Random random(6);
    const Record good = make_record({5, 0, 900, 700, 1, 64, 64, 0, 3});
    for (int round = 0; round < 20000; ++round) {
        Record bad = good;
        for (unsigned flips = 1 + random() % 4; flips > 0; --flips)
            bad.bytes[random() % bad.bytes.size()] ^= static_cast<std::byte>(1 << random() % 8);
        if (random() % 4 == 0)
            bad.bytes.resize(1 + random() % (bad.bytes.size() + 8));
        if (bad.bytes.size() < 4)
            bad.bytes.resize(4);
        reseal(bad);
        const Result<GroupIndex> index = read_index_record(bad.bytes, bad.key);
        if (index) {
            ASSERT_EQ(index->starts.back(), bad.key.data_end);
            ASSERT_EQ(index->starts.size(), 10u);
        } else {
            ASSERT_EQ(index.status().code(), ErrorCode::invalid_file);
        }
    }
}

TEST(IndexRecord, WrongContextIsRefused) {
    const Record record = make_record({5, 6, 7});
    const auto refused = [&](auto change) {
        GroupKey key = record.key;
        change(key);
        return !read_index_record(record.bytes, key).ok();
    };
    EXPECT_TRUE(refused([](GroupKey& k) { ++k.identity; }));
    EXPECT_TRUE(refused([](GroupKey& k) { ++k.group; }));
    EXPECT_TRUE(refused([](GroupKey& k) { ++k.data_end; }));
    EXPECT_TRUE(refused([](GroupKey& k) { --k.data_end; }));
    EXPECT_TRUE(refused([](GroupKey& k) { ++k.tiles; }));
    EXPECT_FALSE(read_index_record({}, record.key));
}

// ---------------------------------------------------------------- metadata

TEST(Metadata, RoundTripStoredAndPacked) {
    for (const Metadata& metadata :
         {Metadata{}, Metadata{{"a", ""}}, Metadata{{"Author", "J\xC3\xA4ger"}, {"Software", "x"}},
          Metadata{{"long", std::string(100000, 'x')}}}) {
        const auto packed = pack_metadata(metadata);
        ASSERT_TRUE(packed);
        const auto unpacked = unpack_metadata(*packed);
        ASSERT_TRUE(unpacked) << unpacked.status().message();
        EXPECT_EQ(*unpacked, metadata);
        EXPECT_LT(packed->size(), 1000u);
        for (std::size_t length = 0; length < packed->size(); ++length)
            ASSERT_FALSE(unpack_metadata(std::span(*packed).first(length)));
    }
}

TEST(Metadata, LimitsOfTheWriter) {
    const auto fits = [](const Metadata& m) { return pack_metadata(m).ok(); };
    EXPECT_TRUE(fits({{std::string(255, 'k'), std::string(1u << 20, 'v')}}));
    EXPECT_FALSE(fits({{std::string(256, 'k'), ""}}));
    EXPECT_FALSE(fits({{"", "v"}}));
    EXPECT_FALSE(fits({{"k", std::string((1u << 20) + 1, 'v')}}));
    EXPECT_FALSE(fits({{"k", std::string(1, '\0')}}));
    Metadata many;
    for (int i = 0; i < 65536; ++i)
        many[std::to_string(i)] = "";
    EXPECT_TRUE(fits(many));
    many["one more"] = "";
    EXPECT_FALSE(fits(many));
    Metadata large;
    for (char c = 'a'; c < 'a' + 16; ++c)
        large[std::string(1, c)] = std::string(1u << 20, c);
    EXPECT_FALSE(fits(large));
}

TEST(Metadata, OnlyUtf8) {
    const auto fits = [](const std::string& value) { return pack_metadata({{"k", value}}).ok(); };
    for (const char* good : {"", "a", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF",
                             "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"})
        EXPECT_TRUE(fits(good)) << good;
    for (const char* bad :
         {"\x80", "\xC1\xBF", "\xC2", "\xC2\x41", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xE2\x82",
          "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"})
        EXPECT_FALSE(fits(bad)) << bad;
}

std::vector<std::byte> stored(const std::vector<std::pair<std::string, std::string>>& entries,
                              std::int64_t count = -1, const std::string& tail = "") {
    std::vector<std::byte> text;
    append_le(text, static_cast<std::uint32_t>(count < 0 ? std::ssize(entries) : count));
    for (const auto& [key, value] : entries) {
        append_le(text, static_cast<std::uint16_t>(key.size()));
        append_le(text, static_cast<std::uint32_t>(value.size()));
        append_bytes(text, bytes_of(key));
        append_bytes(text, bytes_of(value));
    }
    append_bytes(text, bytes_of(tail));
    std::vector<std::byte> section;
    append_le(section, std::uint8_t{0});
    append_le(section, static_cast<std::uint32_t>(text.size()));
    append_bytes(section, text);
    return section;
}

TEST(Metadata, HostileSections) {
    EXPECT_TRUE(unpack_metadata(stored({{"a", "1"}, {"b", "2"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"b", "1"}, {"a", "2"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}, {"a", "2"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 2)));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 0)));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 0xFFFFFFFF)));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 1, "x")));
    EXPECT_FALSE(unpack_metadata(stored({{"", "1"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"\xFF", "1"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "\xFF"}})));
    std::vector<std::byte> section = stored({{"a", "1"}});
    section[0] = std::byte{2};
    EXPECT_FALSE(unpack_metadata(section)) << "unknown packing";

    std::vector<std::byte> packed = *pack_metadata({{"k", std::string(1000, 'v')}});
    ASSERT_EQ(packed[0], std::byte{1});
    std::vector<std::byte> longer = packed;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(unpack_metadata(longer)) << "bytes after the frame";
    for (const std::uint32_t size : {0u, 1u, 1010u, 1012u, 1u << 24, (1u << 24) + 1, 0xFFFFFFFFu}) {
        store_le(packed.data() + 1, size);
        EXPECT_FALSE(unpack_metadata(packed)) << size;
    }
}

// ---------------------------------------------------------------- header record

TEST(Header, EveryByteIsAField) {
    // Storing what was loaded gives back every byte, for any bytes.
    const std::vector<std::byte> noise = random_bytes(header_bytes, 7);
    const auto stored_again = store_header(load_header(std::span(noise).first<header_bytes>()));
    for (std::size_t i = file_identifier.size(); i < header_bytes; ++i)
        EXPECT_EQ(stored_again[i], noise[i]) << i;
}

TEST(Names, UnknownValuesHaveAName) {
    EXPECT_STREQ(name_of(Proxy::sphere), "sphere");
    EXPECT_STREQ(name_of(static_cast<Proxy>(9)), "unknown");
    EXPECT_EQ(feature_name(1), "corrections");
    EXPECT_EQ(feature_name(40), "bit 40");
}

// ---------------------------------------------------------------- files

class Files : public ::testing::Test {
protected:
    void SetUp() override { folder_ = test::make_test_folder("format"); }
    void TearDown() override {
        std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
        std::filesystem::remove_all(folder_);
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::ptrdiff_t files() const {
        return std::distance(std::filesystem::directory_iterator(folder_), {});
    }
    std::filesystem::path folder_;
};

TEST_F(Files, AppearsWhenCommitted) {
    const std::string target = path("a.tess");
    {
        Result<OutputFile> file = OutputFile::create(target);
        ASSERT_TRUE(file) << file.status().message();
        ASSERT_TRUE(file->append(bytes_of("hello ")));
        ASSERT_TRUE(file->append(bytes_of("world")));
        ASSERT_TRUE(file->write_at(0, bytes_of("J")));
        EXPECT_EQ(file->appended(), 11u);
        EXPECT_FALSE(std::filesystem::exists(target));
        OutputFile moved = std::move(*file);
        ASSERT_TRUE(moved.commit());
        EXPECT_EQ(moved.commit().code(), ErrorCode::io);
        EXPECT_EQ(moved.append(bytes_of("x")).code(), ErrorCode::io);
    }
    EXPECT_EQ(test::slurp(target), "Jello world");
    EXPECT_EQ(files(), 1);
}

TEST_F(Files, LeavesNothingBehindWithoutCommit) {
    const std::string target = path("a.tess");
    std::ofstream(target) << "old";
    {
        Result<OutputFile> file = OutputFile::create(target);
        ASSERT_TRUE(file && file->append(bytes_of("new")));
        EXPECT_EQ(files(), 2);
    }
    EXPECT_EQ(test::slurp(target), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(Files, StaleTemporaryFileDoesNotHinder) {
    const std::string target = path("a.tess");
    std::ofstream(target + "." + std::to_string(::getpid()) + ".tmp") << "stale";
    Result<OutputFile> file = OutputFile::create(target);
    ASSERT_TRUE(file && file->append(bytes_of("new")) && file->commit());
    EXPECT_EQ(test::slurp(target), "new");
}

void expect_io_error(const Status& status, const std::string& path, const std::string& word) {
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find(path), std::string::npos) << status.message();
    EXPECT_NE(status.message().find(word), std::string::npos) << status.message();
}

TEST_F(Files, TargetsThatCannotBe) {
    expect_io_error(OutputFile::create(folder_.string()).status(), folder_.string(), "directory");
    expect_io_error(OutputFile::create("/dev/full").status(), "/dev/full", "regular");
    expect_io_error(OutputFile::create(path("none/a")).status(), path("none/a"), "No such file");
    EXPECT_EQ(files(), 0);
}

TEST_F(Files, ReadOnlyFolder) {
    std::filesystem::permissions(folder_, static_cast<std::filesystem::perms>(0555));
    const auto child = [this] {
        constexpr uid_t nobody = 65534; // root may write everywhere
        if (::geteuid() == 0 && ::setuid(nobody) != 0)
            std::_Exit(2);
        expect_io_error(OutputFile::create(path("a")).status(), path("a"), "denied");
        std::_Exit(HasFailure() || files() != 0 ? 1 : 0);
    };
    EXPECT_EXIT(child(), ::testing::ExitedWithCode(0), "");
}

TEST_F(Files, FailingRename) {
    const std::string target = path("a");
    Result<OutputFile> file = OutputFile::create(target);
    ASSERT_TRUE(file && file->append(bytes_of("x")));
    std::filesystem::create_directory(target); // appears while we write
    expect_io_error(file->commit(), target, "rename");
    EXPECT_EQ(files(), 1);
}

TEST_F(Files, FullDisk) {
    // In a child: the limit stands in for a full disk.
    const auto child = [this] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{1000, 1000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        Status status;
        {
            Result<OutputFile> file = OutputFile::create(path("a"));
            const std::vector<std::byte> bytes(600);
            status = file->append(bytes);
            if (status)
                status = file->append(bytes);
        }
        const bool good = status.code() == ErrorCode::io && files() == 0 &&
                          status.message().find("offset 1000") != std::string::npos;
        std::_Exit(good ? 0 : 1);
    };
    EXPECT_EXIT(child(), ::testing::ExitedWithCode(0), "");
}

TEST_F(Files, Sources) {
    std::ofstream(path("a")) << "0123456789";
    Result<std::unique_ptr<ByteSource>> file = open_file(path("a"));
    ASSERT_TRUE(file) << file.status().message();
    const std::string digits = "0123456789";
    std::unique_ptr<ByteSource> memory = wrap_memory(bytes_of(digits));
    for (ByteSource* source : {file->get(), memory.get()}) {
        EXPECT_EQ(source->size(), 10u);
        CountingByteSource counting(*source);
        std::array<std::byte, 4> four;
        ASSERT_TRUE(counting.read(6, four));
        EXPECT_EQ(four[3], std::byte{'9'});
        EXPECT_EQ(counting.read(7, four).code(), ErrorCode::io);
        EXPECT_EQ(counting.read(~0ull - 1, four).code(), ErrorCode::io);
        EXPECT_TRUE(counting.read(10, {}));
        ASSERT_EQ(counting.reads().size(), 4u);
        EXPECT_EQ(counting.reads()[0].offset, 6u);
        EXPECT_EQ(counting.reads()[0].length, 4u);
    }
    std::filesystem::resize_file(path("a"), 5);
    std::array<std::byte, 4> four;
    expect_io_error((*file)->read(4, four), path("a"), "shorter");
}

TEST_F(Files, ReadMany) {
    std::ofstream(path("a")) << "0123456789";
    Result<std::unique_ptr<ByteSource>> file = open_file(path("a"));
    ASSERT_TRUE(file) << file.status().message();
    const std::string digits = "0123456789";
    std::unique_ptr<ByteSource> memory = wrap_memory(bytes_of(digits));
    for (ByteSource* source : {file->get(), memory.get()}) {
        CountingByteSource counting(*source);
        std::array<std::byte, 2> a, b, c;
        const ReadRequest three[] = {{6, a}, {0, b}, {5, c}};
        ASSERT_TRUE(counting.read_many(three));
        EXPECT_EQ(a[1], std::byte{'7'});
        EXPECT_EQ(b[0], std::byte{'0'});
        EXPECT_EQ(c[0], std::byte{'5'});
        ASSERT_EQ(counting.reads().size(), 1u) << "near ranges count as one request";
        EXPECT_EQ(counting.reads()[0].offset, 0u);
        EXPECT_EQ(counting.reads()[0].length, 8u);
        const ReadRequest outside[] = {{0, a}, {9, b}};
        EXPECT_EQ(counting.read_many(outside).code(), ErrorCode::io);
        EXPECT_EQ(source->read_many(outside).code(), ErrorCode::io);
        EXPECT_TRUE(counting.read_many({}));
        EXPECT_FALSE(counting.wants_prefetch());
    }
}

TEST(ReadPlan, MergesWhatIsNear) {
    std::vector<std::byte> buffer(100);
    const auto plan = [&](std::vector<std::pair<std::uint64_t, std::size_t>> ranges,
                          std::uint64_t near, std::uint64_t longest) {
        std::vector<ReadRequest> requests;
        for (const auto& [offset, length] : ranges)
            requests.push_back({offset, std::span(buffer).first(length)});
        std::string text;
        for (const MergedRead& read : merge_reads(requests, near, longest)) {
            text += std::to_string(read.offset) + "+" + std::to_string(read.length) + ":";
            for (const std::size_t i : read.requests)
                text += std::to_string(i);
            text += " ";
        }
        return text;
    };
    EXPECT_EQ(plan({}, 10, 100), "");
    EXPECT_EQ(plan({{5, 0}}, 10, 100), "");
    EXPECT_EQ(plan({{5, 5}, {10, 5}}, 0, 100), "5+10:01 ");
    EXPECT_EQ(plan({{5, 5}, {11, 5}}, 0, 100), "5+5:0 11+5:1 ");
    EXPECT_EQ(plan({{11, 5}, {5, 5}}, 1, 100), "5+11:10 ");
    EXPECT_EQ(plan({{0, 60}, {60, 60}}, 10, 100), "0+60:0 60+60:1 ");
    EXPECT_EQ(plan({{0, 60}, {10, 20}, {50, 20}}, 10, 60), "0+60:01 50+20:2 ");
    EXPECT_EQ(plan({{0, 100}, {0, 100}, {5, 0}}, 0, 10), "0+100:01 ");
    const std::uint64_t end = ~std::uint64_t{0};
    EXPECT_EQ(plan({{end - 20, 20}, {0, 10}}, end, end), "0+18446744073709551615:10 ");
    EXPECT_EQ(plan({{end - 20, 20}, {0, 10}}, 32768, end), "0+10:1 18446744073709551595+20:0 ");
}

// Sparse ranges stay apart, dense ones are joined, and what is read in vain stays a small share.
TEST(ReadPlan, WastesASixteenthAtMost) {
    std::vector<std::byte> buffer(300'000);
    const auto lengths = [&](std::vector<std::pair<std::uint64_t, std::size_t>> ranges) {
        std::vector<ReadRequest> requests;
        for (const auto& [offset, length] : ranges)
            requests.push_back({offset, std::span(buffer).first(length)});
        std::vector<std::uint64_t> result;
        for (const MergedRead& read : merge_reads(requests))
            result.push_back(read.length);
        return result;
    };
    using Lengths = std::vector<std::uint64_t>;
    EXPECT_EQ(lengths({}), Lengths{});
    EXPECT_EQ(lengths({{0, 10}, {4106, 10}}), Lengths{4116}) << "near";
    EXPECT_EQ(lengths({{0, 10}, {4107, 10}}), (Lengths{10, 10}));
    EXPECT_EQ(lengths({{0, 80'000}, {90'000, 80'000}}), Lengths{170'000});
    EXPECT_EQ(lengths({{0, 30'000}, {40'000, 30'000}}), (Lengths{30'000, 30'000}));
    EXPECT_EQ(lengths({{0, 60'000}, {66'000, 60'000}, {138'000, 10'000}}),
              (Lengths{126'000, 10'000}))
        << "the nearest first";
    EXPECT_EQ(lengths({{0, 30'000}, {35'500, 30'000}, {71'000, 30'000}, {106'500, 30'000}}),
              (Lengths{30'000, 30'000, 30'000, 30'000}))
        << "all of equal gaps or none";
    EXPECT_EQ(lengths({{0, 300'000}, {332'769, 300'000}}), (Lengths{300'000, 300'000}));
    EXPECT_EQ(lengths({{0, 300'000}, {332'768, 300'000}}), Lengths{632'768});
}

TEST_F(Files, SourcesThatCannotBe) {
    expect_io_error(open_file(path("none")).status(), path("none"), "No such file");
    expect_io_error(open_file(folder_.string()).status(), folder_.string(), "directory");
    expect_io_error(open_file("/dev/null").status(), "/dev/null", "regular");
    ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    expect_io_error(open_file(path("pipe")).status(), path("pipe"), "regular");
}

} // namespace
} // namespace tessera
