// The library against the second decoder (tests/reference, written from FORMAT.md alone), on files
// of the encoder, on hand-made and damaged files, and on frozen ones (tests/golden).
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "corpus/bake.h"
#include "format/tile/features.h"
#include "tests/reference/spec_decoder.h"
#include "tests/support/efforts.h"
#include "tests/support/fnv1a.h"
#include "tests/support/moving_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace tessera {
namespace {

using Bytes = std::vector<std::byte>;
using Kind = RateTarget::Kind;
using test::fnv1a_64;
namespace reference = tessera_reference;

// ------------------------------------------------------------------------------------- textures

std::uint16_t half_of_code(int code) {
    return static_cast<std::uint16_t>(code < 0 ? 0x8000 | -code : code);
}

// Samples by their codes: 0..255, or a half's low 15 bits with its sign.
class CodeTexture : public TexelSource {
public:
    using Function = std::function<double(double u, double v, double s, double t, int c)>;

    // f's values 0..1 span the codes 0..255, or 0..31743 of the halves; the coordinates are 0..1.
    CodeTexture(TextureDesc desc, const Function& f) : desc_(desc) {
        const auto n = desc_.size;
        for (std::uint32_t v = 0; v < n[1]; ++v)
            for (std::uint32_t u = 0; u < n[0]; ++u)
                for (std::uint32_t t = 0; t < n[3]; ++t)
                    for (std::uint32_t s = 0; s < n[2]; ++s)
                        for (int c = 0; c < desc_.channels; ++c)
                            store(f((u + 0.5) / n[0], (v + 0.5) / n[1], (s + 0.5) / n[2],
                                    (t + 0.5) / n[3], c));
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        const std::size_t texel = desc_.texel_bytes();
        const std::size_t row = (box.end[2] - box.begin[2]) * texel;
        std::byte* to = out.data();
        for (std::size_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::size_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::size_t t = box.begin[3]; t < box.end[3]; ++t, to += row) {
                    const std::size_t from =
                        ((v * desc_.size[0] + u) * desc_.size[3] + t) * desc_.size[2] +
                        box.begin[2];
                    std::memcpy(to, &texels_[from * texel], row);
                }
        return {};
    }

private:
    void store(double x) {
        if (desc_.type == SampleType::unorm8) {
            texels_.push_back(static_cast<std::byte>(std::lround(std::clamp(x, 0.0, 1.0) * 255)));
            return;
        }
        const int code = static_cast<int>(std::lround(std::clamp(x, -1.0, 1.0) * 31743));
        texels_.push_back(static_cast<std::byte>(half_of_code(code) & 255));
        texels_.push_back(static_cast<std::byte>(half_of_code(code) >> 8));
    }

    TextureDesc desc_;
    Bytes texels_;
};

double random_unit(std::mt19937& engine) {
    return engine() / 4294967296.0;
}

CodeTexture::Function pattern(const std::string& name) {
    if (name == "black")
        return [](double, double, double, double, int) { return 0.0; };
    if (name == "constant")
        return [](double, double, double, double, int c) { return 0.3 + 0.2 * c; };
    const auto engine = std::make_shared<std::mt19937>(5u);
    if (name == "noise")
        return [engine](double, double, double, double, int) { return random_unit(*engine); };
    if (name == "signed") // half floats of both signs
        return
            [engine](double, double, double, double, int) { return 2 * random_unit(*engine) - 1; };
    const auto waves = [](double u, double v, double s, double t, int c) {
        return 0.5 + 0.25 * std::sin(9 * u + 7 * s + c) + 0.2 * std::cos(11 * v - 5 * t + 2 * c);
    };
    if (name == "waves")
        return waves;
    if (name == "sparse") // one corner has something
        return [waves](double u, double v, double s, double t, int c) {
            return u < 0.3 && v < 0.4 ? waves(u, v, s, t, c) : 0.0;
        };
    // "coloured": noise along one direction of colour, for rotated blocks; opaque
    std::array<double, 3> last{};
    return [engine, last](double, double, double, double, int c) mutable {
        if (c == 3)
            return 1.0;
        if (c == 0) {
            const double x = random_unit(*engine) - 0.5;
            last = {0.5, 0.5 + 0.6 * x, 0.5 + 0.6 * x};
        }
        return last[static_cast<std::size_t>(c)];
    };
}

CodeTexture make_texture(const std::string& name, Extent4 size, int channels,
                         SampleType type = SampleType::unorm8) {
    return {{size, type, static_cast<std::uint8_t>(channels)}, pattern(name)};
}

// An 8-bit RGB texture with an alpha that falls along v.
class WithAlpha : public TexelSource {
public:
    explicit WithAlpha(TexelSource& rgb) : rgb_(rgb), desc_(rgb.desc()) { desc_.channels = 4; }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        Bytes rgb(rgb_.desc().box_bytes(box));
        const Status status = rgb_.read(box, rgb);
        const std::size_t rows = box.end[1] - box.begin[1];
        const std::size_t row = box.texels() / rows;
        for (std::size_t i = 0; i < box.texels(); ++i) {
            std::memcpy(&out[4 * i], &rgb[3 * i], 3);
            out[4 * i + 3] = static_cast<std::byte>(255 - 2 * (box.begin[1] + i / row));
        }
        return status;
    }

private:
    TexelSource& rgb_;
    TextureDesc desc_;
};

