// Tests how opening refuses files that no writer produces, although all checksums are correct.
#include "format/container/container_writer.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "format/io/bytes.h"
#include "format/io/crc32c.h"
#include "tests/support/container_samples.h"
#include "tests/support/forged_alignment.h"

#include <algorithm>
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

TEST(Hostile, IdentifierAndVersion) {
    using enum ContainerRule;
    expect_refused(patched(0, u8{0x88}), identifier, "not a Tessera file");
    expect_refused(patched(8, u8{'\n'}), identifier, "transfer in text mode");
    expect_refused(patched(12, u16{1}), version, "version 1.3", ErrorCode::unsupported);
    expect_refused(patched(14, u16{4}), version, "version 0.4", ErrorCode::unsupported);
    expect_refused(patched(14, u16{2}), version, "version 0.2", ErrorCode::unsupported);
    Bytes file = patched(14, u16{3});
    file[124] ^= std::byte{1};
    expect_refused(file, header_crc, "checksum of the header");
    expect_refused(Bytes(127), length, "too few");
}

TEST(Hostile, Features) {
    for (const unsigned bit : {2u, 3u, 7u, 63u})
        expect_refused(patched(16, u64{1} << bit), ContainerRule::features, feature_name(bit),
                       ErrorCode::unsupported);
    EXPECT_TRUE(open_status(patched(16, u64{2})));
    expect_refused(patched(16, u64{1}), ContainerRule::header_field, "level_count");
    const auto findings = validate_container(*wrap_memory(patched(24, u64{1} << 40)));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::unknown_optional));
    EXPECT_FALSE(any_fatal(findings));
}

TEST(Hostile, FieldsOutOfRange) {
    const auto field = [](const Bytes& file, const char* word) {
        expect_refused(file, ContainerRule::header_field, word);
    };
    field(patched(40, (1u << 28) + 1), "head_size");
    field(patched(44, u16{4}), "section_count");
    field(patched(46, u16{4097}), "page_target");
    for (std::size_t axis = 0; axis < 4; ++axis) {
        field(patched(48 + 4 * axis, u32{0}), "size");
        field(patched(48 + 4 * axis, (1u << 20) + 1), "size");
        field(patched(48 + 4 * axis, 0xFFFFFFFFu), "size");
        field(patched(64 + axis, u8{0}), "tile_extent");
        field(patched(64 + axis, axis < 2 ? u8{65} : u8{33}), "tile_extent");
    }
    field(patched(64, u32{0x20202020}), "tile_extent (product)");
    field(patched(68, u8{2}), "sample_type");
    field(patched(69, u8{0}), "channels");
    field(patched(69, u8{5}), "channels");
    field(patched(70, u8{2}), "colour");
    field(patched(69, u16{0x0102}), "colour"); // two channels
    field(patched(71, u8{3}), "alpha");
    field(patched(71, u8{1}), "alpha"); // three channels
    field(patched(77, u8{0}), "level_count");
    field(patched(77, u8{2}), "level_count");
    field(patched(78, u8{1}), "align_u"); // the feature bit is missing
    field(patched(79, u8{255}), "align_v");
    field(patched(16, u64{1} << 6), "align_u"); // the alignment is 0
    field(patched(120, u32{1}), "reserved");
}

