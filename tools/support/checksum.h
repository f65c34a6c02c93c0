// A checksum that tells whether bytes are those of the last time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <zlib.h>

namespace tessera {

// CRC-32 of `bytes` after those that gave `before`.
inline std::uint32_t checksum(std::span<const std::byte> bytes, std::uint32_t before = 0) {
    return static_cast<std::uint32_t>(
        crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

} // namespace tessera
