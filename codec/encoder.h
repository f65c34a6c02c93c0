// The encoder: turns the texels of a 4D texture into a .tess file.
//
//     EncodeOptions options;
//     options.rate = {RateTarget::Kind::psnr, 40};
//     Result<EncodeReport> report = encode_file(source, "out.tess", options);
//
// All functions may be called from several threads at once, each call with its own source.
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

// The size or the error that the file shall have. Texels without meaning (EncodeOptions::mask) do
// not count towards `psnr` and `max_error`.
struct RateTarget {
    enum class Kind {
        // value: 1 to 100. 100 is the finest quantiser step, 0.75 of an 8-bit step; lowering the
        // quality by 8 doubles the step. One pass.
        quality,
        // value: dB over all samples, above 0 and at most 120. The result is never below the
        // target. A first pass within 0.05 dB above it is accepted (0.15 dB for sources that are
        // slow to read again), a second one within twice that. Small textures can exceed it by
        // more.
        psnr,
        // value: bits per texel, all channels together, whole file. Never exceeded; most files are
        // 2 to 4 % smaller.
        bpt,
        // value: bytes of the whole file. As `bpt`.
        bytes,
        // value: a whole number. No sample differs by more: in 8-bit steps, or in ulps of a half
        // float. 0 is lossless.
        max_error,
    };
    Kind kind = Kind::quality;
    double value = 75;
};

// Whether encode_file keeps finished tiles in the folder "<path>.journal" until the file exists, so
// that an interrupted encode can be resumed.
enum class JournalUse {
    none,   // compressed tiles stay in memory
    start,  // compressed tiles go to the journal; an earlier journal is deleted
    resume, // like `start`, but continues with an earlier journal; the resulting file is the same
};

// As EncodeOptions::tile_extent: the encoder chooses. It encodes parts of the texture in tiles of
// several shapes, from all views (up to 32x32) of a small part of the surface to few views of a
// large part, and takes the cheapest. For 32x32 views these are 8x8x32x32, 16x16x16x16, 32x32x8x8
// and 64x64x4x4; for 9x9 views 32x24x9x9, 64x37x5x5 and 64x64x3x3. With `layers` it chooses among
// 32x32x8x8 and 32x32x4x4, on a mesh among 32x32x8x8 and 64x64x4x4. It takes a default without
// trying where the target is a maximum error or the texture has at most 32 texels along u or v.
constexpr Extent4 tile_by_trial{0, 0, 0, 0};

constexpr int usual_effort = 3, most_effort = 4;

// How the caller's input and options are called in messages and in the journal.
struct EncodeLabels {
    std::string source; // prefix of errors about the texels, such as a file name; "": none
    std::string rate;   // prefix of errors about the rate, such as an option; "": none
    // Where the texels come from, as names and values: a scene and its seed, a file's length and
    // time. A journal is not resumed if they have changed.
    std::vector<std::pair<std::string, std::string>> facts;
};

struct EncodeOptions {
    // Size and quality.
    RateTarget rate;
    int effort = usual_effort; // 0 (fastest) to most_effort (smallest)
    // If no quantiser reaches a PSNR target, the file is lossless instead, even if that is larger.
    // Without this option that only happens if the lossless file is smaller and the source is quick
    // to read again; otherwise the file falls short of the target and the report says so.
    bool lossless_fallback = false;

    // Texels that have a meaning: one channel of unorm8, 0 where any value will do. Each side is
    // the texture's or 1, in which case the mask is repeated along it. Needs Locality::any and must
    // outlive the call. nullptr: all texels. Masked texels take the values that cost least. Targets
    // and figures ignore them, except for bits_per_texel, and `strict` accepts NaN there.
    TexelSource* mask = nullptr;
    // If true, NaN and infinities are errors. Otherwise NaN becomes 0 and infinities +-65504.
    bool strict = false;

    // Layout of the file.
    // Largest tile: 1 to 256 along u and v, 1 to 32 along s and t.
    Extent4 tile_extent = tile_by_trial;
    // Stores coarse levels first (at most 3 % more bytes), so that any beginning of the file shows
    // the whole texture.
    bool layers = false;
    // A file whose texels were decoded and perhaps edited to make this texture; it has the same
    // size, sample type and channels, was opened whole and outlives the call. nullptr: none. Tiles
    // that it still decodes to keep their bytes, so unedited parts lose nothing however often this
    // is done. The others are encoded at `effort` with that file's quantiser, tables, filter,
    // colour transform and tile shape; `rate` and `tile_extent` are ignored.
    const Decoder* reuse = nullptr;

    // What the file says about the texture.
    Description description; // proxy, maps, transfer, primaries
    // The bytes of encode_mesh() (format/surface_mesh.h), stored unchanged. Required with
    // Proxy::mesh, forbidden otherwise.
    std::vector<std::byte> mesh;
    // Key/values. The encoder adds "Software" if it is absent and writes the keys that begin with
    // "tessera:" itself: they record how it encoded. It adds none of them if that would take more
    // than 1 % of the file.
    Metadata metadata;

