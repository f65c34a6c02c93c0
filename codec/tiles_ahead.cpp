#include "codec/tiles_ahead.h"

#include <exception>
#include <span>

namespace tessera {

TilesAhead::TilesAhead(const ContainerReader& container, std::vector<std::uint64_t> tiles)
    : container_(container), tiles_(std::move(tiles)) {
    if (!container_.wants_prefetch())
        ready_end_ = tiles_.size();
    start();
}

void TilesAhead::start() {
    if (ready_end_ == tiles_.size())
        return;
    next_ = std::async(std::launch::async, [this, begin = ready_end_]() -> Result<std::size_t> {
        try {
            return container_.prefetch(std::span(tiles_).subspan(begin));
        } catch (const std::exception& e) { // bad_alloc above all
            return Status(ErrorCode::runtime, e.what());
        }
    });
}

Result<std::size_t> TilesAhead::ready(std::size_t position) {
    while (position >= ready_end_) {
        const Result<std::size_t> window = next_.get();
        TESSERA_TRY(window.status());
        ready_end_ += *window;
        start();
    }
    return ready_end_ - position;
}

} // namespace tessera
