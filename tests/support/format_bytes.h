// Byte helpers for the tests of the format.
#pragma once

#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/levels.h"
#include "tests/support/random.h"

#include <string>

namespace tessera::test {

inline std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

inline std::vector<std::byte> random_bytes(std::size_t count, std::uint32_t seed) {
    return Random(seed).bytes(count);
}

} // namespace tessera::test
