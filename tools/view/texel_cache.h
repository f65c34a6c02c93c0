// A cache of blocks of a texture, which are read on first use: tiles of a compressed file, boxes of
// a raw file, or boxes of a scene that are baked when they are needed.
#pragma once

#include "format/levels.h"
#include "format/sampler.h"
#include "format/texture.h"

#include <array>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace tessera {

// The number of the block that contains the texel.
inline std::uint64_t block_of(const TileGrid& grid, const Extent4& texel) {
    const auto& [u, v, s, t] = texel;
    return grid.number(grid.touched({texel, {u + 1, v + 1, s + 1, t + 1}}).begin);
}

// Thread-safe. A block that several threads need at the same time is read once.
class TexelCache {
public:
    using Block = std::shared_ptr<const std::vector<std::byte>>;

    // `source` must read boxes in any order (Locality::any) and outlive the cache. The cache keeps
    // about `max_bytes` of texels, plus the blocks in use.
    TexelCache(TexelSource& source, const Extent4& block_extent, std::uint64_t max_bytes);

    const TextureDesc& desc() const { return source_.desc(); }
    const TileGrid& grid() const { return grid_; }
    // Returns the texels of grid().box(number). Errors: those of the source.
    Result<Block> load(std::uint64_t number);

private:
    static constexpr std::size_t shard_count = 16;
    struct Entry {
        std::mutex mutex;
        bool ready = false;
        std::vector<std::byte> texels;
    };
    // A full shard is emptied. Pictures are drawn row by row, so most blocks of the previous rows
    // are not needed any more.
    struct Shard {
        std::mutex mutex;
        std::unordered_map<std::uint64_t, std::shared_ptr<Entry>> entries;
        std::uint64_t bytes = 0;
    };

    TexelSource& source_;
    TileGrid grid_;
    std::uint64_t max_shard_bytes_;
    std::array<Shard, shard_count> shards_;
};

// Reads texels through the cache for one thread. It keeps references to some blocks, so that most
// texels need no lock.
class CachedTexels final : public TexelLookup {
public:
    explicit CachedTexels(TexelCache& cache) : cache_(&cache), slots_(256) {}

    const TextureDesc& desc() const override { return cache_->desc(); }
    Result<glm::dvec4> texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                             std::uint32_t t) override;

private:
    struct Slot {
        std::uint64_t number = 0;
        Box4 box;
        TexelCache::Block texels; // null: empty
    };
    TexelCache* cache_;
    std::vector<Slot> slots_; // indexed by the block's number modulo their count
};

} // namespace tessera
