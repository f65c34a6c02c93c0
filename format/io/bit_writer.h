// Writes bits into bytes. The first bit is the lowest bit of the first byte (FORMAT.md 1.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tessera {

// Not thread-safe.
class BitWriter {
public:
    // Appends the `count` (0..32) lowest bits of `value`, the lowest one first. Ignores higher
    // bits.
    void bits(std::uint32_t value, unsigned count) {
        pending_ |= (value & ((std::uint64_t{1} << count) - 1)) << pending_count_;
        pending_count_ += count;
        while (pending_count_ >= 8)
            flush_byte();
    }

    // Appends `count` (0..32) bits that are 1.
    void ones(unsigned count) { bits(0xFFFFFFFFu, count); }

    // Returns the bytes, the last one padded with zeros. The writer is empty afterwards.
    std::vector<std::byte> take() {
        if (pending_count_ > 0)
            flush_byte();
        pending_ = 0;
        pending_count_ = 0;
        return std::exchange(bytes_, {});
    }

private:
    void flush_byte() {
        bytes_.push_back(static_cast<std::byte>(pending_ & 0xFF));
        pending_ >>= 8;
        pending_count_ -= pending_count_ < 8 ? pending_count_ : 8;
    }

    std::vector<std::byte> bytes_;
    std::uint64_t pending_ = 0;
    unsigned pending_count_ = 0;
};

} // namespace tessera
