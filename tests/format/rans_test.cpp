// Tests the entropy coder with round trips and with arbitrary bytes.
#include "format/tile/rans.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera::test {
namespace {

struct CodedSymbol {
    std::uint32_t start, frequency;
    int bits; // 12: a symbol of a table; otherwise raw bits
};

std::vector<CodedSymbol> random_symbols(Random& random, int count, double skew) {
    std::vector<CodedSymbol> symbols;
    for (int i = 0; i < count; ++i) {
        if (random.chance(0.1)) {
            const int bits = random.range(1, 16);
            symbols.push_back({random() & ((1u << bits) - 1), 1, bits});
            continue;
        }
        const auto zero = static_cast<std::uint32_t>(random.range(1, 4095));
        const bool one = random.unit() * skew > zero / 4096.0;
        symbols.push_back({one ? zero : 0, one ? 4096 - zero : zero, 12});
    }
    return symbols;
}

Bytes encode(const std::vector<CodedSymbol>& symbols) {
    RansEncoder encoder;
    for (const CodedSymbol& s : symbols)
        encoder.put(s.start, s.frequency, s.bits);
    Bytes out;
    encoder.finish(out);
    return out;
}

void decode(RansDecoder& decoder, const CodedSymbol& s) {
    if (s.bits != 12 || s.frequency == 1) {
        ASSERT_EQ(decoder.raw(s.bits), s.start);
        return;
    }
    ASSERT_GE(decoder.slot(), s.start);
    ASSERT_LT(decoder.slot(), s.start + s.frequency);
    decoder.consume(s.start, s.frequency);
}

TEST(Rans, RandomStreamsRoundTripAndEndExactly) {
    Random random(6);
    for (int round = 0; round < 600; ++round) {
        const auto symbols = random_symbols(random, round < 50 ? round % 5 : random.range(0, 3000),
                                            random.unit() * 1.5);
        const Bytes bytes = encode(symbols);
        ASSERT_EQ(bytes.size() % 2, 0u);
        // The buffer is exactly as long as the stream, so that the address sanitizer detects reads
        // past it.
        RansDecoder decoder(bytes);
        for (const CodedSymbol& s : symbols)
            ASSERT_NO_FATAL_FAILURE(decode(decoder, s));
        ASSERT_TRUE(decoder.ended_well());
        for (int i = 0; i < 20; ++i)
            decoder.bit(2048), decoder.raw(16);

        double bits = 0;
        for (const CodedSymbol& s : symbols)
            bits += s.bits - std::log2(s.frequency);
        ASSERT_LE(static_cast<double>(bytes.size()), bits / 8 * 1.005 + 4);

        if (!symbols.empty() && symbols.back().start != 0) { // stopping early is detected
            RansDecoder early(bytes);
            for (std::size_t i = 0; i + 1 < symbols.size(); ++i)
                ASSERT_NO_FATAL_FAILURE(decode(early, symbols[i]));
            ASSERT_FALSE(early.ended_well());
        }
        for (const std::size_t more : {1u, 2u}) { // so are bytes after the stream
            Bytes longer = bytes;
            longer.insert(longer.end(), more,
                          std::byte{1}); // not zero: zeros could not be detected
            RansDecoder tail(longer);
            for (const CodedSymbol& s : symbols)
                tail.consume(s.frequency == 1 && s.bits != 12 ? 0 : s.start, s.frequency);
            ASSERT_FALSE(tail.ended_well()) << "after " << more << " extra bytes";
        }
    }
}

TEST(Rans, EmptyStreamIsAllFirstSymbols) {
    RansDecoder decoder{std::span<const std::byte>{}};
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(decoder.slot(), 0u);
        ASSERT_FALSE(decoder.bit(1u + static_cast<unsigned>(i) * 4));
        ASSERT_EQ(decoder.raw(i % 17), 0u);
    }
    EXPECT_TRUE(decoder.ended_well());
    RansEncoder encoder;
    for (int i = 0; i < 1000; ++i)
        encoder.bit(false, 4095);
    Bytes bytes;
    encoder.finish(bytes);
    EXPECT_TRUE(bytes.empty());
}

TEST(Rans, AnyBytesDecodeInRange) {
    Random random(7);
    for (int round = 0; round < 200; ++round) {
        const Bytes bytes = random.bytes(static_cast<std::size_t>(random.range(0, 40)));
        RansDecoder decoder(bytes);
        for (int i = 0; i < 200; ++i) {
            ASSERT_LT(decoder.slot(), 4096u);
            decoder.bit(static_cast<std::uint32_t>(random.range(1, 4095)));
            const int bits = random.range(0, 16);
            ASSERT_LT(decoder.raw(bits), 1u << bits);
        }
    }
}

} // namespace
} // namespace tessera::test
