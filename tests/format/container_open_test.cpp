// Tests how opening refuses files that no writer produces, although all checksums are correct.
#include "format/container/container_writer.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/support/container_samples.h"
#include "tests/support/forged_alignment.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

namespace tessera {
namespace {

using namespace tessera::test;

using Bytes = std::vector<std::byte>;

// A valid file with changed bytes in its header or section table, and a correct header checksum.
template <class T> Bytes patched(std::size_t offset, T value) {
    static const Bytes good = rich_sample()->write();
    Bytes file = good;
    if constexpr (std::is_same_v<T, float>)
        store_le(file.data() + offset, std::bit_cast<std::uint32_t>(value));
    else
        store_le(file.data() + offset, value);
    seal_header(file);
    return file;
}

void expect_refused(const Bytes& file, ContainerRule rule, const std::string& word,
                    ErrorCode code = ErrorCode::invalid_file) {
    const Status status = open_status(file);
    EXPECT_EQ(status.code(), code) << word;
    EXPECT_NE(status.message().find(word), std::string::npos) << word << ": " << status.message();
    const auto findings = validate_container(*wrap_memory(file));
    ASSERT_EQ(findings.size(), 1u) << word;
    EXPECT_TRUE(findings[0].fatal);
    EXPECT_EQ(findings[0].number, static_cast<int>(rule)) << findings[0].text;
}

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;

// The offset of a section's entry in the section table.
std::size_t entry_of(const Bytes& file, const std::string& type) {
    std::size_t entry = header_bytes;
    while (std::memcmp(file.data() + entry, type.data(), 4) != 0)
        entry += section_entry_bytes;
    return entry;
}

u64 offset_of(const Bytes& file, const std::string& type) {
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    EXPECT_TRUE(reader) << reader.status().message();
    return std::ranges::find(reader->sections(), type, &SectionInfo::type)->offset;
}

Bytes with_name(Bytes file, const std::string& type, const char* name) {
    std::memcpy(file.data() + entry_of(file, type), name, 4);
    seal_header(file);
    return file;
}

// rich_sample has the sections meta, CODE, prxy, xtra and ROOT.
Bytes renamed(const std::string& type, const char* name) {
    return with_name(patched(0, u8{0x89}), type, name);
}

TEST(Hostile, IdentifierAndVersion) {
    using enum ContainerRule;
    expect_refused(patched(0, u8{0x88}), identifier, "not a Tessera file");
    expect_refused(patched(8, u8{'\n'}), identifier, "transfer in text mode");
    expect_refused(patched(12, u16{1}), version, "version 1.5", ErrorCode::unsupported);
    expect_refused(patched(14, u16{7}), version, "version 0.7", ErrorCode::unsupported);
    expect_refused(patched(14, u16{4}), version, "version 0.4", ErrorCode::unsupported);
    Bytes file = patched(14, u16{5});
    file[88] ^= std::byte{1};
    expect_refused(file, header_crc, "checksum of the header");
    expect_refused(Bytes(91), length, "too few");
}

TEST(Hostile, Features) {
    for (const unsigned bit : {2u, 3u, 11u, 31u})
        expect_refused(patched(16, u32{1} << bit), ContainerRule::features, feature_name(bit),
                       ErrorCode::unsupported);
    EXPECT_TRUE(open_status(patched(16, u32{2})));
    expect_refused(patched(16, u32{1}), ContainerRule::header_field, "level_count");
    const auto findings = validate_container(*wrap_memory(patched(20, u32{1} << 30)));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::unknown_optional));
    EXPECT_FALSE(any_fatal(findings));
}

TEST(Hostile, FieldsOutOfRange) {
    const auto field = [](const Bytes& file, const char* word) {
        expect_refused(file, ContainerRule::header_field, word);
    };
    field(patched(36, u8{0}), "section_count");
    field(patched(37, u8{0}), "level_count");
    field(patched(37, u8{2}), "level_count");
    field(patched(38, u16{4097}), "page_target");
    for (std::size_t axis = 0; axis < 4; ++axis) {
        field(patched(40 + 4 * axis, u32{0}), "size");
        field(patched(40 + 4 * axis, (1u << 20) + 1), "size");
        field(patched(40 + 4 * axis, 0xFFFFFFFFu), "size");
        if (axis >= 2) // along u and v every byte is valid
            field(patched(56 + axis, u8{32}), "tile_extent");
    }
    field(patched(56, u32{0x1F1F1F1F}), "tile_extent (product)");
    field(patched(60, u8{2}), "sample_type");
    field(patched(61, u8{0}), "channels");
    field(patched(61, u8{5}), "channels");
    field(patched(62, u8{2}), "colour");
    field(patched(61, u16{0x0102}), "colour"); // two channels
    field(patched(63, u8{3}), "alpha");
    field(patched(63, u8{1}), "alpha"); // three channels
    field(patched(69, u8{1}), "reserved");
    field(patched(70, u8{1}), "align_u"); // the feature bit is missing
    field(patched(71, u8{255}), "align_v");
    field(patched(16, u32{1} << 6), "align_u"); // the alignment is 0
    field(patched(72, u16{256}), "background[0]");
    field(patched(78, u16{1}), "background[3]"); // three channels
    Bytes half = patched(60, u8{1});
    store_le(half.data() + 74, u16{0x7C00});
    seal_header(half);
    field(half, "background[1]");
}

