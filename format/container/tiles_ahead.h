// Loads the bytes of the next tiles from a slow source while the caller uses the tiles before them.
#pragma once

#include "format/container_reader.h"

#include <cstddef>
#include <cstdint>
#include <future>
#include <vector>

namespace tessera {

// Walks a list of tiles in windows. ContainerReader::prefetch() loads a window with at most two
// requests. Not thread-safe. The container must outlive it.
class TilesAhead {
public:
    // `tiles` are in the order in which the caller will load them.
    TilesAhead(const ContainerReader& container, std::vector<std::uint64_t> tiles);
    // Not copyable, because the task that loads the next window refers to this object.
    TilesAhead(const TilesAhead&) = delete;
    TilesAhead& operator=(const TilesAhead&) = delete;

    // Waits until tiles[position] is loaded and returns how many tiles from there on are loaded, at
    // least one; then starts to load the next window. If the source does not want prefetching, it
    // returns the number of all remaining tiles at once. Errors: those of prefetch(). After an
    // error the remaining tiles are left to load_tile(). Preconditions: position < number of tiles,
    // and position is not less than in the call before.
    Result<std::size_t> ready(std::size_t position);

private:
    void start();

    const ContainerReader& container_;
    std::vector<std::uint64_t> tiles_;
    std::size_t ready_end_ = 0;
    std::future<Result<std::size_t>> next_; // the window that begins at ready_end_
};

// Walks all tiles of level 0, so that the position in the list is the number of the tile.
TilesAhead all_tiles_ahead(const ContainerReader& container);

} // namespace tessera