// --------------------------------------------------------------------------------- both decoders

Bytes encode(TexelSource& source, RateTarget rate, Extent4 tile_extent, Metadata metadata = {},
             std::optional<int> effort = {}) {
    EncodeOptions options;
    options.rate = rate;
    options.tile_extent = tile_extent;
    options.threads = 1;
    options.effort =
        effort.value_or(texel_count(source.desc().size) < 5000 ? test::copies_effort : 0);
    options.verify = false; // that is what this test is for
    options.metadata = std::move(metadata);
    Bytes file;
    const Result<EncodeReport> report = encode_memory(source, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

struct Outcome {
    bool accepted = false;
    std::string error;
    Bytes texels;
    std::map<std::string, std::string> metadata;
};

Outcome by_library(const Bytes& file) {
    Outcome outcome;
    const auto source = wrap_memory(file);
    const Result<Decoder> decoder = Decoder::open(*source);
    if (!decoder) {
        outcome.error = decoder.status().message();
        return outcome;
    }
    const Box4 box = Box4::whole(decoder->desc().size);
    outcome.texels.resize(decoder->desc().box_bytes(box));
    const Status status = decoder->decode_box(box, outcome.texels);
    if (!status) {
        outcome.error = status.message();
        return outcome;
    }
    outcome.accepted = true;
    for (const auto& [key, value] : decoder->container().metadata())
        outcome.metadata[key] = value;
    return outcome;
}

Outcome by_reference(const Bytes& file) {
    Outcome outcome;
    std::optional<reference::Decoded> decoded = reference::decode(file, outcome.error);
    if (decoded) {
        outcome.accepted = true;
        outcome.texels = std::move(decoded->texels);
        outcome.metadata = decoded->metadata;
    }
    return outcome;
}

// Both accept or both refuse; if they accept, they agree.
Outcome expect_agreement(const Bytes& file, const std::string& what) {
    const Outcome library = by_library(file), specification = by_reference(file);
    EXPECT_EQ(library.accepted, specification.accepted)
        << what << "; library: '" << library.error << "', reference: '" << specification.error
        << "'";
    if (library.accepted && specification.accepted) {
        EXPECT_TRUE(library.texels == specification.texels) << what;
        EXPECT_EQ(library.metadata, specification.metadata) << what;
    }
    return specification;
}

void expect_decodes(const Bytes& file, const std::string& what) {
    const Outcome outcome = expect_agreement(file, what);
    EXPECT_TRUE(outcome.accepted) << what << ": " << outcome.error;
}

// ------------------------------------------------------------------------------ files of the encoder

const RateTarget rates[] = {{Kind::quality, 20},  {Kind::quality, 60},  {Kind::quality, 95},
                            {Kind::max_error, 0}, {Kind::max_error, 1}, {Kind::max_error, 3}};
const Extent4 extents[] = {{8, 8, 4, 4}, {32, 32, 8, 8}, {5, 7, 3, 2}, {16, 16, 16, 16}};

std::string describe(const RateTarget& rate, const Extent4& extent) {
    return std::string(rate.kind == Kind::quality ? ", quality " : ", max error ") +
           std::to_string(static_cast<int>(rate.value)) + ", tiles " + to_string(extent);
}

void check_all_rates(TexelSource& source, const std::string& what, bool all_extents) {
    for (std::size_t r = 0; r < std::size(rates); ++r)
        for (std::size_t e = 0; e < std::size(extents); ++e)
            if (all_extents || e == r % std::size(extents))
                expect_decodes(encode(source, rates[r], extents[e]),
                               what + describe(rates[r], extents[e]));
}

TEST(Reference, SmallTexturesOfEveryKind) {
    for (const Extent4& size : {Extent4{1, 1, 1, 1}, Extent4{7, 5, 3, 2}, Extent4{1, 9, 1, 17}})
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (int channels = 1; channels <= 4; ++channels)
                for (const char* name : {"black", "constant", "waves", "noise", "signed"}) {
                    CodeTexture texture = make_texture(name, size, channels, type);
                    check_all_rates(texture,
                                    std::string(name) + " " + to_string(size) + " x" +
                                        std::to_string(channels),
                                    size[0] == 7);
                }
}

TEST(Reference, OddAndLargerTextures) {
    int turn = 0;
    for (const Extent4& size : {Extent4{33, 9, 9, 13}, Extent4{40, 20, 9, 8}})
        for (const SampleType type : {SampleType::unorm8, SampleType::half16})
            for (const char* name : {"sparse", "waves", "coloured"}) {
                const int channels = 1 + turn % 4;
                CodeTexture texture = make_texture(name, size, channels, type);
                for (std::size_t i = 0; i < 2; ++i) {
                    const auto k = static_cast<std::size_t>(turn);
                    const RateTarget& rate = rates[(k + 3 * i) % std::size(rates)];
                    const Extent4& extent = extents[(k + i) % std::size(extents)];
                    expect_decodes(encode(texture, rate, extent),
                                   std::string(name) + " " + to_string(size) + " x" +
                                       std::to_string(channels) + describe(rate, extent));
                }
                ++turn;
            }
}

TEST(Reference, ScenesOfTheCorpus) {
    std::size_t turn = 0;
    for (const char* scene : {"composed", "lamps", "gallery", "hard"}) {
        const Extent4 size = turn % 2 ? Extent4{40, 20, 9, 8} : Extent4{33, 9, 9, 13};
        auto source = corpus::make_baked_source(scene, size, 2, 1);
        ASSERT_TRUE(source) << source.status().message();
        for (std::size_t i = 0; i < std::size(rates); i += 2) {
            const RateTarget& rate = rates[(turn + i) % std::size(rates)];
            const Extent4& extent = extents[(turn + i / 2) % std::size(extents)];
            expect_decodes(encode(**source, rate, extent), scene + describe(rate, extent));
        }
        ++turn;
    }
    auto rgb = corpus::make_baked_source("composed", {20, 9, 8, 8}, 2, 1);
    ASSERT_TRUE(rgb) << rgb.status().message();
    WithAlpha rgba(**rgb);
    for (const RateTarget& rate : rates)
        expect_decodes(encode(rgba, rate, extents[1]), "RGBA" + describe(rate, extents[1]));
}

// Views that move by two texels each, one along v by two the other way, are moved back in the grid of tiles.
TEST(Reference, AlignedViews) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const RateTarget& rate :
             {RateTarget{Kind::quality, 60}, RateTarget{Kind::max_error, 0}})
            for (const int v : {2, -2}) {
                test::MemoryTexture texture = test::moving_views({{41, 40, 3, 4}, type, 1}, 2, v);
                const Bytes file = encode(texture, rate, {16, 12, 3, 4}, {}, test::copies_effort);
                EXPECT_EQ(file[16] & std::byte{64}, std::byte{64}); // feature 6
                EXPECT_EQ(file[78], std::byte{0xFE});
                EXPECT_EQ(file[79], static_cast<std::byte>(-v));
                expect_decodes(file, "moving by " + std::to_string(v));
            }
}

