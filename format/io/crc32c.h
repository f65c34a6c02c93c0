// CRC32C (Castagnoli), the checksum that .tess files use. That of "123456789" is 0xE3069283.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// The CRC of `bytes`. If `previous` is the CRC of other bytes, it is the CRC of those bytes
// followed by `bytes`. Thread-safe. Uses the processor's instruction if there is one.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t previous = 0);

// The same, computed with tables on any processor.
std::uint32_t crc32c_portable(std::span<const std::byte> bytes, std::uint32_t previous = 0);

} // namespace tessera
