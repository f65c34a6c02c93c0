// The entropy coder (FORMAT.md 3.3): range asymmetric numeral systems (Duda 2013, arXiv:1311.2540)
// with a 32-bit state and 16-bit words. The decoder needs only unsigned 32-bit arithmetic.
//
// The encoder's state starts at 0, below the usual lower bound, and the decoder reads a word only
// while one is left. Therefore the decoder can verify the end of a stream, no bytes are spent on a
// start state, and an empty stream is valid: it decodes to the first symbol of every table.
#pragma once

#include "format/io/bytes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

constexpr int probability_bits = 12;
constexpr std::uint32_t probability_total = 1u << probability_bits;
constexpr std::uint32_t rans_lower_bound = 1u << 16;

// Decodes symbols from front to back. It never reads outside its bytes. Beyond their end it decodes
// arbitrary symbols of the tables, and ended_well() is false.
class RansDecoder {
public:
    RansDecoder() = default;
    // The bytes of one stream. The last byte of an odd number is never read and makes ended_well()
    // false.
    explicit RansDecoder(std::span<const std::byte> bytes)
        : next_(bytes.data()), end_(bytes.data() + bytes.size() / 2 * 2),
          odd_(bytes.size() % 2 != 0) {
        refill();
        refill();
    }

    // The next symbol is the one whose range contains this number of 0..4095.
    std::uint32_t slot() const { return state_ & (probability_total - 1); }
    // Removes the next symbol, which has this range.
    void consume(std::uint32_t start, std::uint32_t frequency) {
        state_ = frequency * (state_ >> probability_bits) + slot() - start;
        refill();
    }
    // Decodes a bit that is 0 with frequency `zero` (1..4095).
    bool bit(std::uint32_t zero) {
        // Branches are faster than selects here: a correct branch prediction saves waiting for the
        // comparison.
        if (slot() < zero) {
            consume(0, zero);
            return false;
        }
        consume(zero, probability_total - zero);
        return true;
    }
    // Decodes `count` (0..16) bits that are equally likely 0 or 1.
    std::uint32_t raw(int count) {
        const std::uint32_t value = state_ & ((1u << count) - 1);
        state_ >>= count;
        refill();
        return value;
    }
    // Whether every word was read and the state is the one with which the encoder began.
    bool ended_well() const { return state_ == 0 && next_ == end_ && !odd_; }

private:
    void refill() {
        if (state_ < rans_lower_bound && next_ != end_) {
            state_ = (state_ << 16) | load_le<std::uint16_t>(next_);
            next_ += 2;
        }
    }
    std::uint32_t state_ = 0;
    const std::byte* next_ = nullptr;
    const std::byte* end_ = nullptr;
    bool odd_ = false;
};

// Collects symbols in the order in which they will be decoded, and codes them from back to front.
class RansEncoder {
public:
    // Preconditions: start + frequency <= 2^bits, frequency >= 1, bits <= 16.
    void put(std::uint32_t start, std::uint32_t frequency, int bits = probability_bits) {
        symbols_.push_back({start, frequency, static_cast<std::uint32_t>(bits)});
    }
    void bit(bool one, std::uint32_t zero) {
        put(one ? zero : 0, one ? probability_total - zero : zero);
    }
    void raw(std::uint32_t value, int count) {
        if (count > 0)
            put(value, 1, count);
    }
    // Appends the stream to `out` and forgets the symbols.
    void finish(std::vector<std::byte>& out) {
        words_.clear();
        std::uint64_t state = 0;
        for (std::size_t i = symbols_.size(); i-- > 0;) {
            const Symbol& s = symbols_[i];
            if (state >= (std::uint64_t{s.frequency} << (32 - s.bits))) {
                words_.push_back(static_cast<std::uint16_t>(state));
                state >>= 16;
            }
            const auto x = static_cast<std::uint32_t>(state); // fits; 32-bit division is faster
            state = (std::uint64_t{x / s.frequency} << s.bits) + x % s.frequency + s.start;
        }
        for (; state != 0; state >>= 16)
            words_.push_back(static_cast<std::uint16_t>(state));
        for (std::size_t i = words_.size(); i-- > 0;) {
            out.push_back(static_cast<std::byte>(words_[i] & 255));
            out.push_back(static_cast<std::byte>(words_[i] >> 8));
        }
        symbols_.clear();
    }

private:
    struct Symbol {
        std::uint32_t start, frequency, bits;
    };
    std::vector<Symbol> symbols_;
    std::vector<std::uint16_t> words_;
};

} // namespace tessera
