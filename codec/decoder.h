// Decodes a .tess file to texels. This is the public interface of the decoder.
#pragma once

#include "format/byte_source.h"
#include "format/container_reader.h"
#include "format/texture.h"
#include "format/work.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// How thoroughly the bytes of a tile are checked while texels are read.
enum class Integrity {
    page, // (default) reads the page around each tile and checks its CRC32C
    tile, // reads only the tile's own bytes; the end state of its stream reveals most damage
};

// How the texels of a box are decoded.
struct ReadOptions {
    unsigned threads = 0; // 0: all cores
    Integrity integrity = Integrity::page;
    ProgressFunction progress{}; // called with the number of tiles
    // Called from several threads before each tile. Once it returns true, the call fails with the
    // error "interrupted" (runtime) and the texels are unspecified.
    std::function<bool()> cancelled{};
};

// Which errors are replaced by texels from coarser levels, or by the background if there are none.
struct DecodeOptions {
    bool allow_partial = false; // tiles past the end of a truncated file
    bool allow_damaged = false; // tiles whose page, index record or stream is damaged
    std::uint64_t most_head_bytes = OpenOptions().most_head_bytes;
};

// The tiles of level 0 that have been requested and filled so far, each counted once.
struct FillReport {
    static constexpr std::size_t most_listed = 100;
    std::uint64_t missing_tiles = 0; // past the end of the file
    std::uint64_t damaged_tiles = 0;
    std::uint64_t texels = 0;             // of both kinds of tiles, within the texture
    std::vector<std::uint64_t> damaged{}; // the first most_listed damaged tiles, ascending
};

// An open file. All const members are thread-safe.
class Decoder {
public:
    // Reads header, tables and the root of the index, in at most 2 reads. `source` must outlive the
    // decoder. Errors: as ContainerReader::open() and invalid_file for damaged coding tables.
    static Result<Decoder> open(ByteSource& source, const DecodeOptions& options = {});
    // The same, but the decoder owns `source`. Errors: also bad_argument for a null pointer.
    static Result<Decoder> open(std::unique_ptr<ByteSource> source,
                                const DecodeOptions& options = {});
    // Opens the file at `path`, which stays open as long as the decoder lives.
    static Result<Decoder> open_file(const std::string& path, const DecodeOptions& options = {});
    Decoder(Decoder&&) noexcept;
    ~Decoder();

    const ContainerReader& container() const;
    const TextureDesc& desc() const; // of level 0

    // Decodes the texels of `box`, which must lie inside the texture, into `out`, which must have
    // desc().box_bytes(box) bytes (in the order of texture.h). Reads only the tiles that the box
    // touches. On an error `out` is unspecified. Errors: bad_argument (the box or the buffer does
    // not fit), io, invalid_file, runtime (interrupted).
    Status decode_box(const Box4& box, std::span<std::byte> out,
                      const ReadOptions& options = {}) const;

    // The same for a box of container().grid(). The grid equals the texture unless views are
    // aligned; then it is larger, and texels outside all views have arbitrary values.
    Status decode_grid_box(const Box4& box, std::span<std::byte> out,
                           const ReadOptions& options) const;

    // Writes the texels of `box` to `sink`, slab by slab in bounded memory, in coordinates of the
    // whole texture, and calls sink.finish(). A slab holds at most `slab_bytes` of texels (none if
    // the sink has Locality::any); to stay below that, tiles may be decoded several times. threads:
    // 0 for all cores. Errors: those of the file and the sink, bad_argument; over_budget if even
    // the smallest slab is larger than slab_bytes.
    Status decode(const Box4& box, TexelSink& sink, unsigned threads = 0,
                  const ProgressFunction& progress = {},
                  std::uint64_t slab_bytes = 512u << 20) const;

    // Decodes `box` of coarse level `level` (container().levels()), in that level's coordinates,
    // like decode_box(). Uses one thread and keeps up to 32 MiB of decoded tiles for later boxes.
    // Errors: as decode_box(); bad_argument if `level` is 0 or does not exist.
    Status decode_coarse_box(std::size_t level, const Box4& box, std::span<std::byte> out) const;
    // Decodes a tile, numbered across all levels, and drops its texels. Errors: as decode_box().
    Status check_tile(std::uint64_t tile) const;

    FillReport fill_report() const;

private:
    struct State;
    explicit Decoder(std::unique_ptr<State> state);
    // Decodes a box of the texture whose views lie in the grid as `views` says.
    Status decode_views(const AlignedViews& views, const Box4& box, std::span<std::byte> out,
                        const ReadOptions& options) const;
    std::unique_ptr<State> state_;
};

// The file as a source of texels, to compare or encode it. `decoder` must outlive it.
std::unique_ptr<TexelSource> decoded_source(const Decoder& decoder);

// The same for the grid of tiles, see decode_grid_box().
std::unique_ptr<TexelSource> decoded_grid(const Decoder& decoder);

// One level of the file as a source of texels, of the size in container().levels(). Level 0 is
// decoded_source(), other levels use decode_coarse_box(). Boxes may be read in any order; where
// each request is expensive, the tiles of a box are fetched together. Thread-safe. `decoder` must
// outlive it. Precondition: the level exists.
std::unique_ptr<TexelSource> decoded_level(const Decoder& decoder, std::size_t level);

} // namespace tessera
