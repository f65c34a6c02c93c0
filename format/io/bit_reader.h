// Reads bits from bytes. The first bit is the lowest bit of the first byte (FORMAT.md 1.4).
#pragma once

#include "format/io/bytes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

// Never reads beyond the end: bits there are 0, and overrun() then is true, so that a caller can
// check once after many calls. Not thread-safe.
class BitReader {
public:
    explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    // The next `count` bits (0..32). The first one is the lowest bit of the result.
    std::uint32_t bits(unsigned count) {
        const std::uint64_t mask = (std::uint64_t{1} << count) - 1;
        const auto value = static_cast<std::uint32_t>(window() & mask);
        position_ += count;
        return value;
    }
    bool bit() { return bits(1) != 0; }

    // Counts 1 bits up to `limit` (at most 32). If there are fewer, the 0 bit after them is
    // consumed.
    unsigned ones(unsigned limit) {
        const std::uint64_t limited = window() & ((std::uint64_t{1} << limit) - 1);
        const auto count = static_cast<unsigned>(std::countr_one(limited));
        position_ += count < limit ? count + 1 : count;
        return count;
    }

    // Skips to the next whole byte. False if one of the skipped bits is 1.
    bool align() { return bits(static_cast<unsigned>(-position_ & 7)) == 0; }

    bool overrun() const { return position_ > std::uint64_t{bytes_.size()} * 8; }
    std::uint64_t position() const { return position_; } // bits from the start
    // The bytes after position(), which must be a whole byte. Empty after an overrun.
    std::span<const std::byte> rest() const {
        return bytes_.subspan(std::min(bytes_.size(), static_cast<std::size_t>(position_ / 8)));
    }

private:
    // At least 57 bits that begin at position_; zeros beyond the end.
    std::uint64_t window() const {
        const std::uint64_t first = position_ / 8;
        if (first + 8 <= bytes_.size())
            return load_le<std::uint64_t>(bytes_.data() + first) >> (position_ & 7);
        std::uint64_t value = 0;
        for (std::uint64_t i = first; i < bytes_.size(); ++i)
            value |= std::to_integer<std::uint64_t>(bytes_[i]) << (8 * (i - first));
        return value >> (position_ & 7);
    }

    std::span<const std::byte> bytes_;
    std::uint64_t position_ = 0; // bits
};

} // namespace tessera
