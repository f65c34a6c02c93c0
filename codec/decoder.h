// A .tess file -> texels. The public face of the decoder.
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

// How much of the file is checked while texels are read.
enum class Integrity {
    page, // the page that holds each tile is read whole and its CRC32C checked (default)
    tile, // only the tile's own bytes are read; damage is found by the stream's end state, which
          // misses some flips
};

// How texels of a box are had.
struct ReadOptions {
    unsigned threads = 0; // 0: all cores
    Integrity integrity = Integrity::page;
    ProgressFunction progress; // of tiles
    // Asked from several threads, before each tile; once it says true the call ends with the error
    // "interrupted" (runtime) and unspecified texels.
    std::function<bool()> cancelled;
};

// What is shown from coarser levels, or as background where there are none, instead of an error.
struct DecodeOptions {
    bool allow_partial = false; // tiles that lie past the end of a file that was cut off
    bool allow_damaged = false; // tiles whose page, index record or stream is damaged
    std::uint64_t most_head_bytes = OpenOptions().most_head_bytes;
};

// The tiles of level 0 that were asked for and filled so far, each counted once.
struct FillReport {
    static constexpr std::size_t most_listed = 100;
    std::uint64_t missing_tiles = 0; // not received
    std::uint64_t damaged_tiles = 0;
    std::uint64_t texels = 0;             // of both; of the texture
    std::vector<std::uint64_t> damaged{}; // the first of them, ascending
};

// An open file. All const members are thread-safe.
class Decoder {
public:
    // Reads header, tables and index root: at most 2 reads. `source` must outlive the decoder.
    static Result<Decoder> open(ByteSource& source, const DecodeOptions& options = {});
    // The same, and the decoder owns `source`.
    static Result<Decoder> open(std::unique_ptr<ByteSource> source,
                                const DecodeOptions& options = {});
    // The file at `path`, which stays open as long as the decoder lives.
    static Result<Decoder> open_file(const std::string& path, const DecodeOptions& options = {});
    Decoder(Decoder&&) noexcept;
    ~Decoder();

    const ContainerReader& container() const;
    const TextureDesc& desc() const; // of level 0

    // Decodes the texels of `box` into `out` (desc().box_bytes(box) bytes, order as in texture.h),
    // reading only the tiles that the box touches. threads 0: all cores. Errors: bad_argument (a box
    // or a buffer that does not fit); io and invalid_file, those of the file.
    Status decode_box(const Box4& box, std::span<std::byte> out, unsigned threads = 0,
                      Integrity integrity = Integrity::page) const;
    Status decode_box(const Box4& box, std::span<std::byte> out, const ReadOptions& options) const;

    // The same for a box of container().grid(), which is larger than the texture where views are aligned: what
    // lies in no view is whatever cost least.
    Status decode_grid_box(const Box4& box, std::span<std::byte> out,
                           const ReadOptions& options) const;

    // Streams `box` into `sink` slab by slab in bounded memory, in coordinates of the whole
    // texture; calls sink.finish(). A slab holds at most `slab_bytes` of texels (sinks of
    // Locality::any hold none); to keep within it, tiles may be decoded more than once. Errors: those
    // of the file and the sink; over_budget where the smallest slab is larger.
    Status decode(const Box4& box, TexelSink& sink, unsigned threads = 0,
                  const ProgressFunction& progress = {},
                  std::uint64_t slab_bytes = 512u << 20) const;

    // The same for `box` of a coarse level, in that level's coordinates (container().levels()). One
    // thread decodes; the last decoded tiles, up to 32 MiB, are kept for the next boxes. Tiles that
    // cannot be had come from coarser levels where the DecodeOptions allow it. Errors: also
    // bad_argument for level 0 and for one that is not there.
    Status decode_coarse_box(std::size_t level, const Box4& box, std::span<std::byte> out) const;
    // Loads and decodes a tile, numbered over all levels, and forgets it. Errors: as decode_box.
    Status check_tile(std::uint64_t tile) const;

    FillReport fill_report() const;

private:
    struct State;
    explicit Decoder(std::unique_ptr<State> state);
    // A box of views that lie so in the grid.
    Status decode_views(const AlignedViews& views, const Box4& box, std::span<std::byte> out,
                        const ReadOptions& options) const;
    std::unique_ptr<State> state_;
};

// A file as a source of texels, so that files can be compared and transcoded like any other input.
// `decoder` must outlive it.
std::unique_ptr<TexelSource> decoded_source(const Decoder& decoder);

// The same, of the grid of tiles: decode_grid_box().
std::unique_ptr<TexelSource> decoded_grid(const Decoder& decoder);

// One level of the file as a source of texels, of the size that container().levels() gives, in boxes
// of any order: decode_coarse_box(); level 0: decoded_source(). Where requests are dear, what a box
// needs comes by few of them. Thread-safe. `decoder` must outlive it. Precondition: there is such a
// level.
std::unique_ptr<TexelSource> decoded_level(const Decoder& decoder, std::size_t level);

} // namespace tessera
