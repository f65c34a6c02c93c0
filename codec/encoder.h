// Texels -> a .tess file. The public face of the encoder.
#pragma once

#include "format/metadata.h"
#include "format/status.h"
#include "format/texture.h"
#include "format/work.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace TESSERA_PUBLIC tessera {

class Decoder; // codec/decoder.h

// How many bits, or how much error. Exactly one kind is chosen.
struct RateTarget {
    enum class Kind {
        quality, // value 1..100; 100 is the finest quantiser step (0.75), 8 lower doubles it
        psnr, // value in dB over all samples; reached from above, within 0.05 dB if a first pass does (baked:
        // 0.15), twice that if a second does; small textures jump by more
        bpt,   // value in bits per texel, all channels; never exceeded, mostly met within 2 to 4 %
        bytes, // value in bytes of the whole file; likewise
        max_error, // no sample off by more than value: 8-bit steps, or for half float its ulps;
                   // 0 is lossless
    };
    Kind kind = Kind::quality;
    double value = 75;
};

// Whether encode_file keeps finished tiles in a folder "<path>.journal" until the file is there.
enum class JournalUse {
    none,   // payloads stay in memory
    start,  // payloads go to the journal; what a dead process left in it is dropped
    resume, // the same, but goes on with what was left, if anything; the file comes out the same
};

// What a trial on parts of the texture finds cheapest among few shapes that cut its views evenly: all of
// them (up to 32x32) of a small place, halves, quarters ... of larger ones. Of 32x32 views 8x8x32x32,
// 16x16x16x16, 32x32x8x8 or 64x64x4x4, of 9x9 32x24x9x9, 64x37x5x5 or 64x64x3x3. With `layers` 32x32x8x8 or
// 32x32x4x4; on a mesh 32x32x8x8 or 64x64x4x4. Under a maximum error, and in textures of at most 32 texels
// along u or v, without a trial.
constexpr Extent4 tile_by_trial{0, 0, 0, 0};

// What each effort does and costs: codec/DECISIONS.md.
constexpr int usual_effort = 3, most_effort = 4;

struct EncodeOptions {
    RateTarget rate;
    int effort = usual_effort; // 0 fastest .. most_effort smallest
    // Coding tools to switch on (+) or off (-) on top of the effort, for experiments: "-copies,+refine";
    // "none" and "all" stand for every tool, later words win. Their names: coding_tools_help().
    std::string tools;
    unsigned threads = 0; // 0: all cores. Never changes the bytes.
    // Most texels of `source` that a slab holds at a time (pictures; sources of Locality::any hold none). Does not
    // change the bytes, but that the views of pictures larger than half of it, of which all would have to be
    // held, are not aligned.
    std::uint64_t slab_bytes = 512u << 20;
    bool verify = true;                  // decode every tile again and compare before it is written
    bool strict = false;                 // refuse NaN and infinities instead of replacing them
    Extent4 tile_extent = tile_by_trial; // largest tile: 1..64 along u and v, 1..32 along s and t
    // A file of which the texels were decoded and, perhaps, edited; of their size, sample type and channels,
    // opened whole; outlives the call. Tiles whose texels are still what it decodes to (those that matter)
    // keep its bytes, so nothing is lost there however often that is done. The others are encoded at `effort`
    // with the file's quantiser, tables, filter, colour and shape of tiles: `rate` and `tile_extent` are not
    // looked at, and no `tools` may be named. nullptr: all tiles are encoded.
    const Decoder* reuse = nullptr;
    // Which texels matter: one channel of unorm8, 0 where any value will do, sides that are the
    // texture's or 1 (the same all along it), Locality::any; outlives the call. nullptr: all matter.
    // Those that do not get what costs least, the source's values being one candidate: no target binds
    // them, no figure but bits_per_texel counts them, and NaN is no fault there.
    TexelSource* mask = nullptr;
    // A PSNR that no quantiser reaches is met by a lossless file; without this only where it is smaller than
    // the finest quantiser's, and only of sources that are cheap to read again.
    bool lossless_fallback = false;
    bool layers = false; // coarse levels first, so that any beginning of the file shows the texture
    Metadata metadata;   // key/values; "Software" is filled in when absent, and keys
                         // with "tessera:" in front are the encoder's: how it encoded
    Description description; // proxy, maps, transfer, primaries
    // With Proxy::mesh, and only then: the bytes of encode_mesh() (format/surface_mesh.h), stored as
    // they are.
    std::vector<std::byte> mesh;
    ProgressFunction progress;
    // Asked from several threads, now and then; once it says true the encoder stops with "interrupted".
    std::function<bool()> cancelled;
    // Asked once the texels have been read for the last time and nothing has been written: an error, such as
    // that they changed meanwhile, ends the encode with it, and its journal is of no more use.
    std::function<Status()> confirm;
    JournalUse journal = JournalUse::none; // of encode_file
    // What messages begin with: about the texels, such as the name of their file, and about a rate that
    // cannot be met, such as an option; "": nothing.
    std::string source_name, rate_name;
    // What the texels come from, as names and values (a scene and its seed, a file's length and
    // time): a resume under other facts is refused.
    std::vector<std::pair<std::string, std::string>> source_facts;
};

