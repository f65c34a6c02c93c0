// Opens a .tess file and finds its tiles. Checks everything before it is used.
#pragma once

#include "format/byte_source.h"
#include "format/index.h"
#include "format/level_table.h"
#include "format/metadata.h"
#include "format/status.h"
#include "format/syntax.h"
#include "format/texture.h"
#include "format/tile_grid.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Where a tile's bytes are. length 0: every texel of the tile is the file's background.
struct TileLocation {
    std::uint64_t offset = 0; // bytes, absolute
    std::uint32_t length = 0; // bytes
};

// A tile's bytes, and what keeps them alive. Empty: the tile is all background.
struct TileBytes {
    std::shared_ptr<const std::vector<std::byte>> owner;
    std::span<const std::byte> bytes;
};

// Stable numbers of the container's rules, listed in FORMAT.md part 6.
enum class ContainerRule : int {
    readable = 1, // the operating system delivers the bytes
    length = 2,   // header and section table are there
    identifier = 3,
    version = 4,
    header_crc = 5,
    features = 6,       // no unknown required feature
    header_field = 7,   // every field within its range
    file_size = 8,      // as the header says
    section_table = 10, // types, order, offsets, each needed section once
    section_known = 11, // no unknown required section
    section_crc = 12,
    metadata = 13,
    levels = 14,
    root = 15,
    index_crc = 20,
    index_record = 21, // lengths, pages and size of the record fit the root
    page_crc = 30,
    // Not fatal: the texels decode without these.
    proxy_section = 40,    // a mesh proxy and its section come together
    unknown_value = 41,    // of proxy, surface_map, angular_map, transfer, primaries
    unknown_optional = 42, // features and sections that were skipped
    not_received = 43,     // of a file that was opened as a part, these pages are not there
    more = 99,             // the list of findings was cut
};

// One numbered finding of validate().
struct Finding {
    int number = 0; // stable id of the rule, listed in FORMAT.md
    bool fatal = true;
    std::string text;
    std::uint64_t first_tile = 0, tile_count = 0; // the tiles it makes unusable; 0: not about tiles
};

struct SectionInfo {
    std::string type; // four letters
    std::uint64_t offset = 0, length = 0;
    bool required = false, known = false;
};

struct OpenOptions {
    // Accept bytes that stop between the end of the index and the end of the file.
    bool allow_partial = false;
};

// An open container. All const members are thread-safe; they share small caches (at most about
// 16 MiB of pages and 1024 index records), and a page or record that several threads want at once
// is read once.
class ContainerReader {
public:
    // One read of min(8 KiB, size) bytes, and a second of the rest of the head if it is longer.
    // `source` must outlive the reader. Errors: io; invalid_file (truncated, damaged, fields out of
    // range); unsupported (another version, unknown required feature or section).
    static Result<ContainerReader> open(ByteSource& source, const OpenOptions& options = {});
    ContainerReader(ContainerReader&&) noexcept;
    ContainerReader& operator=(ContainerReader&&) noexcept;
    ~ContainerReader();

    const FileHeader& header() const { return header_; }
    const TextureDesc& desc() const { return header_.desc; }
    const Description& description() const { return header_.description; }
    const Metadata& metadata() const { return metadata_; }
    const LevelTable& level_table() const { return table_; }
    std::span<const Level> levels() const { return table_.levels(); }
    const TileGrid& grid(std::size_t level = 0) const { return levels()[level].grid; }
    std::uint64_t tile_count() const { return table_.tile_count(); } // of all levels
    std::uint32_t group_count() const { return table_.group_count(); }
    // Whether the source ends before the file does; only with allow_partial.
    bool is_partial() const { return source_->size() < header_.file_size; }
    std::uint64_t source_bytes() const { return source_->size(); }
    std::span<const SectionInfo> sections() const { return sections_; }
    std::string name() const { return source_->name(); }

    // Bytes of section CODE, opaque here.
    std::span<const std::byte> codec_parameters() const { return section_bytes("CODE"); }
    // Bytes of the first section of that type before INDX, e.g. "prxy"; empty when there is none.
    std::span<const std::byte> section_bytes(const std::string& type) const;

    // Index of group `group` (tiles 256 * group ..), one read when it is not cached.
    Result<std::shared_ptr<const GroupIndex>> group(std::uint32_t group) const;

    // Whether all bytes that load_tile needs are there: false only in a partial file. Reads the
    // index record if it is not cached. Errors: as those of locate.
    Result<bool> is_received(std::uint64_t tile) const;

