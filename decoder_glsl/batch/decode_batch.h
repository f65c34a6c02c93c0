// Tiles that are decoded together: the words of binding 1, and the sizes of the other buffers.
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

// The pixels that the texels of a batch go to. That of a tile's texel (u, v, s, t) is
//   x + (u0 + u) % fold_u * stride_s + s,  y + (v0 + v) % fold_v * stride_t + t,
//   layer + (u0 + u) / fold_u + folds_u * ((v0 + v) / fold_v)
struct TexelPlan {
    std::uint32_t fold_u = 1u << 16, fold_v = 1u << 16, folds_u = 0;
    std::uint32_t stride_s = 0, stride_t = 0; // pixels from one angular image to the next
};
struct TexelPlace {
    std::uint32_t x = 0, y = 0, layer = 0; // pixels
    std::uint32_t u0 = 0, v0 = 0;          // below 65,536; 0 unless layers are folded
};

struct BatchLimits {
    std::uint32_t tiles = 2048;
    std::uint64_t work_words = (std::uint64_t{128} << 20) / 4;
    std::uint64_t coefficients = (std::uint64_t{128} << 20) / 16;
    std::uint64_t words = (std::uint64_t{128} << 20) / 4; // of the batch buffer
};

// A finished batch.
struct DecodeBatch {
    std::vector<std::uint32_t> words; // binding 1
    std::vector<std::uint64_t> tiles; // their numbers
    // Tiles whose damage the host has found: a bad table of streams, or copies that are too deep.
    // The device gets an empty payload for them and draws background.
    std::vector<std::uint64_t> damaged;
    std::uint32_t most_segments = 0; // of one tile
    std::uint32_t raw_chunks = 0;    // of 64 levels
    std::uint32_t corrections = 0;   // streams
    std::uint32_t waves = 1;         // of items.comp and texels.comp: largest depth of copies + 1
    std::uint32_t most_texels = 0;   // of one tile
    bool predicted = false;          // a tile is predicted
    bool borders = false;            // a tile is predicted from borders of blocks
    std::uint64_t work_words = 0;    // size of the work buffer
    std::uint64_t coefficients = 0;  // size of the coefficient buffer, 16 bytes each
};

// Collects tiles until a limit is reached.
class BatchBuilder {
public:
    // add() gives `tables` the scan tables that the tile needs, and lets it forget others if the
    // batch is empty. So unless they are unbounded, a batch must be decoded before the next add().
    BatchBuilder(DecodeTables& tables, const TileGrid& grid, const BatchLimits& limits,
                 const TexelPlan& plan);

    // Returns false if the batch is full: finish() must then come first. An empty batch takes any
    // tile. An empty payload is a tile of background. The bytes are copied.
    bool add(std::uint64_t tile, std::span<const std::byte> payload, const TexelPlace& place);
    bool empty() const { return content_.tiles.empty(); }
    // Returns the batch and begins the next one.
    DecodeBatch finish();

private:
    struct Size {
        std::uint64_t work_words, coefficients, words;
    };
    static Size empty_size();
    // A tile as the batch describes it. Stored and damaged tiles are one block without levels.
    struct Entry {
        PayloadParts parts;
        TreeSize tree;
        bool is_stored = false, is_sound = true;
    };
    Entry entry_of(std::span<const std::byte> payload, const BlockShape& shape) const;
    std::uint32_t value_words(const Entry& entry, std::uint64_t texels) const;
    Size size_of(const Entry& entry, std::size_t bytes, std::uint64_t texels) const;
    void add_segments(const Entry& entry, std::span<const std::byte> payload);
    std::uint32_t add_corrections(const Entry& entry, std::span<const std::byte> payload,
                                  const BlockShape& shape);
    void add_tile(const Entry& entry, std::span<const std::byte> payload, const BlockShape& shape,
                  const TexelPlace& place);
    // Byte of a part of the payload that is added next, in the payload area.
    std::uint32_t byte_of(std::span<const std::byte> payload,
                          std::span<const std::byte> part) const;
    void put_header(DecodeBatch& batch) const;

    DecodeTables& tables_;
    const TileGrid& grid_;
    const BatchLimits limits_;
    const TexelPlan plan_;

    // The batch so far; finish() starts a new one.
    struct Content {
        Size size = empty_size();
        std::vector<std::uint64_t> tiles, damaged;
        std::vector<std::uint32_t> tile_words, segment_words, correction_words, chunk_words,
            copy_words, border_words;
        std::vector<std::byte> payloads;
        std::uint32_t raw = 0;         // levels, a multiple of tsr_raw_chunk
        std::uint32_t multipliers = 0; // words
        std::uint32_t blocks = 0, items = 0;
        std::uint32_t values = 0; // words
        std::uint32_t most_segments = 0, most_texels = 0;
        std::uint32_t waves = 1;
    };
    Content content_;
};

} // namespace tessera
