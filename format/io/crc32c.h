// CRC32C (Castagnoli), the checksum of everything in a .tess file. "123456789" gives 0xE3069283.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// CRC of `bytes`; with the CRC of what came before as `previous`, the CRC of both together.
// Thread-safe. Uses the processor's instruction where there is one.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t previous = 0);

// The same by tables, on any processor.
std::uint32_t crc32c_portable(std::span<const std::byte> bytes, std::uint32_t previous = 0);

} // namespace tessera