    // Errors of the four below: bad_argument (no such tile), io, invalid_file.
    Result<TileLocation> locate(std::uint64_t tile) const;
    // Reads exactly the tile's bytes; no checksum is checked.
    Status read_tile(std::uint64_t tile, std::vector<std::byte>& out) const;
    // Reads the page(s) of the tile whole, checks their CRC32C and hands out the tile's part of
    // them, without a copy unless the tile spans pages. Pages are cached, so tiles that are wanted
    // near each other in time share one read.
    Result<TileBytes> load_tile(std::uint64_t tile) const;
    // The same, copied.
    Status read_tile_checked(std::uint64_t tile, std::vector<std::byte>& out) const;

    // Brings what load_tile() needs for the first of `tiles` into the caches: one read_many() of
    // index records, one of pages. Returns how many tiles from the front that is, at least one unless
    // there is none; the caches hold three such windows (5 MiB of pages, 256 groups each). What another
    // thread is loading already is left to it; what is damaged is left to load_tile(), which then
    // says so. Errors: bad_argument (no such tile), io.
    Result<std::size_t> prefetch(std::span<const std::uint64_t> tiles) const;
    // The same for index records alone, those of `first` and as many groups after it as the caches
    // hold well; for walks over all groups. Returns the first group beyond. Errors: io.
    Result<std::uint32_t> prefetch_groups(std::uint32_t first) const;
    // Whether prefetch() pays, see ByteSource.
    bool wants_prefetch() const { return source_->wants_prefetch(); }

    using Progress = std::function<void(double done, double total)>; // bytes of DATA
    // Checks everything that open() could not: all index records and pages. Reads DATA once, holds
    // one page. At most 1000 findings are listed. Empty: the container is sound.
    std::vector<Finding> validate(const Progress& progress = {}) const;

private:
    // Precondition: groups that exist, each once, at most window_groups * 2.
    Status bring_groups(std::span<const std::uint32_t> groups) const;
    struct Caches;
    friend std::vector<Finding> validate_container(ByteSource&, const Progress&,
                                                   const OpenOptions&);

    ContainerReader();
    // Does the work of open(); `rule` is the rule being checked when an error is returned.
    Status load(ByteSource& source, const OpenOptions& options, ContainerRule& rule);
    Status load_header(const OpenOptions& options, ContainerRule& rule);
    Status load_sections(ContainerRule& rule);
    Status load_levels();
    Status load_root();
    // Precondition: the section exists.
    const SectionInfo& section(const std::string& type) const;
    Status invalid(const std::string& text) const;

    struct RootEntry {
        std::uint64_t data, index; // bytes, absolute
    };
    RootEntry root(std::uint32_t group) const;
    GroupKey group_key(std::uint32_t group) const;
    struct IndexRange {
        std::uint64_t offset, length; // bytes
    };
    IndexRange index_range(std::uint32_t group) const;
    Result<GroupIndex> read_group(std::uint32_t group, ContainerRule& rule) const;
    Result<GroupIndex> parse_group(std::uint32_t group, std::span<const std::byte> bytes,
                                   ContainerRule& rule) const;
    Status no_such_tile(std::uint64_t tile) const;

    // A tile's bytes [begin, end) and the index that says so.
    struct Place {
        std::shared_ptr<const GroupIndex> index;
        std::uint32_t group = 0;
        std::uint64_t begin = 0, end = 0;
    };
    Result<Place> place_of(std::uint64_t tile) const;
    Status check_page(std::uint32_t group, std::size_t number, const Page& page,
                      std::span<const std::byte> bytes) const;
    Result<std::vector<std::byte>> read_page(std::uint32_t group, std::size_t number,
                                             const Page& page) const;
    Status check_pages(const Place& place, const GroupIndex::PageRange& pages,
                       std::span<const std::byte> bytes) const;
    Result<TileBytes> load_large_tile(const Place& place, const GroupIndex::PageRange& pages) const;

    void note_curiosities(std::vector<Finding>& out) const;
    // Adds to `missing` the tiles that have not been received.
    void validate_group(std::uint32_t group, std::vector<Finding>& out,
                        std::uint64_t& missing) const;

    ByteSource* source_ = nullptr;
    FileHeader header_;
    // From the stored bytes of the first reads where they are there, else from the source.
    Status read_bytes(std::uint64_t offset, std::span<std::byte> out) const;
    bool is_at_hand(std::uint64_t offset, std::uint64_t length) const {
        return offset <= head_.size() && length <= head_.size() - offset;
    }
    std::vector<std::byte> head_; // the file up to INDX, or what the first read brought beyond
    std::vector<SectionInfo> sections_;
    Metadata metadata_;
    LevelTable table_;
    std::span<const std::byte> root_; // into head_
    std::unique_ptr<Caches> caches_;
};

// validate() for bytes that may not even open: then why they do not is the first finding.
std::vector<Finding> validate_container(ByteSource& source,
                                        const ContainerReader::Progress& progress = {},
                                        const OpenOptions& options = {});

} // namespace tessera
