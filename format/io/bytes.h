// Reads and writes little-endian integers in byte buffers, whatever the byte order of the machine.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tessera {

// Precondition: sizeof(T) bytes exist at `bytes`.
template <std::unsigned_integral T> T load_le(const std::byte* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    if constexpr (std::endian::native == std::endian::big && sizeof(T) > 1) {
        T swapped = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i)
            swapped = static_cast<T>(swapped << 8 | ((value >> (8 * i)) & 0xFF));
        value = swapped;
    }
    return value;
}

// Precondition: sizeof(T) bytes exist at `bytes`.
template <std::unsigned_integral T> void store_le(std::byte* bytes, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
        bytes[i] = static_cast<std::byte>((value >> (8 * i)) & 0xFF);
}

template <std::unsigned_integral T> void append_le(std::vector<std::byte>& out, T value) {
    out.resize(out.size() + sizeof(T));
    store_le(out.data() + out.size() - sizeof(T), value);
}

inline void append_bytes(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
}

// Walks a buffer from front to back. take() returns false and leaves its argument as it is if the
// buffer has too few bytes left.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    std::size_t remaining() const { return rest_.size(); }

    template <std::unsigned_integral T> [[nodiscard]] bool take(T& value) {
        if (rest_.size() < sizeof(T))
            return false;
        value = load_le<T>(rest_.data());
        rest_ = rest_.subspan(sizeof(T));
        return true;
    }
    [[nodiscard]] bool take(std::size_t count, std::span<const std::byte>& bytes) {
        if (rest_.size() < count)
            return false;
        bytes = rest_.first(count);
        rest_ = rest_.subspan(count);
        return true;
    }

private:
    std::span<const std::byte> rest_;
};

} // namespace tessera
