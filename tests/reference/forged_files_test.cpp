// Compares the library with the second decoder on hand-made and damaged files.
#include "format/tile/features.h"
#include "tests/reference/agreement.h"
#include "tests/support/decode_cases.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <utility>

namespace tessera {
namespace {

using namespace test;

// The parts of a file. seal() writes them with one page for all tiles and with correct checksums.
struct Parts {
    Bytes header;                                        // 92 bytes
    std::vector<std::pair<std::string, Bytes>> sections; // of the section table
    std::vector<Bytes> tiles;                            // at most 256

    static std::uint64_t number(const Bytes& b, std::size_t at, std::size_t length) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < length; ++i)
            value |= static_cast<std::uint64_t>(b[at + i]) << 8 * i;
        return value;
    }
    static void put(Bytes& b, std::size_t at, std::uint64_t value, std::size_t length) {
        b.resize(std::max(b.size(), at + length));
        for (std::size_t i = 0; i < length; ++i)
            b[at + i] = static_cast<std::byte>(value >> 8 * i & 255);
    }
    static void append(Bytes& b, std::uint64_t value, std::size_t length) {
        put(b, b.size(), value, length);
    }

    // Splits a file that has a single tile.
    explicit Parts(const Bytes& file) : header(file.begin(), file.begin() + 92) {
        const std::size_t count = number(header, 36, 1);
        auto at = file.begin() + static_cast<std::ptrdiff_t>(92 + 12 * count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t entry = 92 + 12 * i;
            std::string type(4, ' ');
            std::memcpy(type.data(), &file[entry], 4);
            const auto end = at + static_cast<std::ptrdiff_t>(number(file, entry + 8, 4));
            sections.emplace_back(type, Bytes(at, end));
            at = end;
        }
        tiles.emplace_back(at + static_cast<std::ptrdiff_t>(number(header, 32, 4)), file.end());
    }

    Bytes& section(const std::string& type) {
        for (auto& [name, bytes] : sections)
            if (name == type)
                return bytes;
        ADD_FAILURE() << "no section " << type;
        std::abort();
    }

    Bytes seal() {
        Bytes data, record;
        put(header, 38, 4096, 2); // page_target, so that one page is enough
        // k = 0, has_empty, the bits, and every length as an escape code.
        std::vector<bool> bits(5, false);
        bits.push_back(true);
        for (const Bytes& tile : tiles)
            bits.push_back(!tile.empty());
        for (const Bytes& tile : tiles) {
            data.insert(data.end(), tile.begin(), tile.end());
            if (tile.empty())
                continue;
            bits.insert(bits.end(), 24, true);
            for (int i = 0; i < 32; ++i)
                bits.push_back((tile.size() - 1) >> i & 1);
        }
        EXPECT_LE(data.size(), 65536u);
        record.resize((bits.size() + 7) / 8);
        for (std::size_t i = 0; i < bits.size(); ++i)
            if (bits[i])
                record[i / 8] |= static_cast<std::byte>(1u << i % 8);
        Bytes seed;
        append(seed, number(header, 80, 8), 8);
        append(seed, 0, 4);
        Bytes page_seed = seed;
        append(page_seed, 0, 4);
        if (!data.empty())
            append(record, reference::crc32c(data, reference::crc32c(page_seed)), 4);
        append(record, reference::crc32c(record, reference::crc32c(seed)), 4);

        Bytes table, body;
        for (const auto& [type, bytes] : sections) {
            for (const char c : type)
                append(table, static_cast<unsigned char>(c), 1);
            append(table, reference::crc32c(bytes), 4);
            append(table, bytes.size(), 4);
            body.insert(body.end(), bytes.begin(), bytes.end());
        }
        body.insert(body.end(), record.begin(), record.end());
        body.insert(body.end(), data.begin(), data.end());
        put(header, 24, 92 + table.size() + body.size(), 8);
        put(header, 32, record.size(), 4);
        const auto first = std::span(header).first(88);
        put(header, 88, reference::crc32c(table, reference::crc32c(first)), 4);
        Bytes file = header;
        file.insert(file.end(), table.begin(), table.end());
        file.insert(file.end(), body.begin(), body.end());
        return file;
    }
};

Parts parts_of(const char* name, Extent4 size, int channels, SampleType type, RateTarget rate) {
    CodeTexture texture = make_texture(name, size, channels, type);
    return Parts(encode(texture, rate, {16, 16, 16, 16}));
}

Bytes bytes_of(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values)
        bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

