#include "codec/metrics.h"

#include "codec/texels/sample_tiles.h"
#include "codec/texels/texel_mask.h"
#include "format/levels.h"
#include "format/work.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

namespace tessera {
namespace {

constexpr Extent4 sample_extent{32, 32, 8, 8}; // the codec's default tiles

// Computes the errors of some tiles of two textures.
class SampleComparer {
public:
    SampleComparer(TexelSource& a, TexelSource& b, const TileGrid& grid,
                   const std::vector<std::uint64_t>& tiles, const CompareOptions& options)
        : a_(a), b_(b), grid_(grid), tiles_(tiles), options_(options),
          sums_(tiles.size(), ErrorSums(a.desc())) {}

    Result<Comparison> run() {
        const bool anywhere = a_.locality() == Locality::any && b_.locality() == Locality::any;
        TESSERA_TRY(anywhere ? add_all() : add_in_turn());
        Comparison result(a_.desc());
        for (const ErrorSums& part : sums_) // in order, whatever the threads
            result.errors.merge(part);
        result.tiles = grid_.tiles();
        result.compared_tiles = tiles_.size();
        return result;
    }

private:
    Status add_all() {
        const Box4 whole = Box4::whole(a_.desc().size);
        TESSERA_TRY(a_.begin_slab(whole));
        TESSERA_TRY(b_.begin_slab(whole));
        std::vector<int> workers(thread_count(options_.threads));
        return parallel_for(
            workers, tiles_.size(), [&](int, std::size_t i) { return add(i); }, [](std::size_t) {});
    }

    // Sources that are walked in slabs get one slab per tile, which is slow but bounds memory.
    Status add_in_turn() {
        for (std::size_t i = 0; i < tiles_.size(); ++i) {
            TESSERA_TRY(a_.begin_slab(grid_.box(tiles_[i])));
            TESSERA_TRY(b_.begin_slab(grid_.box(tiles_[i])));
            TESSERA_TRY(add(i));
        }
        return {};
    }

    Status add(std::size_t i) {
        const Box4 box = grid_.box(tiles_[i]);
        std::vector<std::byte> texels_a(a_.desc().box_bytes(box)), texels_b(texels_a.size());
        TESSERA_TRY(a_.read(box, texels_a));
        TESSERA_TRY(b_.read(box, texels_b));
        std::vector<std::byte> matters;
        TESSERA_TRY(read_mask(options_.mask, box, matters));
        sums_[i].add(box, texels_a, texels_b, matters);
        const std::lock_guard lock(mutex_);
        if (options_.progress)
            options_.progress("comparing tiles", static_cast<double>(++done_),
                              static_cast<double>(tiles_.size()));
        return {};
    }

    TexelSource& a_;
    TexelSource& b_;
    const TileGrid& grid_;
    const std::vector<std::uint64_t>& tiles_;
    const CompareOptions& options_;
    std::vector<ErrorSums> sums_;
    std::mutex mutex_;
    std::uint64_t done_ = 0;
};

} // namespace

Result<Comparison> compare_sample(TexelSource& a, TexelSource& b, double fraction,
                                  std::uint64_t seed, const CompareOptions& options) {
    TESSERA_TRY(check_comparable(a.desc(), b.desc()));
    TESSERA_TRY(check_mask(options.mask, a.desc().size));
    if (!(fraction > 0 && fraction <= 1))
        return Status(ErrorCode::bad_argument, "the fraction of tiles to compare is " +
                                                   std::to_string(fraction) +
                                                   "; it must be above 0 and at most 1");
    const TileGrid grid(a.desc().size, sample_extent);
    const double wanted = std::ceil(fraction * static_cast<double>(grid.tiles()));
    const std::vector<std::uint64_t> tiles =
        choose_numbers(grid.tiles(), static_cast<std::uint64_t>(wanted), seed);
    return SampleComparer(a, b, grid, tiles, options).run();
}

} // namespace tessera
