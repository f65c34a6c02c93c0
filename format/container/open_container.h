// The implementation of ContainerReader. It is spread over four files:
//   container_open.cpp      reads and checks the header, the sections, the levels and the root
//   container_tiles.cpp     reads and checks index records, pages and tiles
//   container_prefetch.cpp  loads many index records and pages with two requests
//   container_validate.cpp  checks everything in the file
#pragma once

#include "format/container/index.h"
#include "format/container/level_table.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "format/io/claim_cache.h"
#include "format/levels.h"

namespace tessera {

constexpr std::uint64_t cached_groups = 1024;
constexpr std::uint64_t cached_page_bytes = std::uint64_t{16} << 20;

// What an open container keeps in memory besides its head.
struct ContainerCaches {
    using Bytes = std::vector<std::byte>;
    ClaimCache<GroupIndex> groups{cached_groups,
                                  [](const GroupIndex&) { return std::uint64_t{1}; }};
    // By the offset of the first byte. A tile of several pages is one entry.
    ClaimCache<Bytes> pages{cached_page_bytes,
                            [](const Bytes& bytes) { return std::uint64_t{bytes.size()}; }};
};

class OpenContainer {
public:
    // Does the work of ContainerReader::open(). After an error, `rule` is the rule that was being
    // checked.
    Status load(ByteSource& source, const OpenOptions& options, ContainerRule& rule);

    const FileHeader& header() const { return header_; }
    const Metadata& metadata() const { return metadata_; }
    AlignedViews aligned_views() const { return {header_.desc.size, header_.alignment}; }
    const LevelTable& level_table() const { return table_; }
    const Layers& layers() const { return layers_; }
    std::uint64_t tile_count() const { return table_.tile_count(); }
    std::uint32_t group_count() const { return table_.group_count(); }
    const ByteSource& source() const { return *source_; }
    std::span<const SectionInfo> sections() const { return sections_; }
    std::string name() const { return source_->name(); }

    // These members are documented in ContainerReader.
    std::span<const std::byte> section_bytes(const std::string& type) const;
    Result<std::shared_ptr<const GroupIndex>> group(std::uint32_t group) const;
    Result<TileSummary> summarise_tiles() const;
    Result<std::vector<std::uint64_t>> nonempty_tiles(std::uint32_t group) const;
    Result<bool> is_received(std::uint64_t tile) const;
    Result<TileLocation> locate(std::uint64_t tile) const;
    Status read_tile(std::uint64_t tile, std::vector<std::byte>& out) const;
    Result<TileBytes> load_tile(std::uint64_t tile) const;
    Result<std::size_t> prefetch(std::span<const std::uint64_t> tiles) const;
    Result<std::uint32_t> prefetch_groups(std::uint32_t first) const;
    std::vector<Finding> validate(const ContainerReader::Progress& progress) const;

private:
    // Loads the index records of groups that are not cached, with one request. Preconditions: the
    // groups exist and are distinct, and the cache can hold them all.
    Status load_groups(std::span<const std::uint32_t> groups) const;
    Status load_header(const OpenOptions& options, ContainerRule& rule);
    Status load_sections(const OpenOptions& options, ContainerRule& rule);
    void list_sections(std::span<const SectionEntry> entries);
    Status load_head(const OpenOptions& options);
    Status load_layers();
    Status load_geometry();
    Status load_levels();
    Status load_root();
    bool has_section(const std::string& type) const;
    // Precondition: the section exists.
    const SectionInfo& section(const std::string& type) const;
    Status invalid(const std::string& text) const;

    struct RootEntry {
        std::uint64_t data, index; // bytes
    };
    // What section ROOT says about a group above 0, counted from the starts of DATA and INDX.
    RootEntry root_entry(std::uint32_t group) const;
    // Where the bytes and the record of a group start, counted from the start of the file. The group
    // after the last one starts where DATA and INDX end.
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

    // Where a tile's bytes are: [begin, end) of the file, according to the index record of its
    // group.
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

    // Checks what open() does not check in the head: the mesh, unknown values and unknown sections.
    void validate_head(std::vector<Finding>& out) const;
    // Adds the number of tiles that have not been received to `missing`.
    void validate_group(std::uint32_t group, std::vector<Finding>& out,
                        std::uint64_t& missing) const;

    ByteSource* source_ = nullptr;
    FileHeader header_;
    // Copies the bytes from head_ if it has them, or else reads them from the source.
    Status read_bytes(std::uint64_t offset, std::span<std::byte> out) const;
    bool is_in_head(std::uint64_t offset, std::uint64_t length) const {
        return offset <= head_.size() && length <= head_.size() - offset;
    }
    std::vector<std::byte> head_; // the file up to INDX, or more if the first read brought more
    std::vector<SectionInfo> sections_; // the last two are INDX and DATA
    Metadata metadata_;
    LevelTable table_;
    Layers layers_;
    std::span<const std::byte> root_; // into head_
    std::unique_ptr<ContainerCaches> caches_;
};

// For messages: " at offset 17".
std::string at_offset(std::uint64_t offset);

} // namespace tessera
