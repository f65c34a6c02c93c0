// Text that a Windows shell wrote as UTF-16.
#pragma once

#include <cstdint>
#include <vector>

namespace tessera::corpus {

// UTF-16 with a byte order mark becomes UTF-8; other bytes stay as they are. Halves of characters
// become question marks.
inline std::vector<unsigned char> utf8_of(std::vector<unsigned char> bytes) {
    const bool is_big = bytes.size() >= 2 && bytes[0] == 0xFE && bytes[1] == 0xFF;
    if (!is_big && !(bytes.size() >= 2 && bytes[0] == 0xFF && bytes[1] == 0xFE))
        return bytes;
    const auto unit = [&](std::size_t i) -> std::uint32_t {
        return i + 1 < bytes.size() ? bytes[i + !is_big] << 8U | bytes[i + is_big] : 0;
    };
    const auto is_half = [](std::uint32_t x, std::uint32_t begin) {
        return (x & ~0x3FFU) == begin;
    };
    std::vector<unsigned char> text;
    for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
        std::uint32_t x = unit(i);
        if (is_half(x, 0xD800) && is_half(unit(i + 2), 0xDC00)) {
            x = 0x10000 + ((x & 0x3FFU) << 10U) + (unit(i + 2) & 0x3FFU);
            i += 2;
        } else if (is_half(x, 0xD800) || is_half(x, 0xDC00)) {
            x = '?';
        }
        const unsigned following = x < 0x80 ? 0 : x < 0x800 ? 1 : x < 0x10000 ? 2 : 3;
        constexpr std::uint32_t leads[] = {0, 0xC0, 0xE0, 0xF0};
        text.push_back(static_cast<unsigned char>(leads[following] | x >> 6 * following));
        for (unsigned k = following; k-- > 0;)
            text.push_back(static_cast<unsigned char>(0x80 | (x >> 6 * k & 0x3FU)));
    }
    return text;
}

} // namespace tessera::corpus
