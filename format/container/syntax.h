// The fixed numbers and records of FORMAT.md part 1, which the reader and the writer share.
#pragma once

#include "format/levels.h"
#include "format/metadata.h"
#include "format/status.h"
#include "format/texture.h"
#include "format/tile/colour_transform.h"
#include "format/tile/features.h"
#include "format/tile/limits.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

inline constexpr std::array<unsigned char, 12> file_identifier = {
    0x89, 'T', 'E', 'S', 'S', 'E', 'R', 'A', '\r', '\n', 0x1A, '\n'};

// The minor versions that headers state (FORMAT.md 1.1).
inline constexpr std::uint16_t version_minor_plain = 5;
inline constexpr std::uint16_t version_minor_layers = 6;

// Sizes of records, in bytes, and limits.
inline constexpr std::size_t header_bytes = 92;
inline constexpr std::size_t header_crc_offset = 88;
inline constexpr std::size_t section_entry_bytes = 12;
inline constexpr std::size_t geometry_bytes = 24; // section geom
inline constexpr std::size_t level_entry_bytes = 4;
inline constexpr std::size_t root_entry_bytes = 12;
inline constexpr unsigned min_sections = 1, max_sections = 62; // of the section table
inline constexpr std::uint32_t max_head_bytes = 1u << 28;
inline constexpr unsigned max_levels = 64;
inline constexpr std::uint64_t max_tiles = 0xFFFFFFFFu;
inline constexpr std::uint32_t tiles_per_group = 256;
inline constexpr std::uint32_t page_unit = 16;         // bytes; page_target counts these
inline constexpr std::uint32_t max_page_bytes = 65536; // longer tiles are cut into such pages
inline constexpr std::uint32_t max_page_target = 4096; // in page units

// For messages and listings: the name of a required feature, such as "corrections", or "bit 17".
std::string feature_name(unsigned bit);

// The fields of the header. If check_fields() accepts them, they are within the ranges of FORMAT.md
// 1.1.
struct FileHeader {
    std::uint16_t version_major = format_version_major;
    std::uint16_t version_minor = version_minor_plain;
    std::uint64_t required_features = 0; // the file stores the lower 32 bits of both
    std::uint64_t optional_features = 0;
    std::uint64_t file_size = 0;    // bytes
    std::uint32_t index_size = 0;   // bytes of INDX
    std::uint8_t section_count = 0; // of the section table, which lacks INDX and DATA
    std::uint8_t level_count = 1;
    std::uint16_t page_target = 256; // in units of 16 bytes
    TextureDesc desc;                // of level 0
    Extent4 tile_extent{1, 1, 1, 1}; // texels, the largest tile
    ColourTransform colour = ColourTransform::none;
    Description description; // its geometry is not in the header but in section geom
    std::uint8_t reserved = 0;
    ViewAlignment alignment;
    std::array<std::uint16_t, 4> background{}; // a sample per channel, a half as its bits
    std::uint64_t identity = 0;
    std::uint32_t crc = 0;

    std::uint32_t page_bytes() const { return std::uint32_t{page_target} * page_unit; }
    // The largest length of a tile; at most 25.4 MB.
    std::uint64_t max_tile_bytes() const {
        return (1u << 18) + 16 * desc.channels * texel_count(tile_extent);
    }
};

// An error of code invalid_file, to which the caller adds the file's name.
inline Status invalid(const std::string& text) {
    return {ErrorCode::invalid_file, text};
}

// Convert between the fields and the bytes of the header. Neither function checks anything.
FileHeader load_header(std::span<const std::byte, header_bytes> bytes);
std::array<std::byte, header_bytes> store_header(const FileHeader& header);

// Errors: unsupported, which names the first required feature that this version does not know.
Status check_features(const FileHeader& header);
// Errors: invalid_file, which names the first field that is outside its range in FORMAT.md 1.1.
// Does not check the version, the features, file_size, index_size, identity, crc or the geometry.
Status check_fields(const FileHeader& header);

// Section geom (FORMAT.md 1.4): the sphere and the observers of a description.
// Errors: invalid_file, which names the first number that is outside its range.
Status check_geometry(const Description& description);
// The content of the section; empty if all numbers are 0, because then there is no section.
std::vector<std::byte> write_geometry(const Description& description);
// Stores what the section says in `description`, whose proxy decides what is in range. Errors:
// invalid_file, without the file's name.
Status read_geometry(std::span<const std::byte> section, Description& description);

// An entry of the section table.
struct SectionEntry {
    std::array<char, 4> type{};
    std::uint32_t crc = 0;
    std::uint32_t length = 0; // bytes

    std::string name() const { return std::string(type.data(), type.size()); }
    bool required() const { return type[0] >= 'A' && type[0] <= 'Z'; }
};

SectionEntry load_section(std::span<const std::byte, section_entry_bytes> bytes);
std::array<std::byte, section_entry_bytes> store_section(const SectionEntry& entry);
// Whether `type` is four ASCII letters.
bool is_section_type(const std::string& type);
// Whether FORMAT.md defines what the section holds.
bool is_known_section(const std::string& type);
// Whether the section is INDX or DATA, which follow the head and are not in the section table.
bool follows_head(const std::string& type);

// Checks the limits of FORMAT.md 1.3. Errors: bad_argument, which names the key and the limit.
Status check_metadata(const Metadata& metadata);
// Packs metadata into the content of section `meta`. Errors: those of check_metadata().
Result<std::vector<std::byte>> pack_metadata(const Metadata& metadata);
// The inverse. Errors: invalid_file, without the file's name.
Result<Metadata> unpack_metadata(std::span<const std::byte> section);

} // namespace tessera
