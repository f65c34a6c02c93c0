// Tiles that are decoded together: the words of binding 1, and how large the work buffers must be.
#pragma once

#include "decoder_glsl/batch/decode_tables.h"
#include "decoder_glsl/batch/tree_size.h"
#include "format/levels.h"
#include "format/tile/payload.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Where the texels of a batch go: the pixel of a tile's texel (u, v, s, t) is
//   x + (u0 + u) % fold_u * stride_s + s,  y + (v0 + v) % fold_v * stride_t + t,
//   layer + (u0 + u) / fold_u + folds_u * ((v0 + v) / fold_v)
struct TexelPlan {
    std::uint32_t fold_u = 1u << 16, fold_v = 1u << 16, folds_u = 0;
    std::uint32_t stride_s = 0, stride_t = 0; // pixels from one angular image to the next
};
struct TexelPlace {
    std::uint32_t x = 0, y = 0, layer = 0; // pixels
    std::uint32_t u0 = 0, v0 = 0;          // below 65,536; not 0 only where tiles are folded
};

struct BatchLimits {
    std::uint32_t tiles = 2048;
    std::uint64_t work_words = (std::uint64_t{128} << 20) / 4;
    std::uint64_t coefficients = (std::uint64_t{128} << 20) / 16;
    std::uint64_t words = (std::uint64_t{128} << 20) / 4; // of the batch buffer
};

// A finished batch. Sizes are in 32-bit words unless named otherwise.
struct DecodeBatch {
    std::vector<std::uint32_t> words; // binding 1
    std::vector<std::uint64_t> tiles; // their numbers
    // Tiles that the device does not see: their payload has no sound table of streams, or copies that
    // are too deep. They decode to the background.
    std::vector<std::uint64_t> damaged;
    std::uint32_t most_segments = 0; // of one tile
    std::uint32_t raw_chunks = 0;    // of 64 levels
    std::uint32_t corrections = 0;   // streams
    std::uint32_t waves = 1;         // of passes 4 and 5: one more than the largest depth of copies
    std::uint32_t most_texels = 0;   // of one tile
    bool predicted = false; // a tile copies, or has a base picture though nothing copies it
    std::uint64_t work_words = 0;
    std::uint64_t coefficients = 0;
};

// Collects tiles until a limit is reached.
class BatchBuilder {
public:
    BatchBuilder(const DecodeTables& tables, const TileGrid& grid, const BatchLimits& limits,
                 const TexelPlan& plan);

    // False when the batch is full and must be finished first; an empty batch takes any tile.
    // An empty payload is a tile of background. The bytes are copied.
    bool add(std::uint64_t tile, std::span<const std::byte> payload, const TexelPlace& place);
    bool empty() const { return tiles_.empty(); }
    // Hands out the batch and begins the next one.
    DecodeBatch finish();

private:
    struct Size {
        std::uint64_t work_words, coefficients, words;
    };
    static Size empty_size();
    // A tile as its batch has it: a stored one as one block without levels.
    struct Entry {
        PayloadParts parts;
        TreeSize tree;
        bool is_stored = false, is_sound = true;
    };
    Entry entry_of(std::span<const std::byte> payload, const BlockShape& shape) const;
    std::uint32_t value_words(const Entry& entry, std::uint64_t texels) const;
    Size size_of(const Entry& entry, std::size_t bytes, std::uint64_t texels) const;
    void add_records(const Entry& entry, std::span<const std::byte> payload,
                     const BlockShape& shape, const TexelPlace& place);

    const DecodeTables& tables_;
    const TileGrid& grid_;
    const BatchLimits limits_;
    const TexelPlan plan_;

    Size size_ = empty_size();
    std::vector<std::uint64_t> tiles_, damaged_;
    std::vector<std::uint32_t> tile_words_, segment_words_, correction_words_, chunk_words_,
        copy_words_;
    std::vector<std::byte> payloads_;
    std::uint32_t raw_ = 0;         // levels, a multiple of 64
    std::uint32_t multipliers_ = 0; // words
    std::uint32_t most_segments_ = 0;
    std::uint32_t blocks_ = 0, items_ = 0;
    std::uint32_t values_ = 0; // words
    std::uint32_t most_texels_ = 0;
    std::uint32_t waves_ = 1;
};

} // namespace tessera
