// Tests index records and the rule for pages, with slow reference implementations and hostile
// bytes.
#include "format/container/index.h"
#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/io/bit_writer.h"
#include "format/io/crc32c.h"
#include "format/levels.h"
#include "tests/support/format_bytes.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

// The rule of FORMAT.md 1.5, applied byte by byte.
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

TEST(Pages, MatchTheRuleAppliedByteByByte) {
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

void expect_index_round_trip(const std::vector<std::uint32_t>& lengths) {
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
        expect_index_round_trip(random_lengths(random, 1 + random() % 256));
}

TEST(IndexRecord, SpecialRoundTrips) {
    expect_index_round_trip({0});
    expect_index_round_trip({1});
    expect_index_round_trip(std::vector<std::uint32_t>(256, 0));
    expect_index_round_trip(std::vector<std::uint32_t>(256, 1));
    // With few long tiles among short ones, q reaches 24 and the 32 plain bits are used.
    std::vector<std::uint32_t> lengths(200, 3);
    lengths[5] = 400'000'000;
    lengths[100] = 3'000'000'000;
    lengths[199] = 25;
    expect_index_round_trip(lengths);
    expect_index_round_trip({0xFFFFFFFF, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1});
}

TEST(IndexRecord, UsesTheShortestCode) {
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

// Freezes the bits, because a round trip does not notice when writer and reader change together.
TEST(IndexRecord, BitsAreFrozen) {
    std::vector<std::uint32_t> lengths(200, 1);
    lengths[7] = 0;
    lengths[90] = 100'000; // beyond the range of 24 ones
    const Record record = make_record(lengths);
    const auto body = std::span(record.bytes).first(record.bytes.size() - 4);
    EXPECT_EQ(crc32c(body), 0x5FE6790Fu);
}

TEST(IndexRecord, EveryFlippedBitFailsTheChecksum) {
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
    // Any bits must be refused or give a partition of exactly the group's bytes.
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

TEST(IndexRecord, TilesLongerThanTheLimitAreRefused) {
    Record record = make_record({5, 600000, 7});
    record.key.longest = 600000;
    EXPECT_TRUE(read_index_record(record.bytes, record.key).ok());
    record.key.longest = 599999;
    const auto index = read_index_record(record.bytes, record.key);
    ASSERT_EQ(index.status().code(), ErrorCode::invalid_file);
    EXPECT_NE(index.status().message().find("tile 1 of the group claims 600000"), std::string::npos)
        << index.status().message();
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

} // namespace
} // namespace tessera
