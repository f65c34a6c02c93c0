// Tests which reads are merged.
#include "format/byte_source.h"
#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/io/bit_writer.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ReadPlan, MergesNearbyRanges) {
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

// Sparse ranges stay separate and dense ones are merged, so that few unneeded bytes are read.
TEST(ReadPlan, WastesAtMostASixteenth) {
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
    EXPECT_EQ(lengths({{0, 10}, {4106, 10}}), Lengths{4116}) << "gap of 4096";
    EXPECT_EQ(lengths({{0, 10}, {4107, 10}}), (Lengths{10, 10}));
    EXPECT_EQ(lengths({{0, 80'000}, {90'000, 80'000}}), Lengths{170'000});
    EXPECT_EQ(lengths({{0, 30'000}, {40'000, 30'000}}), (Lengths{30'000, 30'000}));
    EXPECT_EQ(lengths({{0, 60'000}, {66'000, 60'000}, {138'000, 10'000}}),
              (Lengths{126'000, 10'000}))
        << "the smallest gap is not merged first";
    EXPECT_EQ(lengths({{0, 30'000}, {35'500, 30'000}, {71'000, 30'000}, {106'500, 30'000}}),
              (Lengths{30'000, 30'000, 30'000, 30'000}))
        << "equal gaps are treated differently";
    EXPECT_EQ(lengths({{0, 300'000}, {332'769, 300'000}}), (Lengths{300'000, 300'000}));
    EXPECT_EQ(lengths({{0, 300'000}, {332'768, 300'000}}), Lengths{632'768});
}

} // namespace
} // namespace tessera