// Header fields that contradict aligned views, and tile grids beyond the limits of a texture.
TEST(Hostile, AlignmentsThatDoNotFit) {
    const auto aligned = [](const Extent4& size, u32 alignment, u64 features = u64{1} << 6) {
        Bytes file = patched(16, features);
        for (std::size_t axis = 0; axis < 4; ++axis)
            store_le(file.data() + 48 + 4 * axis, size[axis]);
        store_le(file.data() + 72, u8{0}); // no proxy
        store_le(file.data() + 78, static_cast<u16>(alignment));
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
    // The grid is allowed but differs from the one in section LEVL.
    for (const u32 alignment : {0x0001u, 0x7FFFu, 0x8080u, 0x0100u})
        expect_refused(aligned({258, 2, 2, 2}, alignment), ContainerRule::levels, "LEVL");
    Bytes file = aligned({258, 1, 1, 1}, 0x0101);
    EXPECT_TRUE(open_status(file))
        << open_status(file).message(); // with one view the grid is the texture
    for (const u8 proxy : {1, 2, 3, 200}) {
        store_le(file.data() + 72, proxy);
        store_le(file.data() + 92,
                 std::bit_cast<u32>(proxy % 2 == 1 ? 1.0f : 0.0f)); // a sphere's radius
        seal_header(file);
        field(file, "neither coarse levels nor a proxy");
    }
    file = aligned({258, 1, 1, 1}, 0x0101, (u64{1} << 6) + 1);
    store_le(file.data() + 77, u8{2});
    seal_header(file);
    field(file, "neither coarse levels nor a proxy");
}

TEST(Hostile, GeometryOutOfRange) {
    const auto field = [](const Bytes& file, const char* word) {
        expect_refused(file, ContainerRule::header_field, word);
    };
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::nanf("");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        field(patched(80 + 4 * axis, infinity), "sphere_centre");
        field(patched(80 + 4 * axis, nan), "sphere_centre");
    }
    field(patched(92, 1.0f), "sphere_radius"); // the proxy is a mesh
    field(patched(92, nan), "sphere_radius");
    field(patched(72, u8{1}), "sphere_radius"); // a sphere of radius 0
    field(patched(96, 1.0f), "viewing_radius"); // larger than the far radius
    field(patched(96, -1.0f), "viewing_radius");
    field(patched(100, infinity), "viewing_radius");
    field(patched(100, nan), "viewing_radius");
    field(patched(104, u16{256}), "background[0]");
    field(patched(110, u16{1}), "background[3]"); // three channels
    Bytes half = patched(68, u8{1});
    store_le(half.data() + 106, u16{0x7C00});
    seal_header(half);
    field(half, "background[1]");
}

TEST(Hostile, UnknownValuesAreAcceptedWithANote) {
    for (std::size_t offset = 72; offset <= 76; ++offset) {
        const auto findings = validate_container(*wrap_memory(patched(offset, u8{200})));
        EXPECT_FALSE(any_fatal(findings)) << offset;
        EXPECT_EQ(std::ranges::count(findings, static_cast<int>(ContainerRule::unknown_value),
                                     &Finding::number),
                  1)
            << offset;
    }
    const auto findings = validate_container(*wrap_memory(patched(72, u8{0})));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::proxy_section));
}

TEST(Hostile, SizesThatOverflow) {
    // 2^80 texels; 2^48 texels in 2^48 tiles; 2^48 texels in tiles that need more groups than ROOT.
    Bytes file = patched(48, u32{1} << 20);
    for (const std::size_t offset : {52u, 56u, 60u})
        store_le(file.data() + offset, u32{1} << 20);
    seal_header(file);
    expect_refused(file, ContainerRule::header_field, "2^48");
    store_le(file.data() + 52, u32{1} << 14);
    store_le(file.data() + 56, u32{1} << 14);
    store_le(file.data() + 60, u32{1});
    seal_header(file);
    expect_refused(file, ContainerRule::levels, "LEVL");

    const auto copy_size_to_level = [&file] {
        const std::size_t entry = 128 + 2 * 24; // meta, CODE, LEVL
        const auto level = load_le<u64>(file.data() + entry + 8);
        std::copy_n(file.begin() + 48, 16, file.begin() + std::ptrdiff_t(level));
        store_le(file.data() + entry + 4, crc32c(std::span(file).subspan(level, 24)));
        seal_header(file);
    };
    copy_size_to_level();
    expect_refused(file, ContainerRule::levels, "more than 2^32 - 1");
    store_le(file.data() + 56, u32{1} << 12);
    store_le(file.data() + 64, u32{0x01202020}); // 2^31 tiles
    copy_size_to_level();
    expect_refused(file, ContainerRule::root, "ROOT");
}

// Offset of an entry in the section table. The sections of rich_sample are meta 0, CODE 1, LEVL 2,
// prxy 3, xtra 4, ROOT 5, INDX 6, DATA 7.
constexpr std::size_t entry_at(std::size_t section) {
    return 128 + 24 * section;
}

Bytes renamed(std::size_t section, const char* type) {
    u32 raw = 0;
    for (std::size_t i = 0; i < 4; ++i)
        raw |= u32{static_cast<unsigned char>(type[i])} << (8 * i);
    return patched(entry_at(section), raw);
}