// Makes section CODE that of a file without corrections. Precondition: no scan weights are stored.
void erase_correction_error(Bytes& code, int channels) {
    const std::ptrdiff_t rotated_step = Parts::number(code, 0, 2) & 1 ? 2 : 0;
    const auto error = code.begin() + 2 + 2 * channels + rotated_step + (channels > 1 ? 4 : 2);
    code.erase(error, error + 2);
}

TEST(ForgedFiles, HandMadePayloads) {
    for (const int channels : {1, 3}) {
        Parts parts =
            parts_of("noise", {6, 5, 4, 3}, channels, SampleType::unorm8, {Kind::max_error, 1});
        const Bytes whole = parts.tiles[0];
        expect_decodes(parts.seal(), "sealed again");
        const auto with = [&](const char* what, const Bytes& payload) {
            parts.tiles[0] = payload;
            return expect_agreement(parts.seal(), what).accepted;
        };
        EXPECT_TRUE(with("no payload", {}));
        EXPECT_TRUE(with("a table and the empty stream", bytes_of({0})));
        EXPECT_TRUE(with("one zero word", bytes_of({0, 0})));
        EXPECT_FALSE(with("cut table", bytes_of({1, 0, 0})));
        EXPECT_TRUE(with("an empty segment from block 0", bytes_of({1, 0, 0, 0, 0})));
        EXPECT_FALSE(with("a segment from the end", bytes_of({1, 1, 0, 0, 0})));
        EXPECT_FALSE(with("a segment beyond the end", bytes_of({1, 2, 0, 0, 0})));
        EXPECT_FALSE(with("first blocks 0, 0", bytes_of({2, 0, 0, 0, 0, 0, 0, 0, 0})));
        EXPECT_FALSE(with("length too large", bytes_of({1, 0, 0, 1, 0})));
        EXPECT_TRUE(with("an empty mask", bytes_of({0x80, 0, 0})));
        EXPECT_FALSE(with("mask of a missing chunk", bytes_of({0x80, 2, 0, 1, 0, 0, 0})));
        EXPECT_FALSE(with("empty correction stream", bytes_of({0x80, 1, 0, 0, 0})));
        EXPECT_TRUE(with("zero correction stream", bytes_of({0x80, 1, 0, 1, 0, 0, 0})));
        Parts::put(parts.header, 16, 0, 4);
        erase_correction_error(parts.section("CODE"), channels);
        EXPECT_TRUE(with("no payload and no corrections", {}));
        EXPECT_FALSE(with("a mask without the feature", bytes_of({0x80, 0, 0})));
        EXPECT_FALSE(with("corrections without the feature", whole));
    }
}

TEST(ForgedFiles, Backgrounds) {
    for (const int channels : {1, 2, 3, 4}) {
        Parts parts =
            parts_of("waves", {6, 5, 4, 3}, channels, SampleType::half16, {Kind::quality, 60});
        const Bytes whole = parts.tiles[0];
        for (const int sample : {0, 1, 0x8000, 0x8001, 0x7BFF, 0xFBFF, 0x7C00, 0x7E00, 0xFC00}) {
            for (int c = 0; c < channels; ++c)
                Parts::put(parts.header, 72 + 2 * static_cast<std::size_t>(c),
                           static_cast<std::uint64_t>(sample), 2);
            for (const Bytes& payload : {whole, Bytes{}, bytes_of({0})}) {
                parts.tiles[0] = payload;
                expect_agreement(parts.seal(), "background " + std::to_string(sample) + " x" +
                                                   std::to_string(channels) + ", payload " +
                                                   std::to_string(payload.size()));
            }
        }
    }
}

// Sets bytes of the header and of CODE to special values and corrects the checksums.
TEST(ForgedFiles, ChangedHeadersAndCodes) {
    std::mt19937 engine(3);
    int accepted = 0;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const char* name : {"coloured", "waves"})
            for (const RateTarget& rate :
                 {RateTarget{Kind::quality, 70}, RateTarget{Kind::max_error, 1}}) {
                const Parts original =
                    parts_of(name, {5, 4, 3, 4}, 3 + (type == SampleType::half16), type, rate);
                for (std::size_t at = 12; at < 92 + 24; ++at)
                    for (const std::uint64_t value :
                         std::vector<std::uint64_t>{0, 1, 2, 32, 64, 255, engine() % 256}) {
                        Parts parts = original;
                        if (at < 92)
                            Parts::put(parts.header, at, value, 1);
                        else
                            Parts::put(parts.section("CODE"), at - 92, value, 1);
                        // These bytes are the size. Both decoders would try to decode a huge
                        // texture.
                        if (at >= 40 && at < 56)
                            continue;
                        accepted += expect_agreement(parts.seal(), std::string(name) + ": byte " +
                                                                       std::to_string(at) + " = " +
                                                                       std::to_string(value))
                                        .accepted;
                    }
            }
    EXPECT_GT(accepted, 1000);
}