// Header fields that contradict aligned views, and tile grids beyond the limits of a texture.
TEST(Hostile, AlignmentsThatDoNotFit) {
    const auto aligned = [](const Extent4& size, u32 alignment, u32 features = u32{1} << 6) {
        Bytes file = patched(16, features);
        for (std::size_t axis = 0; axis < 4; ++axis)
            store_le(file.data() + 40 + 4 * axis, size[axis]);
        store_le(file.data() + 64, u8{0}); // no proxy
        store_le(file.data() + 70, static_cast<u16>(alignment));
        seal_header(file);
        return file;
    };
    const auto field = [](const Bytes& file, const char* word) {
        expect_refused(file, ContainerRule::header_field, word);
    };
    constexpr u32 most = 1u << 20;
    field(aligned({most, 1, 2, 1}, 0x0001), "align_v: extent u is 1048577");
    field(aligned({1, most, 1, 2}, 0x8000), "align_v: extent v is 1048704");
    field(aligned({most, 1, most, 1}, 0x0080), "align_v: extent u is 135266176");
    field(aligned({1, 1, 8192, 8192}, 0x7F7F), "2^48"); // sides allowed, product too large
    // The grid is allowed but has more tiles, in more groups than section ROOT lists.
    for (const u32 alignment : {0x0001u, 0x7FFFu, 0x8080u, 0x0100u})
        expect_refused(aligned({258, 2, 2, 2}, alignment), ContainerRule::root, "ROOT");
    Bytes file = aligned({258, 1, 1, 1}, 0x0101);
    EXPECT_TRUE(open_status(file))
        << open_status(file).message(); // with one view the grid is the texture
    for (const u8 proxy : {1, 2, 3, 200}) {
        store_le(file.data() + 64, proxy);
        seal_header(file);
        field(file, "neither coarse levels nor a proxy");
    }
    file = aligned({258, 1, 1, 1}, 0x0101, (u32{1} << 6) + 1);
    store_le(file.data() + 37, u8{2});
    seal_header(file);
    field(file, "neither coarse levels nor a proxy");
}

TEST(Hostile, GeometryOutOfRange) {
    const Bytes good = [] {
        auto sample = rich_sample();
        Description& d = sample->contents.description;
        d.proxy = Proxy::sphere;
        d.sphere_radius = 4;
        d.viewing_radius[0] = 5;
        d.viewing_radius[1] = 6;
        sample->contents.proxy_mesh = {};
        return sample->write();
    }();
    const u64 at = offset_of(good, "geom");
    using Changes = std::vector<std::pair<std::size_t, float>>;
    const auto refused = [&](u8 proxy, const Changes& changes, const char* word) {
        Bytes file = good;
        store_le(file.data() + 64, proxy);
        for (const auto& [number, value] : changes)
            store_le(file.data() + at + 4 * number, std::bit_cast<u32>(value));
        store_le(file.data() + entry_of(good, "geom") + 4, crc32c(std::span(file).subspan(at, 24)));
        seal_header(file);
        expect_refused(file, ContainerRule::geometry, word);
    };
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        refused(1, {{axis, infinity}}, "sphere_centre");
        refused(1, {{axis, nan}}, "sphere_centre");
    }
    for (const u8 proxy : {0, 2, 4})
        refused(proxy, {}, "sphere_radius is not 0"); // none of these is a sphere
    refused(1, {{3, nan}}, "sphere_radius");
    refused(1, {{3, 0.0f}}, "sphere_radius is not above 0");
    refused(3, {{3, -1.0f}}, "sphere_radius is not above 0");
    refused(1, {{4, 7.0f}}, "viewing_radius"); // larger than the far radius
    refused(1, {{4, -1.0f}}, "viewing_radius");
    refused(1, {{5, infinity}}, "viewing_radius");
    refused(1, {{5, nan}}, "viewing_radius");
    refused(0, {{3, 0.0f}, {4, 0.0f}, {5, -0.0f}}, "no number other than 0");
    for (const u8 proxy : {1, 3})
        expect_refused(patched(64, proxy), ContainerRule::geometry, "geom is missing");
    expect_refused(with_name(good, "geom", "abcd"), ContainerRule::geometry, "geom is missing");
    expect_refused(renamed("xtra", "geom"), ContainerRule::geometry, "10 bytes instead of 24");
}

