#include "format/io/crc32c.h"

#include "format/io/bytes.h"

#include <array>

namespace tessera {

namespace {

// Tables for slicing by 8: tables[k][b] is the contribution of byte b if k more bytes follow it.
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
    constexpr std::uint32_t polynomial = 0x82F63B78; // 0x1EDC6F41 reflected
    Tables tables{};
    for (std::uint32_t b = 0; b < 256; ++b) {
        std::uint32_t crc = b;
        for (int bit = 0; bit < 8; ++bit)
            crc = (crc >> 1) ^ ((crc & 1) != 0 ? polynomial : 0);
        tables[0][b] = crc;
    }
    for (std::size_t k = 1; k < 8; ++k)
        for (std::size_t b = 0; b < 256; ++b)
            tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 0xFF];
    return tables;
}

constexpr Tables tables = make_tables();

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define TESSERA_HARDWARE_CRC 1

__attribute__((target("sse4.2"))) std::uint32_t crc32c_sse42(std::span<const std::byte> bytes,
                                                             std::uint32_t previous) {
    std::uint64_t crc = ~previous;
    const std::byte* at = bytes.data();
    std::size_t left = bytes.size();
    for (; left >= 8; at += 8, left -= 8)
        crc = __builtin_ia32_crc32di(crc, load_le<std::uint64_t>(at));
    auto low = static_cast<std::uint32_t>(crc);
    for (; left > 0; ++at, --left)
        low = __builtin_ia32_crc32qi(low, std::to_integer<unsigned char>(*at));
    return ~low;
}
#endif

} // namespace

std::uint32_t crc32c_portable(std::span<const std::byte> bytes, std::uint32_t previous) {
    std::uint32_t crc = ~previous;
    const std::byte* at = bytes.data();
    std::size_t left = bytes.size();
    for (; left >= 8; at += 8, left -= 8) {
        const std::uint64_t word = load_le<std::uint64_t>(at) ^ crc;
        crc = 0;
        for (std::size_t k = 0; k < 8; ++k)
            crc ^= tables[7 - k][(word >> (8 * k)) & 0xFF];
    }
    for (; left > 0; ++at, --left)
        crc = (crc >> 8) ^ tables[0][(crc ^ std::to_integer<std::uint32_t>(*at)) & 0xFF];
    return ~crc;
}

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t previous) {
#ifdef TESSERA_HARDWARE_CRC
    static const bool hardware = __builtin_cpu_supports("sse4.2") != 0;
    if (hardware)
        return crc32c_sse42(bytes, previous);
#endif
    return crc32c_portable(bytes, previous);
}

} // namespace tessera
