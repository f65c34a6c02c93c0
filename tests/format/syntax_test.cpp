// Tests the header and the names of its values.
#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "tests/support/format_bytes.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

TEST(Header, EveryByteIsAField) {
    // Loading and storing a header must give back every byte.
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

} // namespace
} // namespace tessera
