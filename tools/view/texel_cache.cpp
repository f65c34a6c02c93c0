#include "tools/view/texel_cache.h"

namespace tessera {

TexelCache::TexelCache(TexelSource& source, const Extent4& block_extent, std::uint64_t max_bytes)
    : source_(source), grid_(source.desc().size, block_extent),
      max_shard_bytes_(max_bytes / shard_count) {}

Result<TexelCache::Block> TexelCache::load(std::uint64_t number) {
    Shard& shard = shards_[number % shard_count];
    std::shared_ptr<Entry> entry;
    {
        const std::lock_guard lock(shard.mutex);
        std::shared_ptr<Entry>& found = shard.entries[number];
        if (!found)
            found = std::make_shared<Entry>();
        entry = found;
    }
    const std::lock_guard reading(entry->mutex);
    if (!entry->ready) {
        const Box4 box = grid_.box(number);
        entry->texels.resize(desc().box_bytes(box));
        TESSERA_TRY(source_.read(box, entry->texels));
        entry->ready = true;
        const std::lock_guard lock(shard.mutex);
        shard.bytes += entry->texels.size();
        if (shard.bytes > max_shard_bytes_) {
            shard.entries.clear();
            shard.bytes = 0;
        }
    }
    return Block(entry, &entry->texels);
}

Result<glm::dvec4> CachedTexels::texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                                       std::uint32_t t) {
    const TileGrid& grid = cache_->grid();
    const Extent4 at{u, v, s, t};
    const std::uint64_t number = block_of(grid, at);
    Slot& slot = slots_[number % slots_.size()];
    if (!slot.texels || slot.number != number) {
        TESSERA_TRY_ASSIGN(TexelCache::Block block, cache_->load(number));
        slot = {number, grid.box(number), std::move(block)};
    }
    const std::size_t index = slot.box.index_of(at);
    return texel_value(desc(), slot.texels->data() + index * desc().texel_bytes());
}

} // namespace tessera
