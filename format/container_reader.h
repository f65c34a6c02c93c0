// Opens a .tess file and finds its tiles. Checks everything before it is used.
#pragma once

#include "format/byte_source.h"
#include "format/levels.h"
#include "format/metadata.h"
#include "format/status.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

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
    proxy_mesh = 22,   // section prxy holds a mesh
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

// What the header says of the file itself.
struct FileFacts {
    std::uint16_t version_major = 0, version_minor = 0;
    std::vector<std::string> required_features, optional_features; // by name
    std::string colour;                                            // transform of the texture
    std::uint32_t page_bytes = 0;
    std::array<std::uint16_t, 4> background{}; // samples (half bits for half16), channel order
};

// What the index says about the tiles of all levels.
struct TileSummary {
    std::uint64_t tiles = 0, empty = 0;
    std::uint64_t bytes = 0, largest = 0; // of all tiles, of the largest one
};

struct OpenOptions {
    // Accept bytes that stop between the end of the index and the end of the file.
    bool allow_partial = false;
    // Refuse files whose head, which is held, is longer. No head is by the format.
    std::uint64_t most_head_bytes = std::uint64_t{1} << 28;
};

struct FileHeader; // format/container/syntax.h
struct GroupIndex; // format/container/index.h
class LevelTable;  // format/container/level_table.h
class OpenContainer;

// An open container. All const members are thread-safe; they share small caches (at most about
// 16 MiB of pages and 1024 index records), and a page or record that several threads want at once
// is read once.
class ContainerReader {
public:
    // One read of min(8 KiB, size) bytes, and a second of the rest of the head if it is longer.
    // `source` must outlive the reader. Errors: io; invalid_file (truncated, damaged, fields out of
    // range); unsupported (another version, unknown required feature or section); over_budget (the head).
    static Result<ContainerReader> open(ByteSource& source, const OpenOptions& options = {});
    ContainerReader(ContainerReader&&) noexcept;
    ContainerReader& operator=(ContainerReader&&) noexcept;
    ~ContainerReader();

    const TextureDesc& desc() const; // of level 0
    const Description& description() const;
    const Metadata& metadata() const;
    std::span<const Level> levels() const; // the texture first, then coarser and coarser
    const TileGrid& grid(std::size_t level = 0) const;
    // How views lie apart in the grid of the texture, which then is larger than desc().size.
    ViewAlignment alignment() const;
    // The tiles that a box of the texture touches, ascending; of the grid where views are aligned, too.
    // Precondition: is_inside(texels, desc().size).
    std::vector<std::uint64_t> tiles_touched(const Box4& texels) const;
    std::uint64_t tile_count() const; // of all levels
    std::uint32_t group_count() const;
    FileFacts facts() const;
    std::uint64_t file_bytes() const; // of the whole file, as its header says
    // Whether the source ends before the file does; only with allow_partial.
    bool is_partial() const;
    std::uint64_t source_bytes() const;
    std::span<const SectionInfo> sections() const;
    std::string name() const; // of the source

    // Bytes of section CODE, opaque here.
    std::span<const std::byte> codec_parameters() const;
    // Bytes of the first section of that type before INDX, e.g. "prxy"; empty when there is none.
    std::span<const std::byte> section_bytes(const std::string& type) const;

    // Section prxy of a file whose proxy is a mesh, for decode_mesh() of format/surface_mesh.h; empty
    // when there is none. At most 2^28 bytes.
    std::span<const std::byte> proxy_mesh() const;

    // Reads the whole index. Errors: io, invalid_file.
    Result<TileSummary> summarise_tiles() const;

    // For those who know the format's records (headers of format/container).
    const FileHeader& header() const;
    AlignedViews aligned_views() const;
    const LevelTable& level_table() const;
    // Index of group `group` (tiles 256 * group ..), one read when it is not cached.
    Result<std::shared_ptr<const GroupIndex>> group(std::uint32_t group) const;

    // The tiles of group `group` that are not empty, ascending. Errors: as those of group().
    Result<std::vector<std::uint64_t>> nonempty_tiles(std::uint32_t group) const;

    // Whether all bytes that load_tile needs are there: false only in a partial file. Reads the
    // index record if it is not cached. Errors: as those of locate.
    Result<bool> is_received(std::uint64_t tile) const;

    // Whether the index says that the tile has no bytes, so that all its texels are alike; false where it cannot
    // be read.
    bool is_empty(std::uint64_t tile) const;

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
    bool wants_prefetch() const;

    using Progress = std::function<void(double done, double total)>; // bytes of DATA
    // Checks everything that open() could not: the mesh, all index records and pages. Reads DATA once,
    // holds one page, and a mesh of up to a million triangles (1 GiB; larger ones are not fatal, and
    // reported as not checked). At most 1000 findings are listed. Empty: the container is sound.
    std::vector<Finding> validate(const Progress& progress = {}) const;

private:
    explicit ContainerReader(std::unique_ptr<OpenContainer> container);
    std::unique_ptr<OpenContainer> container_;
};

// validate() for bytes that may not even open: then why they do not is the first finding.
std::vector<Finding> validate_container(ByteSource& source,
                                        const ContainerReader::Progress& progress = {},
                                        const OpenOptions& options = {});

} // namespace tessera
