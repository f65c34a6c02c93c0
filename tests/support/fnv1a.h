// FNV-1a of 64 bits: offset basis cbf29ce484222325, prime 100000001b3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera::test {

inline std::uint64_t fnv1a_64(std::span<const std::byte> bytes) {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const std::byte b : bytes)
        hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001B3;
    return hash;
}

} // namespace tessera::test
