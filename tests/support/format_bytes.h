// Bytes for the tests of the format.
#pragma once

#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/levels.h"

#include <random>

namespace tessera::test::format_bytes {

// std::mt19937 yields 64-bit integers on some systems.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }

private:
    std::mt19937 engine_;
};

inline std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

inline std::vector<std::byte> random_bytes(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    std::vector<std::byte> bytes(count);
    for (std::byte& b : bytes)
        b = static_cast<std::byte>(random() & 0xFF);
    return bytes;
}

} // namespace tessera::test::format_bytes