TEST(ForgedFiles, SmoothCopiesNeedPredictions) {
    Parts parts = parts_of("waves", {9, 8, 3, 4}, 3, SampleType::unorm8, {Kind::quality, 70});
    const std::size_t flags = 0;
    const std::uint64_t before = Parts::number(parts.section("CODE"), flags, 2);
    ASSERT_EQ(before & 2, 2u); // predictions
    const auto with = [&](std::uint64_t value, std::uint64_t features) {
        Parts::put(parts.section("CODE"), flags, value, 2);
        Parts::put(parts.header, 16, features, 4);
        return expect_agreement(parts.seal(), "flags " + std::to_string(value)).accepted;
    };
    EXPECT_TRUE(with(before | 8, feature_prediction));
    EXPECT_TRUE(with(before & ~std::uint64_t{8}, feature_prediction));
    EXPECT_FALSE(with((before | 8) & ~std::uint64_t{2}, 0));
    EXPECT_FALSE(with((before | 8) & ~std::uint64_t{2}, feature_prediction));
    EXPECT_FALSE(with(before | 32, feature_prediction));
}

// Random trees, copies and levels, which no encoder chooses. Some tiles are large, and some base
// pictures are larger than a block.
TEST(ForgedFiles, PredictedTiles) {
    for (const DecodeCase& test : predicted_cases()) {
        const Outcome outcome = expect_agreement(test.file, test.name);
        EXPECT_TRUE(outcome.accepted) << test.name << ": " << outcome.error;
    }
}

// Steps over their whole range, which test shifts, limits and overflow.
TEST(ForgedFiles, ChangedSteps) {
    std::mt19937 engine(4);
    int accepted = 0;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const char* name : {"coloured", "noise", "signed"})
            for (const Extent4& size :
                 {Extent4{6, 5, 4, 3}, Extent4{16, 16, 1, 1}, Extent4{1, 1, 1, 1}})
                for (int channels = 1; channels <= 4; channels += 1 + (channels < 3)) {
                    Parts parts = parts_of(name, size, channels, type, {Kind::quality, 90});
                    Bytes& code = parts.section("CODE");
                    const bool rotates = Parts::number(code, 0, 2) & 1;
                    const auto planes = static_cast<std::size_t>(channels);
                    const std::size_t offsets = 2 + 2 * (planes + (rotates ? 1 : 0));
                    for (int i = 0; i < 30; ++i) {
                        for (std::size_t at = 2; at < offsets; at += 2)
                            Parts::put(code, at, (engine() % 21) << 11 | engine() % 2048, 2);
                        for (std::size_t at = 0; at < (planes > 1 ? 4u : 2u); ++at)
                            Parts::put(code, offsets + at, engine() % 32, 1);
                        accepted += expect_agreement(parts.seal(), "changed steps").accepted;
                    }
                }
    EXPECT_GT(accepted, 1000);
}

// Changes tiles and corrects the checksums. Both decoders must refuse or agree.
TEST(ForgedFiles, ChangedTiles) {
    std::mt19937 engine(5);
    int accepted = 0;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const char* name : {"coloured", "waves", "noise"})
            for (const RateTarget& rate :
                 {RateTarget{Kind::quality, 90}, RateTarget{Kind::max_error, 2}}) {
                const Parts original = parts_of(name, {5, 4, 3, 4}, 3, type, rate);
                for (int i = 0; i < 400; ++i) {
                    Parts parts = original;
                    Bytes& tile = parts.tiles[0];
                    for (int change = 0; change < 1 + i % 3 && !tile.empty(); ++change) {
                        const std::size_t at =
                            engine() % 2 ? engine() % tile.size()
                                         : engine() % std::min<std::size_t>(tile.size(), 12);
                        switch (engine() % 4) {
                        case 0:
                            tile[at] ^= static_cast<std::byte>(1u << engine() % 8);
                            break;
                        case 1:
                            tile[at] = static_cast<std::byte>(engine() % 256);
                            break;
                        case 2:
                            tile.resize(at);
                            break;
                        case 3:
                            tile.insert(tile.begin() + static_cast<std::ptrdiff_t>(at),
                                        static_cast<std::byte>(engine() % 4));
                            break;
                        }
                    }
                    accepted += expect_agreement(parts.seal(), name).accepted;
                }
            }
    EXPECT_GT(accepted, 10);
}

} // namespace
} // namespace tessera
