// Little-endian integers in byte buffers, on any host.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tessera {

// Reads sizeof(T) bytes at `bytes`, which must exist.
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

// Writes sizeof(T) bytes at `bytes`, which must exist.
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

// Walks a buffer from the front; every take() says whether the bytes were there.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    std::size_t remaining() const { return rest_.size(); }

    // Past the end: returns false and leaves `value` alone.
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