TEST(Hostile, SectionTable) {
    using enum ContainerRule;
    expect_refused(renamed(4, "Xtra"), section_known, "\"Xtra\"", ErrorCode::unsupported);
    EXPECT_TRUE(open_status(renamed(4, "abcd"))) << "an unknown optional section was not skipped";
    expect_refused(renamed(4, "ab1d"), section_table, "four letters");
    expect_refused(renamed(4, "meta"), section_table, "twice");
    expect_refused(renamed(4, "CODE"), section_table, "twice");
    for (const std::size_t needed : {1u, 2u, 5u, 6u, 7u})
        expect_refused(renamed(needed, "none"), section_table, "missing");
    for (std::size_t section = 0; section < 8; ++section) {
        const u64 offset = load_le<u64>(patched(0, u8{0x89}).data() + entry_at(section) + 8);
        const u64 length = load_le<u64>(patched(0, u8{0x89}).data() + entry_at(section) + 16);
        for (const u64 wrong : {offset + 1, offset - 1, u64{0}, ~u64{0}, u64{1} << 63})
            expect_refused(patched(entry_at(section) + 8, wrong), section_table, "section");
        for (const u64 wrong : {length + 1, length - 1, ~u64{0}, ~u64{0} - offset, u64{1} << 63})
            expect_refused(patched(entry_at(section) + 16, wrong), section_table, "section");
        const u64 file_bytes = patched(0, u8{0x89}).size();
        expect_refused(patched(entry_at(section) + 16, file_bytes - offset + 1), section_table,
                       "past the end");
        const u32 crc = load_le<u32>(patched(0, u8{0x89}).data() + entry_at(section) + 4);
        expect_refused(patched(entry_at(section) + 4, crc + 1),
                       section < 6 ? section_crc : section_table, "checksum");
    }
    expect_refused(patched(44, u16{65}), length, "65 entries");
    expect_refused(patched(40, u32{200}), section_table, "head_size");
    expect_refused(patched(32, u64{1} << 62), file_size, "cut off");
}

// Changes a byte of a section and corrects all checksums above it.
Bytes with_section_byte(std::size_t section, std::size_t at, unsigned flip) {
    Bytes file = patched(0, u8{0x89});
    const auto offset = load_le<u64>(file.data() + entry_at(section) + 8);
    const auto length = load_le<u64>(file.data() + entry_at(section) + 16);
    file[offset + at] ^= static_cast<std::byte>(flip);
    store_le(file.data() + entry_at(section) + 4, crc32c(std::span(file).subspan(offset, length)));
    seal_header(file);
    return file;
}

TEST(Hostile, SectionBodies) {
    using enum ContainerRule;
    expect_refused(with_section_byte(0, 0, 2), metadata, "packing");
    for (std::size_t at = 0; at < 24; ++at)
        expect_refused(with_section_byte(2, at, 1), levels, "LEVL");
    // The positions of groups 0 and 1 and both ends are checked. The middle is only bounded;
    // reading the index records detects its changes.
    for (const std::size_t at : {0u, 7u, 8u, 11u, 24u, 31u, 32u, 35u})
        expect_refused(with_section_byte(5, at, 1), root, "ROOT");
    for (const std::size_t at : {12u + 7, 12u + 11})
        expect_refused(with_section_byte(5, at, 0x80), root, "ascend");
    for (const std::size_t at : {12u, 12u + 8})
        EXPECT_TRUE(found_by_reading(with_section_byte(5, at, 1))) << at;
}

TEST(Hostile, RandomDamageWithRightChecksumsNeverCrashes) {
    Random random(99);
    for (int round = 0; round < 3000; ++round) {
        Bytes file = with_section_byte(random() % 6, random() % 10, random() % 256);
        for (unsigned flips = random() % 3; flips > 0; --flips)
            file[16 + random() % 300] ^= static_cast<std::byte>(1 << random() % 8);
        if (load_le<u16>(file.data() + 44) <= max_sections)
            seal_header(file);
        found_by_reading(file);
        validate_container(*wrap_memory(file));
    }
}

TEST(Hostile, HugeIndexRecordIsNotRead) {
    // An index of 3 GiB for one group of empty tiles.
    const Sample sample(std::vector<Bytes>(3));
    Bytes file = sample.write();
    const u64 index = u64{3} << 30, head = load_le<u32>(file.data() + 40);
    store_le(file.data() + 32, head + index);
    store_le(file.data() + entry_at(3) + 16, index); // sections are CODE LEVL ROOT INDX DATA
    store_le(file.data() + entry_at(4) + 8, head + index);
    const u64 root = load_le<u64>(file.data() + entry_at(2) + 8);
    store_le(file.data() + root, head + index);
    store_le(file.data() + root + 12, head + index);
    store_le(file.data() + root + 20, static_cast<u32>(index));
    store_le(file.data() + entry_at(2) + 4, crc32c(std::span(file).subspan(root, 24)));
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