    // Resources. They do not affect the bytes, with one exception at slab_bytes.
    unsigned threads = 0; // 0: all cores
    // Most bytes of texels held at a time for sources that must be read in slabs (pictures).
    // Sources of Locality::any hold none. Affects the output only in that pictures larger than half
    // of it are encoded without view alignment.
    std::uint64_t slab_bytes = 512u << 20;
    bool verify = true; // decodes every tile again and compares it before it is written
    JournalUse journal = JournalUse::none; // encode_file only

    // Communication with the caller.
    ProgressFunction progress;
    // Called now and then, from several threads. Once it returns true, encoding stops with the
    // error "interrupted".
    std::function<bool()> cancelled;
    // Called after the texels were read for the last time and before anything is written. If it
    // returns an error, such as that the source has changed meanwhile, encoding fails with that
    // error and deletes its journal.
    std::function<Status()> confirm;
    EncodeLabels labels;
};

// A coarse level that is stored in front of the texture.
struct CodedLevel {
    Extent4 size{0, 0, 0, 0}; // texels
    unsigned step_shift = 0;  // its quantiser steps are 2^step_shift times those of the texture
    std::uint64_t bytes = 0;  // all its tiles
};

struct EncodeReport {
    std::uint64_t file_bytes = 0;
    std::uint64_t raw_bytes = 0;                     // texels, uncompressed
    double bits_per_texel = 0;                       // file_bytes * 8 / texels
    std::optional<std::uint64_t> texels_that_matter; // not masked; only with a mask
    double psnr = 0;      // dB over all samples (of half floats their 16-bit codes); 999: lossless
    double max_error = 0; // 8-bit steps, or ulps of a half float
    double seconds = 0;
    unsigned passes = 0;                     // full passes over the source
    std::optional<std::uint64_t> kept_tiles; // with `reuse`: tiles whose bytes were kept
    std::uint64_t nan_count = 0;             // replaced by 0
    std::uint64_t infinity_count = 0;        // replaced by +-65504
    bool target_met = true;                  // false: no quantiser reaches the target PSNR
    std::string note;                        // if the target was missed or the file became lossless
    // The views move as if rows and columns of cameras were swapped. In the right order the file
    // may need half the bytes.
    bool looks_transposed = false;
    std::vector<CodedLevel> coarse_levels; // finest first; only with `layers`
};

// Checks a mask as EncodeOptions::mask describes it; nullptr is valid. Errors: bad_argument.
Status check_mask(const TexelSource* mask, const Extent4& texture_size);

// Refuses everything that can be refused before a texel is read: ranges, tile extents, the mask's
// shape, alpha without an alpha channel, metadata (UTF-8, sizes), a mesh that cannot be decoded, a
// size target below the smallest possible file. The functions below call it before they touch a
// disk. Takes milliseconds, or for size targets a walk over the tile numbers. Errors: bad_argument;
// unsupported (more tiles than a file can have).
Status check_options(const TextureDesc& desc, const EncodeOptions& options);

// Encodes `source` into the file `path`, which is written under a temporary name and then renamed.
//
// The bytes depend on the texels and on mask, reuse, rate, lossless_fallback, effort, tile_extent,
// layers, metadata, description and mesh only (and on slab_bytes, as said there).
//
// Memory: 40 bytes per tile, one slab (slab_bytes), some MB per thread and, without a journal, the
// compressed size; never the whole texture. A journal takes up to four times the compressed size on
// disk. An encode with a journal that fails or is killed at any moment leaves the journal if it
// holds finished tiles, and the error message says so; after bad_argument it is deleted, because a
// resume would fail, too. Two processes cannot write the same output with a journal at once.
//
// Errors: bad_argument (options out of range, a mask or a file to reuse that does not fit, a resume
// of something else), io, runtime (cancelled, or verification failed), invalid_file (strict and a
// non-finite sample), over_budget (the smallest slab exceeds slab_bytes, or so do pictures that a
// reused file with aligned views needs as a whole), and all errors of `source` and `mask`.
Result<EncodeReport> encode_file(TexelSource& source, const std::string& path,
                                 const EncodeOptions& options);

// As encode_file, but into memory: replaces `out`.
Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options);

// As encode_file, but hands the bytes to `write` from first to last in pieces of about 1 MiB, from
// the calling thread, after everything is encoded. Fails with the first error of `write`.
Result<EncodeReport>
encode_stream(TexelSource& source,
              const std::function<Status(std::span<const std::byte> piece)>& write,
              const EncodeOptions& options);

// The folder of the journal for an output file.
std::string journal_path(const std::string& output);

// Whether a running process encodes into that file with a journal.
bool is_being_encoded(const std::string& output);

// Whether that folder holds finished tiles with which JournalUse::resume would continue, and no
// running process uses it.
bool holds_finished_tiles(const std::string& output);

} // namespace tessera
