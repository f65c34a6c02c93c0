// Tests that the bit reader returns what the bit writer wrote.
#include "format/io/bit_reader.h"
#include "format/io/bit_writer.h"
#include "format/levels.h"
#include "tests/support/format_bytes.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

TEST(Bits, FirstBitIsLowest) {
    BitWriter writer;
    writer.bits(1, 1);
    writer.bits(0b10, 2);
    writer.bits(0x1FF, 9);
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
    std::uint64_t bits = 0;
    for (int i = 0; i < 20000; ++i) {
        const unsigned count = random() % 33;
        const std::uint32_t value = random();
        fields.emplace_back(value & static_cast<std::uint32_t>((1ull << count) - 1), count);
        writer.bits(value, count);
        bits += count;
    }
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
    EXPECT_EQ(reader.ones(32), 8u); // and the 0 after them
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

} // namespace
} // namespace tessera
