#include "decoder_glsl/cache/tile_cache.h"

#include <exception>
#include <numeric>
#include <string>

namespace tessera {

Result<TileCache> TileCache::create(std::uint64_t slots, std::uint64_t tiles) {
    if (slots < 1 || slots > std::uint64_t{1} << 31)
        return Status(ErrorCode::bad_argument,
                      "a tile cache has 1 to 2^31 slots, not " + std::to_string(slots));
    if (tiles > 0xffffffffu)
        return Status(ErrorCode::bad_argument,
                      "a tile cache is for up to 2^32 - 1 tiles, not " + std::to_string(tiles));
    try {
        return TileCache(static_cast<std::uint32_t>(slots), static_cast<std::size_t>(tiles));
    } catch (const std::exception&) { // bad_alloc, length_error
        return Status(ErrorCode::runtime, "not enough memory for a cache of " +
                                              std::to_string(slots) + " slots and " +
                                              std::to_string(tiles) + " tiles");
    }
}

TileCache::TileCache(std::uint32_t slots, std::size_t tiles)
    : slots_(slots), slot_of_(tiles, no_slot), flags_(tiles, 0), tile_of_(slots),
      next_(std::size_t{slots} + 1), previous_(std::size_t{slots} + 1), touched_(slots) {
    std::iota(next_.begin(), next_.end() - 1, 1u);
    next_[slots] = previous_[slots] = slots;
}

void TileCache::begin_frame() {
    ++frame_;
    ++stats_.frames;
    for (const std::uint32_t tile : waiting_)
        flags_[tile] &= static_cast<std::uint8_t>(~(waits | not_now));
    waiting_.clear();
}

Result<std::span<const DecodeJob>> TileCache::touch(std::span<const std::uint32_t> tiles,
                                                    std::uint32_t max_jobs) {
    for (const std::uint32_t tile : tiles)
        if (tile >= slot_of_.size())
            return Status(ErrorCode::bad_argument, "tile " + std::to_string(tile) +
                                                       " was touched, of " +
                                                       std::to_string(slot_of_.size()));
    jobs_.clear();
    // Residents first, so that no missing tile takes the slot of one that comes later in the list.
    for (const std::uint32_t tile : tiles)
        if (slot_of_[tile] != no_slot)
            renew(slot_of_[tile]);
    for (const std::uint32_t tile : tiles)
        if (slot_of_[tile] == no_slot && (flags_[tile] & (failed | not_now)) == 0)
            request(tile, max_jobs);
    return std::span<const DecodeJob>(jobs_);
}

void TileCache::renew(std::uint32_t slot) {
    if (touched_[slot] == frame_)
        return;
    ++stats_.hits;
    touched_[slot] = frame_;
    unlink(slot);
    link_newest(slot);
}

void TileCache::request(std::uint32_t tile, std::uint32_t max_jobs) {
    if (jobs_.size() >= max_jobs)
        return wait(tile, stats_.deferred);
    std::uint32_t slot = first_free_;
    if (slot != slots_) {
        first_free_ = next_[slot];
        ++resident_;
    } else {
        slot = previous_[slots_]; // all are occupied, so there is one
        if (touched_[slot] == frame_)
            return wait(tile, stats_.late);
        unlink(slot);
        set_slot(tile_of_[slot], no_slot);
        ++stats_.evictions;
    }
    tile_of_[slot] = tile;
    touched_[slot] = frame_;
    link_newest(slot);
    set_slot(tile, slot);
    jobs_.push_back({tile, slot});
    ++stats_.decodes;
}

void TileCache::wait(std::uint32_t tile, std::uint64_t& counter) {
    if ((flags_[tile] & waits) != 0)
        return;
    flags_[tile] |= waits;
    waiting_.push_back(tile);
    ++counter;
}

Status TileCache::mark_failed(std::uint32_t tile) {
    if (tile >= slot_of_.size())
        return {ErrorCode::bad_argument, "tile " + std::to_string(tile) + " has failed, of " +
                                             std::to_string(slot_of_.size())};
    if ((flags_[tile] & failed) != 0)
        return {};
    flags_[tile] |= failed;
    ++stats_.failures;
    free_slot(tile);
    return {};
}

Status TileCache::put_off(std::uint32_t tile) {
    if (tile >= slot_of_.size())
        return {ErrorCode::bad_argument, "tile " + std::to_string(tile) + " is put off, of " +
                                             std::to_string(slot_of_.size())};
    if ((flags_[tile] & (failed | not_now)) != 0)
        return {};
    free_slot(tile);
    flags_[tile] |= not_now;
    ++stats_.put_off;
    if ((flags_[tile] & waits) == 0) { // begin_frame() finds it among those that wait
        flags_[tile] |= waits;
        waiting_.push_back(tile);
    }
    return {};
}

void TileCache::free_slot(std::uint32_t tile) {
    const std::uint32_t slot = slot_of_[tile];
    if (slot == no_slot)
        return;
    unlink(slot);
    next_[slot] = first_free_;
    first_free_ = slot;
    --resident_;
    set_slot(tile, no_slot);
}

bool TileCache::has_failed(std::uint32_t tile) const {
    return tile < flags_.size() && (flags_[tile] & failed) != 0;
}

std::uint32_t TileCache::slot_of(std::uint32_t tile) const {
    return tile < slot_of_.size() ? slot_of_[tile] : no_slot;
}

std::span<const PageChange> TileCache::take_changes() {
    changes_.clear();
    for (const std::uint32_t tile : changed_) {
        flags_[tile] &= static_cast<std::uint8_t>(~changed);
        changes_.push_back({tile, slot_of_[tile]});
    }
    changed_.clear();
    return changes_;
}

void TileCache::set_slot(std::uint32_t tile, std::uint32_t slot) {
    slot_of_[tile] = slot;
    if ((flags_[tile] & changed) != 0)
        return;
    flags_[tile] |= changed;
    changed_.push_back(tile);
}

void TileCache::unlink(std::uint32_t slot) {
    next_[previous_[slot]] = next_[slot];
    previous_[next_[slot]] = previous_[slot];
}

void TileCache::link_newest(std::uint32_t slot) {
    next_[slot] = next_[slots_];
    previous_[slot] = slots_;
    previous_[next_[slots_]] = slot;
    next_[slots_] = slot;
}

} // namespace tessera
