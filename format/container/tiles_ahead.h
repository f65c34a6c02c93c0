// Brings the bytes of coming tiles from a source where requests are dear, while those before them are
// used.
#pragma once

#include "format/container_reader.h"

#include <cstddef>
#include <cstdint>
#include <future>
#include <vector>

namespace tessera {

// Walks a list of tiles in windows, each brought by two requests at most (ContainerReader::prefetch).
// Used by one thread; the container must outlive it.
class TilesAhead {
public:
    // `tiles`: in the order in which they will be loaded.
    TilesAhead(const ContainerReader& container, std::vector<std::uint64_t> tiles);
    TilesAhead(const TilesAhead&) = delete; // the window on its way knows where it is
    TilesAhead& operator=(const TilesAhead&) = delete;

    // How many tiles from number `position` of the list on may be loaded now: the window that it
    // begins, or the rest of one; all that are left where the source asks for no prefetch. Waits for
    // the window and starts to bring the next one. Errors: those of prefetch(); after one, the rest
    // is left to load_tile(). Precondition: position < number of tiles, never less than before.
    Result<std::size_t> ready(std::size_t position);

private:
    void start();

    const ContainerReader& container_;
    std::vector<std::uint64_t> tiles_;
    std::size_t ready_end_ = 0;
    std::future<Result<std::size_t>> next_; // the window that begins at ready_end_
};

// All tiles of level 0, so that the position in the list is the tile's number.
TilesAhead all_tiles_ahead(const ContainerReader& container);

} // namespace tessera
