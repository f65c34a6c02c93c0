// Numbers as FORMAT.md stores them, and the refusal of files.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera_reference::spec {

using std::int16_t;
using std::int32_t;
using std::int64_t;
using std::size_t;
using std::uint16_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;
using Bytes = std::span<const std::byte>;

// Thrown for a file that is refused.
struct Refusal {
    std::string reason;
};

inline void require(bool condition, const char* rule) {
    if (!condition)
        throw Refusal{rule};
}

inline uint64_t little_endian(Bytes bytes, size_t offset, size_t length) {
    require(offset <= bytes.size() && length <= bytes.size() - offset, "cut short");
    uint64_t value = 0;
    for (size_t i = 0; i < length; ++i)
        value |= static_cast<uint64_t>(bytes[offset + i]) << 8 * i;
    return value;
}
inline uint8_t u8(Bytes b, size_t at) {
    return static_cast<uint8_t>(little_endian(b, at, 1));
}
inline uint16_t u16(Bytes b, size_t at) {
    return static_cast<uint16_t>(little_endian(b, at, 2));
}
inline uint32_t u32(Bytes b, size_t at) {
    return static_cast<uint32_t>(little_endian(b, at, 4));
}
inline uint64_t u64(Bytes b, size_t at) {
    return little_endian(b, at, 8);
}
inline float f32(Bytes b, size_t at) {
    return std::bit_cast<float>(u32(b, at));
}

inline int64_t floor_div(int64_t a, int64_t b) { // b > 0
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

// Collects numbers as little-endian bytes, for the seeds of checksums.
struct Seed {
    std::vector<std::byte> bytes;
    Seed& add(uint64_t value, int length) {
        for (int i = 0; i < length; ++i)
            bytes.push_back(static_cast<std::byte>(value >> 8 * i & 255));
        return *this;
    }
};

} // namespace tessera_reference::spec
