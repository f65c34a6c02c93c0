// Makes a decoded file, or one of its levels, a source of texels.
#include "codec/decoder.h"
#include "format/io/claim_cache.h"

#include <algorithm>
#include <mutex>
#include <vector>

namespace tessera {
namespace {

// Where each request is expensive, fetches tiles of a slab ahead of readers that proceed roughly in
// order, twice as many each time. A reader that jumps gets only what it reads.
class SlabAhead {
public:
    // `views` defines the coordinates of boxes.
    SlabAhead(const ContainerReader& container, const AlignedViews& views)
        : container_(container), views_(views) {}

    void begin(const Box4& box) {
        const std::lock_guard lock(mutex_);
        tiles_ = touched(box);
        ready_end_ = ahead_ = 0;
    }

    // Returns when the tiles of `box` have been fetched. Errors: those of prefetch().
    Status want(const Box4& box) {
        const std::lock_guard lock(mutex_);
        const std::vector<std::uint64_t> wanted = touched(box);
        const std::size_t first = place_of(wanted.front()), end = place_of(wanted.back()) + 1;
        if (end <= ready_end_ || end > tiles_.size())
            return {};
        const bool in_order = first <= ready_end_ + ahead_;
        ahead_ = in_order ? std::max<std::size_t>(1, 2 * ahead_) : 0;
        std::size_t begin = in_order ? ready_end_ : first;
        const std::size_t last = std::min(tiles_.size(), std::max(end, begin + ahead_));
        while (begin < end) {
            TESSERA_TRY_ASSIGN(const auto brought,
                               container_.prefetch(std::span(tiles_).subspan(begin, last - begin)));
            begin += brought;
        }
        ready_end_ = begin;
        return {};
    }

private:
    std::vector<std::uint64_t> touched(const Box4& box) const {
        return views_.tiles_touched(container_.grid(), box);
    }
    std::size_t place_of(std::uint64_t tile) const {
        return static_cast<std::size_t>(std::ranges::lower_bound(tiles_, tile) - tiles_.begin());
    }

    const ContainerReader& container_;
    const AlignedViews views_;
    std::mutex mutex_;
    std::vector<std::uint64_t> tiles_; // of the slab
    std::size_t ready_end_ = 0;        // tiles before this index were fetched or passed over
    std::size_t ahead_ = 0;            // how many tiles to fetch ahead
};

// A cache of decoded tiles. A box of aligned views cuts through many tiles, and so do the boxes
// after it. The cache holds about a row of tiles for a thousand texels along u.
class DecodedTiles {
public:
    // `decoder` must outlive it. `views` are those of its file.
    DecodedTiles(const Decoder& decoder, const AlignedViews& views)
        : decoder_(decoder), views_(views) {}

    // Precondition: `box` is in the texture, `out` has its size. Errors: as decode_grid_box().
    Status read(const Box4& box, std::span<std::byte> out, const ReadOptions& options) {
        const TileGrid& grid = decoder_.container().grid();
        for (const std::uint64_t tile : views_.tiles_touched(grid, box)) {
            const Box4 tile_box = grid.box(tile);
            // One texel is kept for all empty tiles.
            TESSERA_TRY_ASSIGN(
                const auto texels,
                decoder_.container().is_empty(tile)
                    ? decoded(of_empty_tiles, Box4::of_texel(tile_box.begin), options)
                    : decoded(tile, tile_box, options));
            views_.copy_from_grid(tile_box, *texels, box, out, decoder_.desc().texel_bytes());
        }
        return {};
    }

private:
    using Texels = std::vector<std::byte>;
    static constexpr std::uint64_t of_empty_tiles = ~std::uint64_t{0}; // not the number of a tile

    Result<ClaimCache<Texels>::Value> decoded(std::uint64_t key, const Box4& grid_box,
                                              const ReadOptions& options) {
        return tiles_.get(key, [&]() -> Result<Texels> {
            Texels texels(static_cast<std::size_t>(decoder_.desc().box_bytes(grid_box)));
            TESSERA_TRY(decoder_.decode_grid_box(grid_box, texels, options));
            return texels;
        });
    }

    static constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;

    const Decoder& decoder_;
    const AlignedViews views_;
    ClaimCache<Texels> tiles_{most_bytes,
                              [](const Texels& tile) { return std::uint64_t{tile.size()}; }};
};

class DecodedSource : public TexelSource {
public:
    // `views` defines the coordinates of boxes: the file's own views, or the grid as a texture.
    DecodedSource(const Decoder& decoder, const AlignedViews& views)
        : decoder_(decoder), is_grid_(!views.any()), desc_(decoder.desc()),
          ahead_(decoder.container(), views), tiles_(decoder, views) {
        desc_.size = views.texture_size();
    }
    const TextureDesc& desc() const override { return desc_; }
    Status begin_slab(const Box4& box) override {
        if (decoder_.container().wants_prefetch() && is_inside(box, desc().size))
            ahead_.begin(box);
        return {};
    }
    Status read(const Box4& box, std::span<std::byte> out) override {
        const bool inside = is_inside(box, desc().size) && out.size() == desc().box_bytes(box);
        if (decoder_.container().wants_prefetch() && inside)
            TESSERA_TRY(ahead_.want(box));
        const ReadOptions options{.threads = 1}; // its callers run in threads already
        if (is_grid_)
            return decoder_.decode_grid_box(box, out, options);
        return inside ? tiles_.read(box, out, options)
                      : decoder_.decode_box(box, out, options); // reports the error
    }

private:
    const Decoder& decoder_;
    const bool is_grid_; // coordinates are those of the grid of tiles
    TextureDesc desc_;
    SlabAhead ahead_;
    DecodedTiles tiles_; // used only if !is_grid_
};

class DecodedLevel : public TexelSource {
public:
    DecodedLevel(const Decoder& decoder, std::size_t level)
        : decoder_(decoder), level_(level), desc_(decoder.desc()) {
        desc_.size = decoder.container().levels()[level].size;
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        return decoder_.decode_coarse_box(level_, box, out);
    }

private:
    const Decoder& decoder_;
    const std::size_t level_;
    TextureDesc desc_;
};

} // namespace

std::unique_ptr<TexelSource> decoded_level(const Decoder& decoder, std::size_t level) {
    if (level == 0)
        return decoded_source(decoder);
    return std::make_unique<DecodedLevel>(decoder, level);
}

std::unique_ptr<TexelSource> decoded_source(const Decoder& decoder) {
    return std::make_unique<DecodedSource>(decoder, decoder.container().aligned_views());
}

std::unique_ptr<TexelSource> decoded_grid(const Decoder& decoder) {
    const Extent4& size = decoder.container().grid().size();
    return std::make_unique<DecodedSource>(decoder, AlignedViews(size, {}));
}

} // namespace tessera