TEST(Hostile, UnknownValuesAreAcceptedWithANote) {
    for (std::size_t offset = 64; offset <= 68; ++offset) {
        const auto findings = validate_container(*wrap_memory(patched(offset, u8{200})));
        EXPECT_FALSE(any_fatal(findings)) << offset;
        EXPECT_EQ(std::ranges::count(findings, static_cast<int>(ContainerRule::unknown_value),
                                     &Finding::number),
                  1)
            << offset;
    }
    const auto findings = validate_container(*wrap_memory(patched(64, u8{0})));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::proxy_section));
}

TEST(Hostile, SizesThatOverflow) {
    // 2^80 texels; 2^48 texels in 2^48 tiles; 2^31 tiles, which need more groups than ROOT has.
    Bytes file = patched(40, u32{1} << 20);
    for (const std::size_t offset : {44u, 48u, 52u})
        store_le(file.data() + offset, u32{1} << 20);
    seal_header(file);
    expect_refused(file, ContainerRule::header_field, "2^48");
    store_le(file.data() + 44, u32{1} << 14);
    store_le(file.data() + 48, u32{1} << 14);
    store_le(file.data() + 52, u32{1});
    seal_header(file);
    expect_refused(file, ContainerRule::levels, "more than 2^32 - 1");
    store_le(file.data() + 48, u32{1} << 12);
    store_le(file.data() + 56, u32{0x001F1F1F});
    seal_header(file);
    expect_refused(file, ContainerRule::root, "ROOT");
}

TEST(Hostile, SectionTable) {
    using enum ContainerRule;
    expect_refused(renamed("xtra", "Xtra"), section_known, "\"Xtra\"", ErrorCode::unsupported);
    EXPECT_TRUE(open_status(renamed("xtra", "abcd")))
        << "an unknown optional section was not skipped";
    expect_refused(renamed("xtra", "ab1d"), section_table, "four letters");
    expect_refused(renamed("xtra", "meta"), section_table, "twice");
    expect_refused(renamed("xtra", "CODE"), section_table, "twice");
    expect_refused(renamed("xtra", "LEVL"), section_table, "no coarse level");
    for (const char* type : {"INDX", "DATA"})
        expect_refused(renamed("xtra", type), section_table, "is in the section table");
    expect_refused(renamed("CODE", "none"), section_table, "missing");
    expect_refused(renamed("ROOT", "none"), root, "missing");

    const Bytes good = patched(0, u8{0x89});
    const u64 file_bytes = good.size();
    for (const char* type : {"meta", "CODE", "prxy", "xtra", "ROOT"}) {
        const std::size_t entry = entry_of(good, type);
        const u32 length = load_le<u32>(good.data() + entry + 8);
        // The index would then start elsewhere, or this section's bytes would be others.
        for (const u32 wrong : {length + 1, length - 1})
            expect_refused(patched(entry + 8, wrong), section_crc, "checksum");
        for (const u32 wrong : {~u32{0}, static_cast<u32>(file_bytes), u32{1} << 31})
            expect_refused(patched(entry + 8, wrong), section_table, "past the end");
        const u32 crc = load_le<u32>(good.data() + entry + 4);
        expect_refused(patched(entry + 4, crc + 1), section_crc, "checksum");
    }
    for (const u32 wrong : {static_cast<u32>(file_bytes - offset_of(good, "INDX") + 1), ~u32{0}})
        expect_refused(patched(32, wrong), section_table, "INDX");
    expect_refused(patched(32, u32{4}), root, "past the end of INDX");
    expect_refused(patched(36, u8{63}), length, "63 entries");
    expect_refused(patched(24, u64{1} << 62), file_size, "cut off");
}

TEST(Hostile, HeadsAboveTheLimitAreNotRead) {
    Bytes file = patched(24, u64{1} << 40);
    const std::size_t entry = entry_of(file, "CODE");
    store_le(file.data() + entry + 8, max_head_bytes);
    seal_header(file);
    SparseSource source(file, u64{1} << 40);
    const Status status = ContainerReader::open(source).status();
    EXPECT_EQ(status.code(), ErrorCode::invalid_file);
    EXPECT_NE(status.message().find("above the limit"), std::string::npos) << status.message();
    EXPECT_LE(source.largest_, 16384u);
}

TEST(Hostile, ASingleGroupHasNoRoot) {
    Sample sample(random_tiles(5, 1));
    const Bytes root(12);
    sample.contents.extra = {{"xtra", root}};
    expect_refused(with_name(sample.write(), "xtra", "ROOT"), ContainerRule::root,
                   "only one group");
}

