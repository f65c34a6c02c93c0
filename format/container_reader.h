// Opens a .tess file and finds its tiles. Everything is checked before it is used.
#pragma once

#include "format/byte_source.h"
#include "format/layers.h"
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

// Where a tile's bytes are. Length 0 means that every texel of the tile is the file's background.
struct TileLocation {
    std::uint64_t offset = 0; // bytes from the start of the file
    std::uint32_t length = 0; // bytes
};

// A tile's bytes and the owner that keeps them alive. No bytes: every texel is background.
struct TileBytes {
    std::shared_ptr<const std::vector<std::byte>> owner;
    std::span<const std::byte> bytes;
};

// The container's rules. Their numbers are those of FORMAT.md part 6 and never change.
enum class ContainerRule : int {
    readable = 1, // the operating system delivers the bytes
    length = 2,   // header and section table are complete
    identifier = 3,
    version = 4,
    header_crc = 5,
    features = 6,       // no required feature is unknown
    header_field = 7,   // every field is within its range
    file_size = 8,      // the header has the file's true length
    section_table = 10, // types and lengths; each needed section once
    section_known = 11, // no required section is unknown
    section_crc = 12,
    metadata = 13,
    levels = 14,
    root = 15,
    geometry = 16, // section geom
    layers = 17,   // section LAYR, and what the layers hold
    index_crc = 20,
    index_record = 21, // lengths, pages and size of the record agree with section ROOT
    proxy_mesh = 22,   // section prxy holds a mesh
    page_crc = 30,
    // Findings by the rules 40 to 43 are not fatal: the texels decode nevertheless.
    proxy_section = 40,    // a mesh proxy and section prxy come together
    unknown_value = 41,    // of proxy, surface_map, angular_map, transfer, primaries
    unknown_optional = 42, // features and sections that were skipped
    not_received = 43,     // pages that are missing from a partial file
    more = 99,             // there are more findings than are listed
};

// One finding of validate().
struct Finding {
    int number = 0; // a ContainerRule, or another number of FORMAT.md part 6
    bool fatal = true;
    std::string text;
    // The tiles that cannot be decoded because of it; a count of 0 if it is not about tiles.
    std::uint64_t first_tile = 0, tile_count = 0;
};

struct SectionInfo {
    std::string type;                     // four letters
    std::uint64_t offset = 0, length = 0; // bytes, the offset from the start of the file
    bool required = false, known = false;
};

// What the header says about the file itself.
struct FileFacts {
    std::uint16_t version_major = 0, version_minor = 0;
    std::vector<std::string> required_features, optional_features; // by name
    std::string colour;                                            // the colour transform
    std::uint32_t page_bytes = 0;                                  // target size of a page
    std::array<std::uint16_t, 4> background{}; // a sample per channel, a half as its bits
};

// What the index says about the tiles of all levels.
struct TileSummary {
    std::uint64_t tiles = 0, empty = 0;   // number of tiles; of those without bytes
    std::uint64_t bytes = 0, largest = 0; // of all tiles together; of the largest tile
};

struct OpenOptions {
    // Accept a file whose end is missing, as long as the index is complete.
    bool allow_partial = false;
    // Refuse a file whose head, which is kept in memory, has more bytes. The format's own limit is
    // the default.
    std::uint64_t most_head_bytes = std::uint64_t{1} << 28;
};

struct FileHeader; // format/container/syntax.h
struct GroupIndex; // format/container/index.h
class LevelTable;  // format/container/level_table.h
class OpenContainer;

// An open container. All const members are thread-safe. They share caches of about 16 MiB of pages
// and 1024 index records. A page or record that several threads want at the same time is read once.
class ContainerReader {
public:
    // Reads min(8 KiB, size) bytes, and then the rest of the head if it is longer. `source` must
    // outlive the reader. Errors: io; invalid_file (truncated, damaged, a field out of range);
    // unsupported (another version, an unknown required feature or section); over_budget (the head
    // is too long).
    static Result<ContainerReader> open(ByteSource& source, const OpenOptions& options = {});
    ContainerReader(ContainerReader&&) noexcept;
    ContainerReader& operator=(ContainerReader&&) noexcept;
    ~ContainerReader();

