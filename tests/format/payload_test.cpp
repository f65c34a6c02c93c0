// Tests a payload's table byte by byte (FORMAT.md 3.2).
#include "format/tile/limits.h"
#include "format/tile/payload.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;
using Places = std::vector<std::pair<std::ptrdiff_t, std::size_t>>; // offset in the payload, bytes

Bytes bytes_of(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values)
        bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

bool refuses(std::initializer_list<int> values, int texels = correction_chunk) {
    PayloadParts parts;
    return split_payload(bytes_of(values), texels, parts).code() == ErrorCode::invalid_file;
}

// Parses a payload and returns its streams, segments first, then corrections. Empty if it is
// refused.
Places places(std::initializer_list<int> values, int texels = correction_chunk) {
    const Bytes payload = bytes_of(values);
    PayloadParts parts;
    Places found;
    if (!split_payload(payload, texels, parts))
        return found;
    for (const auto& segment : parts.segments)
        found.emplace_back(segment.bytes.data() - payload.data(), segment.bytes.size());
    for (const auto& chunk : parts.corrections)
        found.emplace_back(chunk.data() - payload.data(), chunk.size());
    return found;
}

TEST(Payload, StreamsFollowTheTable) {
    EXPECT_EQ(places({7, 7, 7, 7}), (Places{{0, 4}}));
    EXPECT_EQ(places({0}), (Places{{1, 0}}));
    EXPECT_EQ(places({0, 7, 7}), (Places{{1, 2}}));
    EXPECT_EQ(places({1, 0, 0, 0, 0}), (Places{{5, 0}, {5, 0}})); // ends after the table
    EXPECT_EQ(places({1, 3, 0, 1, 0, 7, 7, 8, 8}), (Places{{5, 2}, {7, 2}}));
    EXPECT_EQ(places({2, 5, 0, 0, 0, 6, 0, 1, 0, 8, 8}), (Places{{9, 0}, {9, 0}, {9, 2}}));
    EXPECT_EQ(places({128, 1, 0, 1, 0, 7, 7, 9, 9}), (Places{{5, 2}, {7, 2}}));
    EXPECT_EQ(places({128, 2, 0, 1, 0, 9, 9}, correction_chunk + 1),
              (Places{{5, 0}, {5, 0}, {5, 2}}));
}

// Large tiles have no corrections, so all bits of the first byte count segments.
TEST(Payload, LargeTilesHaveMoreSegments) {
    PayloadParts parts;
    for (const int texels : {max_corrected_texels, max_corrected_texels + 1}) {
        const bool is_large = texels > max_corrected_texels;
        EXPECT_EQ(most_segments(texels), is_large ? 256 : 128);
        Bytes payload = bytes_of({0xFF});
        for (int i = 1; i <= 255; ++i)
            for (const int byte : {i, 0, 0, 0})
                payload.push_back(static_cast<std::byte>(byte));
        EXPECT_EQ(split_payload(payload, texels, parts).ok(), is_large);
        if (is_large) {
            ASSERT_EQ(parts.segments.size(), 256u);
            EXPECT_EQ(parts.segments[255].first_block, 255);
            EXPECT_TRUE(parts.corrections.empty());
        }
    }
}

TEST(Payload, ReadsTheFirstBlockOfEachSegment) {
    PayloadParts parts;
    const Bytes payload = bytes_of({2, 5, 0, 0, 0, 0xFF, 0x0F, 0, 0});
    ASSERT_TRUE(split_payload(payload, 1, parts));
    ASSERT_EQ(parts.segments.size(), 3u);
    EXPECT_EQ(parts.segments[0].first_block, 0);
    EXPECT_EQ(parts.segments[1].first_block, 5);
    EXPECT_EQ(parts.segments[2].first_block, max_leaves - 1);
}

TEST(Payload, RefusesTablesThatDoNotFit) {
    EXPECT_TRUE(refuses({1, 0, 0}));                           // cut off
    EXPECT_TRUE(refuses({2, 5, 0, 0, 0, 5, 0, 0, 0}));         // out of order
    EXPECT_TRUE(refuses({1, 0, 0x10, 0, 0}));                  // no such block
    EXPECT_TRUE(refuses({1, 0, 0, 1, 0}));                     // longer than the payload
    EXPECT_TRUE(refuses({1, 0, 0, 2, 0, 7, 7}));               // longer by a word
    EXPECT_TRUE(refuses({128, 2, 0, 1, 0, 9, 9}));             // no such chunk
    EXPECT_TRUE(refuses({128, 1, 0, 0, 0}));                   // an empty chunk
    EXPECT_TRUE(refuses({128, 1, 0}));                         // cut off
    EXPECT_TRUE(refuses({128}));                               // cut off before the mask
    EXPECT_TRUE(refuses({129, 0, 0, 1, 0, 1, 0, 1, 0, 7, 7})); // one word is missing
}

} // namespace
} // namespace tessera