// Blocks longer than the frequencies that are coded of them.
TEST(Reference, TilesOfUpTo64Texels) {
    for (const char* name : {"waves", "coloured", "noise"})
        for (const auto& [size, extent] : {std::pair{Extent4{70, 66, 5, 3}, Extent4{64, 64, 4, 4}},
                                           {{63, 45, 3, 2}, {63, 45, 3, 2}},
                                           {{64, 1, 6, 6}, {64, 1, 6, 6}},
                                           {{3, 130, 4, 1}, {8, 64, 4, 1}}})
            for (const RateTarget& rate : {RateTarget{Kind::quality, 50}, {Kind::quality, 95}}) {
                CodeTexture texture = make_texture(name, size, 3, SampleType::unorm8);
                expect_decodes(encode(texture, rate, extent),
                               name + (" " + to_string(size)) + describe(rate, extent));
            }
    auto source = corpus::make_baked_source("composed", {80, 64, 6, 4}, 2, 1);
    ASSERT_TRUE(source) << source.status().message();
    expect_decodes(encode(**source, {Kind::quality, 55}, {64, 64, 4, 4}), "composed, wide tiles");
}

// Noise at the finest quality: the work of a tile fills several segments, tiles several pages.
TEST(Reference, TilesOfManySegments) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const int channels : {3, 4})
            for (const char* name : {"noise", "coloured"}) {
                CodeTexture texture = make_texture(name, {17, 9, 16, 16}, channels, type);
                expect_decodes(encode(texture, {Kind::quality, 100}, {16, 16, 16, 16}), name);
            }
    CodeTexture texture = make_texture("noise", {16, 8, 16, 16}, 3, SampleType::unorm8);
    expect_decodes(encode(texture, {Kind::max_error, 0}, {16, 16, 16, 16}), "lossless noise");
}