// Changes a byte of a section and corrects all checksums above it.
Bytes with_section_byte(const std::string& type, std::size_t at, unsigned flip) {
    Bytes file = patched(0, u8{0x89});
    const std::size_t entry = entry_of(file, type);
    const u64 offset = offset_of(file, type), length = load_le<u32>(file.data() + entry + 8);
    file[offset + at] ^= static_cast<std::byte>(flip);
    store_le(file.data() + entry + 4, crc32c(std::span(file).subspan(offset, length)));
    seal_header(file);
    return file;
}

TEST(Hostile, SectionBodies) {
    using enum ContainerRule;
    expect_refused(with_section_byte("meta", 0, 2), metadata, "packing");
    // The start of group 1 is only bounded; reading the index records detects its changes.
    for (const std::size_t at : {7u, 11u})
        expect_refused(with_section_byte("ROOT", at, 0x80), root, "past the end");
    for (const std::size_t at : {0u, 8u})
        EXPECT_TRUE(found_by_reading(with_section_byte("ROOT", at, 1))) << at;
}

// Of three groups, the last starts before the second.
TEST(Hostile, GroupsAscend) {
    Sample sample(std::vector<Bytes>(600, Bytes(3)));
    const Bytes good = sample.write();
    const u64 at = offset_of(good, "ROOT");
    for (const std::size_t field : {0u, 8u})
        for (const std::size_t group : {1u, 2u}) {
            Bytes file = good;
            std::byte* value = file.data() + at + 12 * (group - 1) + field;
            store_le(value, group == 1 && field == 0 ? load_le<u32>(value + 12) + 1 : u32{0});
            store_le(file.data() + entry_of(good, "ROOT") + 4,
                     crc32c(std::span(file).subspan(at, 24)));
            seal_header(file);
            expect_refused(file, ContainerRule::root, "does not ascend");
        }
}

TEST(Hostile, CoarseLevels) {
    Sample sample(std::vector<Bytes>(7 + 4 + 2));
    sample.contents.desc.size = {7, 1, 1, 1};
    sample.contents.coarse_levels = {coarse_level({7, 1, 1, 1}, 1, 0, 2),
                                     coarse_level({7, 1, 1, 1}, 2, 1, 3)};
    const Bytes good = sample.write();
    const auto source = wrap_memory(good);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    EXPECT_EQ(reader->levels()[2].size, (Extent4{2, 1, 1, 1}));
    const u64 at = offset_of(good, "LEVL");
    const auto refused = [&](std::size_t byte, u8 value, const char* word) {
        Bytes file = good;
        store_le(file.data() + at + byte, value);
        store_le(file.data() + entry_of(good, "LEVL") + 4, crc32c(std::span(file).subspan(at, 8)));
        seal_header(file);
        expect_refused(file, ContainerRule::levels, word);
    };
    refused(0, 0, "not coarser");
    refused(4, 0, "not coarser");
    refused(5, 21, "more than 20 times");
    refused(4, 255, "more than 20 times");
    refused(2, 1, "quality layer");
    refused(7, 16, "step shift");
    Bytes file = good;
    store_le(file.data() + 37, u8{4});
    seal_header(file);
    expect_refused(file, ContainerRule::levels, "8 bytes for 4 levels");
    expect_refused(with_name(good, "LEVL", "none"), ContainerRule::section_table, "LEVL");
}

TEST(Hostile, RandomDamageWithRightChecksumsNeverCrashes) {
    Random random(99);
    const char* const types[] = {"meta", "CODE", "prxy", "xtra", "ROOT"};
    for (int round = 0; round < 3000; ++round) {
        Bytes file = with_section_byte(types[random() % 5], random() % 10, random() % 256);
        for (unsigned flips = random() % 3; flips > 0; --flips)
            file[16 + random() % 200] ^= static_cast<std::byte>(1 << random() % 8);
        if (load_le<u8>(file.data() + 36) <= max_sections)
            seal_header(file);
        found_by_reading(file);
        validate_container(*wrap_memory(file));
    }
}

TEST(Hostile, HugeIndexRecordIsNotRead) {
    // An index of 3 GiB for one group of empty tiles.
    const Sample sample(std::vector<Bytes>(3));
    Bytes file = sample.write();
    const u64 index = u64{3} << 30, head = offset_of(file, "INDX");
    store_le(file.data() + 24, head + index);
    store_le(file.data() + 32, static_cast<u32>(index));
    seal_header(file);
    SparseSource source(file, head + index);
    const auto reader = ContainerReader::open(source);
    ASSERT_TRUE(reader) << reader.status().message();
    const Status status = reader->locate(0).status();
    EXPECT_EQ(status.code(), ErrorCode::invalid_file);
    EXPECT_NE(status.message().find("too many"), std::string::npos) << status.message();
    EXPECT_LE(source.largest_, 16384u);
}

} // namespace
} // namespace tessera
