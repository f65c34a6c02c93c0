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
                      "a tile cache holds up to 2^32 - 1 tiles, not " + std::to_string(tiles));
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

Status TileCache::no_such_tile(std::uint32_t tile) const {
    return {ErrorCode::bad_argument, "there is no tile " + std::to_string(tile) +
                                         ", the cache has " + std::to_string(slot_of_.size()) +
                                         " tiles"};
}

void TileCache::begin_frame() {
    ++frame_;
    for (const std::uint32_t tile : waiting_)
        flags_[tile] &= static_cast<std::uint8_t>(~(waits | not_now));
    waiting_.clear();
}

Result<std::span<const DecodeJob>> TileCache::touch(std::span<const std::uint32_t> tiles,
                                                    std::uint32_t max_jobs) {
    for (const std::uint32_t tile : tiles)
        if (tile >= slot_of_.size())
            return no_such_tile(tile);
    jobs_.clear();
    // Residents first: a missing tile must not take the slot of a tile that comes later in the
    // list.
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
    touched_[slot] = frame_;
    unlink(slot);
    link_newest(slot);
}

void TileCache::request(std::uint32_t tile, std::uint32_t max_jobs) {
    if (jobs_.size() >= max_jobs)
        return wait(tile);
    std::uint32_t slot = first_free_;
    if (slot != slots_) {
        first_free_ = next_[slot];
    } else {
        slot = previous_[slots_]; // exists, because all slots are occupied
        if (touched_[slot] == frame_)
            return wait(tile);
        unlink(slot);
        set_slot(tile_of_[slot], no_slot);
    }
    tile_of_[slot] = tile;
    touched_[slot] = frame_;
    link_newest(slot);
    set_slot(tile, slot);
    jobs_.push_back({tile, slot});
}

void TileCache::wait(std::uint32_t tile) {
    if ((flags_[tile] & waits) != 0)
        return;
    flags_[tile] |= waits;
    waiting_.push_back(tile);
}

Status TileCache::mark_failed(std::uint32_t tile) {
    if (tile >= slot_of_.size())
        return no_such_tile(tile);
    if ((flags_[tile] & failed) != 0)
        return {};
    flags_[tile] |= failed;
    free_slot(tile);
    return {};
}

Status TileCache::put_off(std::uint32_t tile) {
    if (tile >= slot_of_.size())
        return no_such_tile(tile);
    if ((flags_[tile] & (failed | not_now)) != 0)
        return {};
    free_slot(tile);
    flags_[tile] |= not_now;
    wait(tile); // begin_frame() clears the flags of waiting tiles
    return {};
}

void TileCache::free_slot(std::uint32_t tile) {
    const std::uint32_t slot = slot_of_[tile];
    if (slot == no_slot)
        return;
    unlink(slot);
    next_[slot] = first_free_;
    first_free_ = slot;
    set_slot(tile, no_slot);
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