    const TextureDesc& desc() const; // of level 0
    const Description& description() const;
    const Metadata& metadata() const;
    std::span<const Level> levels() const; // the texture first, then ever coarser levels
    // How a level is cut into tiles. Precondition: level < levels().size().
    const TileGrid& grid(std::size_t level = 0) const;
    // By how much views are shifted in the grid of level 0. If there is a shift, the grid is larger
    // than desc().size.
    ViewAlignment alignment() const;
    // The numbers of the tiles of level 0 that hold texels of a box of the texture, ascending. The
    // shift of views is taken into account. Precondition: is_inside(texels, desc().size).
    std::vector<std::uint64_t> tiles_touched(const Box4& texels) const;
    std::uint64_t tile_count() const; // of all levels
    std::uint32_t group_count() const;
    FileFacts facts() const;
    std::uint64_t file_bytes() const; // of the whole file, as its header says
    // Whether the source ends before the file does, which only allow_partial accepts.
    bool is_partial() const;
    std::uint64_t source_bytes() const;
    // In the order of the file. The last two are INDX and DATA, which are not in the section table.
    std::span<const SectionInfo> sections() const;
    std::string name() const; // of the source

    // The bytes of section CODE, which only the codec interprets.
    std::span<const std::byte> codec_parameters() const;
    // The bytes of the section of that type, e.g. "prxy", which must lie before INDX; empty if
    // there is none.
    std::span<const std::byte> section_bytes(const std::string& type) const;

    // Section prxy of a file whose proxy is a mesh, for decode_mesh() of format/surface_mesh.h;
    // empty for any other file. At most 2^28 bytes.
    std::span<const std::byte> proxy_mesh() const;

    // The layers of the file besides this texture, which is the first layer. None in most files.
    const Layers& layers() const;

    // Reads the whole index. Errors: io, invalid_file.
    Result<TileSummary> summarise_tiles() const;

    // These four are for code that knows the format's records (headers of format/container).
    const FileHeader& header() const;
    AlignedViews aligned_views() const;
    const LevelTable& level_table() const;
    // The index record of a group of up to 256 consecutive tiles (FORMAT.md 1.5); one read unless
    // it is cached. Errors: bad_argument (no such group), io, invalid_file.
    Result<std::shared_ptr<const GroupIndex>> group(std::uint32_t group) const;

    // The tiles of a group that have bytes, ascending. Errors: those of group().
    Result<std::vector<std::uint64_t>> nonempty_tiles(std::uint32_t group) const;

    // Whether all bytes that load_tile() needs are there; false only in a partial file. Reads the
    // index record unless it is cached. Errors: those of locate().
    Result<bool> is_received(std::uint64_t tile) const;

    // Whether the index says that the tile has no bytes, so that all its texels are background.
    // False if the index cannot be read.
    bool is_empty(std::uint64_t tile) const;

    // Errors of the next four members: bad_argument (no such tile), io, invalid_file.
    Result<TileLocation> locate(std::uint64_t tile) const;
    // Reads exactly the tile's bytes and verifies no checksum.
    Status read_tile(std::uint64_t tile, std::vector<std::byte>& out) const;
    // Reads all pages that the tile has bytes in, verifies their CRC32C and returns the tile's
    // bytes without copying them. Pages are cached, so that tiles of one page share its read.
    Result<TileBytes> load_tile(std::uint64_t tile) const;
    // The same, copied to `out`.
    Status read_tile_checked(std::uint64_t tile, std::vector<std::byte>& out) const;

    // Brings what load_tile() needs for the first of `tiles` into the caches, with one read_many()
    // for index records and one for pages. Returns for how many of them: at least one unless
    // `tiles` is empty. The caches hold three such windows of at most 5 MiB of pages and 256
    // groups. Data that another thread is loading is left to that thread, and damaged data to
    // load_tile(), which reports it. Errors: bad_argument (no such tile), io.
    Result<std::size_t> prefetch(std::span<const std::uint64_t> tiles) const;
    // Brings the index records of `first` and of up to 511 groups after it into the caches, for
    // walks over all groups. Returns the first group that it left out. It does nothing and returns
    // group_count() if the source does not want it. Errors: io.
    Result<std::uint32_t> prefetch_groups(std::uint32_t first) const;
    // Whether the source wants prefetch(), see ByteSource.
    bool wants_prefetch() const;

    using Progress = std::function<void(double done, double total)>; // bytes of DATA
    // Checks everything that open() did not: the mesh, all index records and all pages. Reads DATA
    // once and holds one page at a time. The mesh may take 1 GiB, which is enough for a million
    // triangles; a larger one is reported as not checked, which is not fatal. Lists at most 1000
    // findings; none mean that the container is sound.
    std::vector<Finding> validate(const Progress& progress = {}) const;

private:
    explicit ContainerReader(std::unique_ptr<OpenContainer> container);
    std::unique_ptr<OpenContainer> container_;
};

// Like validate(), for bytes that may not even open. The only finding then says why they do not.
std::vector<Finding> validate_container(ByteSource& source,
                                        const ContainerReader::Progress& progress = {},
                                        const OpenOptions& options = {});

} // namespace tessera
