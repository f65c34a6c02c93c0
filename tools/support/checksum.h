// A checksum that detects whether bytes have changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <zlib.h>

namespace tessera {

// The CRC-32 of `bytes`, continuing from the CRC-32 `before` of the bytes ahead of them.
inline std::uint32_t checksum(std::span<const std::byte> bytes, std::uint32_t before = 0) {
    return static_cast<std::uint32_t>(
        crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

} // namespace tessera
