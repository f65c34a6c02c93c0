#include "format/container/tiles_ahead.h"

#include <exception>
#include <numeric>
#include <span>

namespace tessera {

TilesAhead::TilesAhead(const ContainerReader& container, std::vector<std::uint64_t> tiles)
    : container_(container), tiles_(std::move(tiles)) {
    if (!container_.wants_prefetch())
        ready_end_ = tiles_.size();
    start();
}

TilesAhead all_tiles_ahead(const ContainerReader& container) {
    std::vector<std::uint64_t> tiles(static_cast<std::size_t>(container.grid().tiles()));
    std::iota(tiles.begin(), tiles.end(), 0);
    return TilesAhead(container, std::move(tiles));
}

void TilesAhead::start() {
    if (ready_end_ == tiles_.size())
        return;
    next_ = std::async(std::launch::async, [this, begin = ready_end_]() -> Result<std::size_t> {
        try {
            return container_.prefetch(std::span(tiles_).subspan(begin));
        } catch (const std::exception& e) { // mostly bad_alloc
            return Status(ErrorCode::runtime, e.what());
        }
    });
}

Result<std::size_t> TilesAhead::ready(std::size_t position) {
    while (position >= ready_end_) {
        const Result<std::size_t> window = next_.get();
        if (!window.ok()) {
            ready_end_ = tiles_.size();
            return window.status();
        }
        ready_end_ += *window;
        start();
    }
    return ready_end_ - position;
}

} // namespace tessera
