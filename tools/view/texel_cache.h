// Blocks of a texture that are read when they are first asked for: tiles of a compressed file,
// pieces of a raw one, boxes of a scene that is baked as it is looked at.
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

// The number of the block with that texel.
inline std::uint64_t block_of(const TileGrid& grid, const Extent4& texel) {
    const auto& [u, v, s, t] = texel;
    return grid.number(grid.touched({texel, {u + 1, v + 1, s + 1, t + 1}}).begin);
}

// Shared by threads; a block that several want at once is read once.
class TexelCache {
public:
    using Block = std::shared_ptr<const std::vector<std::byte>>;

    // `source` likes any order of boxes (Locality::any) and outlives the cache. Keeps about
    // `max_bytes` of texels, besides those in use.
    TexelCache(TexelSource& source, const Extent4& block_extent, std::uint64_t max_bytes);

    const TextureDesc& desc() const { return source_.desc(); }
    const TileGrid& grid() const { return grid_; }
    // The texels of grid().box(number). Errors: those of the source.
    Result<Block> load(std::uint64_t number);

private:
    static constexpr std::size_t shard_count = 16;
    struct Entry {
        std::mutex mutex;
        bool ready = false;
        std::vector<std::byte> texels;
    };
    // A full shard is emptied: a picture is drawn row by row, and what its last rows touched is
    // mostly done with.
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

// One thread's way into the cache. It remembers some blocks, so that most texels cost no lock.
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
    std::vector<Slot> slots_; // by the low bits of the block's number
};

} // namespace tessera
