// Range asymmetric numeral systems (Duda 2013, arXiv:1311.2540) with a 32-bit state and 16-bit
// words; every operation fits 32-bit unsigned arithmetic in the decoder (FORMAT.md 3.3).
//
// The state starts at 0, below the usual lower bound, and the decoder reads a word only while one
// is left. A stream therefore ends exactly, wastes no start state, and the empty stream is a valid
// one: it decodes to the first symbol (start 0) of every table.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

constexpr int probability_bits = 12;
constexpr std::uint32_t probability_total = 1u << probability_bits;
constexpr std::uint32_t rans_lower_bound = 1u << 16;

// Decodes symbols front to back. Never reads outside the span; past the end it decodes garbage
// that stays in range, and ended_well() is false.
class RansDecoder {
public:
    RansDecoder() = default;
    // Bytes of one stream; an odd last byte is never read and makes ended_well() false.
    explicit RansDecoder(std::span<const std::byte> bytes)
        : next_(bytes.data()), left_(bytes.size() / 2), odd_(bytes.size() % 2 != 0) {
        refill();
        refill();
    }

    // Position of the coded symbol in [0, 2^12).
    std::uint32_t slot() const { return state_ & (probability_total - 1); }
    void consume(std::uint32_t start, std::uint32_t frequency) {
        state_ = frequency * (state_ >> probability_bits) + slot() - start;
        refill();
    }
    // 0 with frequency `zero` (1..4095), else 1.
    bool bit(std::uint32_t zero) {
        // Two branches: a guess that is right saves waiting for the comparison.
        if (slot() < zero) {
            consume(0, zero);
            return false;
        }
        consume(zero, probability_total - zero);
        return true;
    }
    // `count` equiprobable bits, 0..16.
    std::uint32_t raw(int count) {
        const std::uint32_t value = state_ & ((1u << count) - 1);
        state_ >>= count;
        refill();
        return value;
    }
    // Every word was read and the state is back where the encoder began.
    bool ended_well() const { return state_ == 0 && left_ == 0 && !odd_; }

private:
    void refill() {
        if (state_ < rans_lower_bound && left_ > 0) {
            state_ = (state_ << 16) | std::to_integer<std::uint32_t>(next_[0]) |
                     (std::to_integer<std::uint32_t>(next_[1]) << 8);
            next_ += 2;
            --left_;
        }
    }
    std::uint32_t state_ = 0;
    const std::byte* next_ = nullptr;
    std::size_t left_ = 0;
    bool odd_ = false;
};

// Collects symbols in decoding order and codes them back to front.
class RansEncoder {
public:
    // Precondition: start + frequency <= 2^bits, frequency >= 1, bits <= 16.
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
            const auto x = static_cast<std::uint32_t>(state); // now below 2^32: a quicker division
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