TEST(Reference, Metadata) {
    CodeTexture texture = make_texture("waves", {3, 2, 2, 2}, 1);
    for (const Metadata& metadata :
         {Metadata{}, Metadata{{"Author", "J\xC3\xA4ger"}, {"empty", ""}},
          Metadata{{"long", std::string(100000, 'x')}, {"\xC3\xA4", "2"}, {"z", "1"}}}) {
        const Bytes file = encode(texture, {Kind::quality, 60}, {8, 8, 4, 4}, metadata);
        const Outcome outcome = expect_agreement(file, "metadata");
        ASSERT_TRUE(outcome.accepted) << outcome.error;
        for (const auto& [key, value] : metadata)
            EXPECT_EQ(outcome.metadata.at(key), value);
    }
}

// --------------------------------------------------------------------- hand-made and damaged files

// A file in parts. seal() writes it with one page for all tiles and every checksum right.
struct Parts {
    Bytes header; // 128 bytes
    std::vector<std::pair<std::string, Bytes>> sections;
    std::vector<Bytes> tiles; // at most 256

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

    // Of a file with a single tile.
    explicit Parts(const Bytes& file) : header(file.begin(), file.begin() + 128) {
        for (std::size_t i = 0; i < number(header, 44, 2); ++i) {
            const std::size_t entry = 128 + 24 * i;
            std::string type(4, ' ');
            std::memcpy(type.data(), &file[entry], 4);
            const auto first =
                file.begin() + static_cast<std::ptrdiff_t>(number(file, entry + 8, 8));
            sections.emplace_back(type, Bytes(first, first + static_cast<std::ptrdiff_t>(
                                                                 number(file, entry + 16, 8))));
        }
        tiles.push_back(section("DATA"));
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
        put(header, 46, 4096, 2); // page_target, so that one page is enough
        // k = 0, has_empty, the bits, and every length by its escape.
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
        append(seed, number(header, 112, 8), 8);
        append(seed, 0, 4);
        Bytes page_seed = seed;
        append(page_seed, 0, 4);
        if (!data.empty())
            append(record, reference::crc32c(data, reference::crc32c(page_seed)), 4);
        append(record, reference::crc32c(record, reference::crc32c(seed)), 4);
        section("INDX") = record;
        section("DATA") = data;

        std::uint64_t data_offset = 128 + 24 * sections.size();
        for (const auto& [type, bytes] : sections)
            data_offset += type == "DATA" ? 0 : bytes.size();
        Bytes root;
        append(root, data_offset, 8);
        append(root, 0, 4);
        append(root, data_offset + data.size(), 8);
        append(root, record.size(), 4);
        section("ROOT") = root;

        Bytes table, body;
        for (const auto& [type, bytes] : sections) {
            const std::uint64_t offset = 128 + 24 * sections.size() + body.size();
            const bool own = type == "INDX" || type == "DATA";
            if (type == "INDX")
                put(header, 40, offset, 4);
            for (const char c : type)
                append(table, static_cast<unsigned char>(c), 1);
            append(table, own ? 0 : reference::crc32c(bytes), 4);
            append(table, offset, 8);
            append(table, bytes.size(), 8);
            body.insert(body.end(), bytes.begin(), bytes.end());
        }
        put(header, 32, 128 + table.size() + body.size(), 8);
        const auto first = std::span(header).first(124);
        put(header, 124, reference::crc32c(table, reference::crc32c(first)), 4);
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

TEST(Reference, HandMadePayloads) {
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
        Parts::put(parts.header, 16, 0, 8);
        EXPECT_FALSE(with("a mask without the feature", bytes_of({0x80, 0, 0})));
        EXPECT_FALSE(with("corrections without the feature", whole));
    }
}

TEST(Reference, Backgrounds) {
    for (const int channels : {1, 2, 3, 4}) {
        Parts parts =
            parts_of("waves", {6, 5, 4, 3}, channels, SampleType::half16, {Kind::quality, 60});
        const Bytes whole = parts.tiles[0];
        for (const int sample : {0, 1, 0x8000, 0x8001, 0x7BFF, 0xFBFF, 0x7C00, 0x7E00, 0xFC00}) {
            for (int c = 0; c < channels; ++c)
                Parts::put(parts.header, 104 + 2 * static_cast<std::size_t>(c),
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

// Any byte of the header and of CODE set to special values, with the checksums made right again.
TEST(Reference, ChangedHeadersAndCodes) {
    std::mt19937 engine(3);
    int accepted = 0;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const char* name : {"coloured", "waves"})
            for (const RateTarget& rate :
                 {RateTarget{Kind::quality, 70}, RateTarget{Kind::max_error, 1}}) {
                const Parts original =
                    parts_of(name, {5, 4, 3, 4}, 3 + (type == SampleType::half16), type, rate);
                for (std::size_t at = 12; at < 128 + 24; ++at)
                    for (const std::uint64_t value :
                         std::vector<std::uint64_t>{0, 1, 2, 32, 64, 255, engine() % 256}) {
                        Parts parts = original;
                        if (at < 128)
                            Parts::put(parts.header, at, value, 1);
                        else
                            Parts::put(parts.section("CODE"), at - 128, value, 1);
                        // A file whose size is huge: both would try to decode it.
                        if (at >= 48 && at < 64)
                            continue;
                        accepted += expect_agreement(parts.seal(), std::string(name) + ": byte " +
                                                                       std::to_string(at) + " = " +
                                                                       std::to_string(value))
                                        .accepted;
                    }
            }
    EXPECT_GT(accepted, 1000);
}

TEST(Reference, SmoothCopiesNeedPredictions) {
    Parts parts = parts_of("waves", {9, 8, 3, 4}, 3, SampleType::unorm8, {Kind::quality, 70});
    const std::size_t flags = 23;
    const std::uint64_t before = Parts::number(parts.section("CODE"), flags, 1);
    ASSERT_EQ(before & 2, 2u); // predictions
    const auto with = [&](std::uint64_t value, std::uint64_t features) {
        Parts::put(parts.section("CODE"), flags, value, 1);
        Parts::put(parts.header, 16, features, 8);
        return expect_agreement(parts.seal(), "flags " + std::to_string(value)).accepted;
    };
    EXPECT_TRUE(with(before | 8, feature_prediction));
    EXPECT_TRUE(with(before & ~std::uint64_t{8}, feature_prediction));
    EXPECT_FALSE(with((before | 8) & ~std::uint64_t{2}, 0));
    EXPECT_FALSE(with((before | 8) & ~std::uint64_t{2}, feature_prediction));
    EXPECT_FALSE(with(before | 32, feature_prediction));
}

// Steps from one end of their range to the other: shifts, limits, overflow.
TEST(Reference, ChangedSteps) {
    std::mt19937 engine(4);
    int accepted = 0;
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (const char* name : {"coloured", "noise", "signed"})
            for (const Extent4& size :
                 {Extent4{6, 5, 4, 3}, Extent4{16, 16, 1, 1}, Extent4{1, 1, 1, 1}})
                for (int channels = 1; channels <= 4; channels += 1 + (channels < 3)) {
                    Parts parts = parts_of(name, size, channels, type, {Kind::quality, 90});
                    for (int i = 0; i < 30; ++i) {
                        for (std::size_t plane = 0; plane < 5; ++plane)
                            Parts::put(parts.section("CODE"), 2 * plane,
                                       (engine() % 21) << 11 | engine() % 2048, 2);
                        for (std::size_t at = 10; at < 14; ++at)
                            Parts::put(parts.section("CODE"), at, engine() % 32, 1);
                        accepted += expect_agreement(parts.seal(), "changed steps").accepted;
                    }
                }
    EXPECT_GT(accepted, 1000);
}

// Bits of tiles, with the checksums made right again: both refuse, or see the same.
TEST(Reference, ChangedTiles) {
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

// The copy of the normative table is the table.
TEST(Reference, DefaultParametersAreCopiedRight) {
    const std::filesystem::path root =
        std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
    std::ifstream in(root / "format/tile/default_parameters.cpp");
    ASSERT_TRUE(in) << "the test needs the source tree";
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::size_t begin = text.find("= {") + 3;
    std::string list = text.substr(begin, text.find("};") - begin);
    std::replace(list.begin(), list.end(), ',', ' ');
    std::istringstream numbers(list);
    const std::vector<int> table{std::istream_iterator<int>(numbers), {}};
    const auto copy = reference::default_parameters();
    EXPECT_EQ(std::vector<int>(copy.begin(), copy.end()), table);
}

// ------------------------------------------------------------------------------------ golden files

std::filesystem::path golden(const std::string& name) {
    return std::filesystem::path(__FILE__).parent_path().parent_path() / "golden" / name;
}

// Rewrites tests/golden; see its README.md.
void regenerate_golden() {
    std::ofstream manifest(golden("manifest.txt"));
    const auto write = [&](const std::string& name, TexelSource& source, RateTarget rate,
                           Extent4 tile_extent, std::optional<int> effort = {}) {
        const Bytes file =
            encode(source, rate, tile_extent, {{"Software", "golden"}, {"Title", name}}, effort);
        std::ofstream(golden(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()),
                   static_cast<std::streamsize>(file.size()));
        const Outcome outcome = by_reference(file);
        ASSERT_TRUE(outcome.accepted) << outcome.error;
        manifest << name << ' ' << std::hex << fnv1a_64(outcome.texels) << '\n';
    };
    const auto scene = [&](const std::string& name, const char* of, Extent4 size, RateTarget rate,
                           Extent4 tile_extent) {
        auto source = corpus::make_baked_source(of, size, 2, 1);
        ASSERT_TRUE(source) << source.status().message();
        write(name, **source, rate, tile_extent);
    };
    const auto texture = [&](const std::string& name, const char* of, Extent4 size, int channels,
                             SampleType type, RateTarget rate, Extent4 tile_extent) {
        CodeTexture source = make_texture(of, size, channels, type);
        write(name, source, rate, tile_extent);
    };
    const SampleType unorm8 = SampleType::unorm8, half16 = SampleType::half16;
    // A picture that moves by half a texel a view, along v the other way.
    CodeTexture views({{24, 24, 5, 5}, unorm8, 3},
                      [](double u, double v, double s, double t, int c) {
                          const double x = 24 * u + 2.5 * s, y = 24 * v - 2.5 * t;
                          return 0.5 + 0.2 * std::sin(x * 1.7 + c) * std::cos(y * 1.3) +
                                 0.15 * std::sin(x * 0.9 + y * 2.1 + 2 * c);
                      });
    write("rgb8_views.tess", views, {Kind::quality, 60}, {24, 24, 5, 5}, usual_effort);
    // One that moves by two texels and a half; aligned, by half a texel, in tiles that have base pictures.
    CodeTexture aligned(
        {{40, 36, 4, 3}, unorm8, 3}, [](double u, double v, double s, double t, int c) {
            return test::moving_picture(40 * u - 10 * s + 0.75, 36 * v + 7.5 * t - 1.75, c);
        });
    write("rgb8_aligned.tess", aligned, {Kind::quality, 60}, {24, 24, 4, 3}, usual_effort);
    scene("rgb8.tess", "composed", {32, 16, 8, 8}, {Kind::quality, 60}, {32, 32, 8, 8});
    scene("rgb8_tiles.tess", "gallery", {13, 7, 5, 6}, {Kind::quality, 60}, {5, 7, 3, 2});
    scene("rgb8_bounded.tess", "mirror", {10, 8, 6, 5}, {Kind::max_error, 3}, {8, 8, 4, 4});
    scene("rgb_half.tess", "lamps", {16, 16, 4, 4}, {Kind::quality, 50}, {16, 16, 4, 4});
    texture("grey8.tess", "waves", {17, 9, 5, 3}, 1, unorm8, {Kind::quality, 80}, {32, 32, 8, 8});
    auto rgb = corpus::make_baked_source("composed", {16, 12, 6, 6}, 2, 1);
    ASSERT_TRUE(rgb) << rgb.status().message();
    WithAlpha rgba(**rgb);
    write("rgba8.tess", rgba, {Kind::quality, 60}, {32, 32, 8, 8});
    texture("grey_alpha_half_lossless.tess", "signed", {5, 4, 3, 3}, 2, half16,
            {Kind::max_error, 0}, {8, 8, 4, 4});
    texture("rgb8_lossless.tess", "noise", {5, 5, 5, 5}, 3, unorm8, {Kind::max_error, 0},
            {8, 8, 8, 8});
    texture("rgb_half_stored.tess", "noise", {6, 6, 3, 3}, 3, half16, {Kind::max_error, 0},
            {3, 6, 3, 3});
    texture("background.tess", "constant", {40, 20, 16, 8}, 3, unorm8, {Kind::quality, 75},
            {8, 8, 4, 4});
    texture("sparse8.tess", "sparse", {40, 20, 3, 3}, 3, unorm8, {Kind::quality, 40}, {8, 8, 4, 4});
}

TEST(Reference, GoldenFiles) {
    if (std::getenv("TESSERA_REGENERATE_GOLDEN"))
        regenerate_golden();
    std::ifstream manifest(golden("manifest.txt"));
    std::string name;
    std::uint64_t want = 0;
    int count = 0;
    while (manifest >> name >> std::hex >> want) {
        std::ifstream in(golden(name), std::ios::binary);
        const std::string content((std::istreambuf_iterator<char>(in)), {});
        const auto bytes = std::as_bytes(std::span(content));
        const Bytes file(bytes.begin(), bytes.end());
        const Outcome library = by_library(file), specification = by_reference(file);
        EXPECT_TRUE(library.accepted) << name << ": " << library.error;
        EXPECT_TRUE(specification.accepted) << name << ": " << specification.error;
        EXPECT_EQ(fnv1a_64(library.texels), want) << name;
        EXPECT_EQ(fnv1a_64(specification.texels), want) << name;
        EXPECT_EQ(specification.metadata.count("Title"), 1u) << name;
        ++count;
    }
    EXPECT_EQ(count, 13);
}

} // namespace
} // namespace tessera
