// Compares checksums with known values, and the two implementations with each other.
#include "format/io/bit_reader.h"
#include "format/io/crc32c.h"
#include "format/levels.h"
#include "tests/support/format_bytes.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

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

} // namespace
} // namespace tessera