// A mask has one channel of unorm8 (0: don't care), sides that are the texture's or 1 (what it says
// there holds all along that side), and Locality::any; nullptr stands for one by which all texels
// matter. Errors: bad_argument.
Status check_mask(const TexelSource* mask, const Extent4& texture_size);

// A coarse level that was stored in front of the texture.
struct CodedLevel {
    Extent4 size{0, 0, 0, 0}; // texels
    unsigned step_shift = 0;  // its steps are 2^step_shift those of the texture
    std::uint64_t bytes = 0;  // of its tiles
};

struct EncodeReport {
    std::uint64_t file_bytes = 0;
    std::uint64_t raw_bytes = 0;
    double bits_per_texel = 0;                       // file_bytes * 8 / texels
    std::optional<std::uint64_t> texels_that_matter; // only with a mask
    // dB over all samples of texels that matter (HDR: over the 16-bit codes); 999: lossless
    double psnr = 0;
    double max_error = 0; // samples: 8-bit steps, or half-float ulps
    double seconds = 0;
    unsigned passes = 0;                     // full passes over the source
    std::optional<std::uint64_t> kept_tiles; // only with `reuse`: those whose bytes are that file's
    std::uint64_t nan_count = 0;             // replaced by 0
    std::uint64_t infinity_count = 0;        // replaced by +-65504
    bool target_met = true;                  // false: a PSNR that no quantiser reaches
    std::string note;                        // why a target was missed, or met by a lossless file
    // Views that move as if rows and columns of their cameras were swapped; in order they may take half.
    bool looks_transposed = false;
    std::vector<CodedLevel> coarse_levels; // finest first; only with `layers`
};

// The coding tools that EncodeOptions::tools may name, one a line, each with what it does. What they
// are worth: tests/regression/ablation.md.
std::string coding_tools_help();

// Errors: bad_argument, with the names, where EncodeOptions::tools would be refused.
Status check_coding_tools(const std::string& tools);

// Everything about an encode that can be refused before a texel is read: ranges, tile extents, tools,
// the mask's shape, alpha against channels, metadata (UTF-8, sizes), a mesh that
// does not decode, a size target that not even a
// file of nothing but background meets. The functions below begin with it, before they touch a disk.
// Time: short, but a walk over the tiles' number for targets in bytes. Errors: bad_argument;
// unsupported (more tiles than a file can have).
Status check_options(const TextureDesc& desc, const EncodeOptions& options);

// Encodes `source` into the file `path` (written to a temporary name, then renamed).
//
// Memory: 40 bytes a tile, a slab (slab_bytes) and, per thread, some MB; without a journal the compressed size besides;
// never the texture. With a journal the disk holds up to four times the compressed size (two passes,
// each under first and fitted tables).
// A run with a journal that fails, or is killed at any moment, leaves it if it holds finished tiles,
// and the message of an error says so; with bad_argument it leaves none, as no resume could do better. Two processes cannot write one output with a journal at once.
// The bytes depend on the texels, `mask`, the file to `reuse`, `rate`, `effort`, `tools`, `tile_extent`, `metadata`,
// `description` and `mesh` only.
// Errors: bad_argument (options out of range, a mask or a file to reuse that does not fit, a resume under other facts), io,
// runtime (verification failed), invalid_file (strict and a non-finite sample), and whatever `source` and `mask` report; over_budget where the smallest slab is above
// slab_bytes, or all of the pictures beside a file to reuse whose views are aligned.
Result<EncodeReport> encode_file(TexelSource& source, const std::string& path,
                                 const EncodeOptions& options);

// The same into memory.
Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options);

// The same, handed to `write` from the first byte to the last in pieces of about a MiB, all from the
// calling thread and all after encoding: rates are found by then. Errors: also those of `write`.
Result<EncodeReport>
encode_stream(TexelSource& source,
              const std::function<Status(std::span<const std::byte> piece)>& write,
              const EncodeOptions& options);

// The folder of the journal for a file.
std::string journal_path(const std::string& output);

// Whether that folder holds finished tiles that JournalUse::resume would find, and no living process
// works on it.
bool holds_finished_tiles(const std::string& output);

} // namespace tessera
