// Which tiles are in the slots of a tile cache of fixed size: the bookkeeping, without any graphics.
//
// A frame says which tiles it samples; those that are missing become decode jobs for a free slot, or
// for the slot of the tile that has not been touched for the longest time. A tile that was touched in
// the current frame keeps its slot. When a frame touches more tiles than there are slots, the rest
// waits: repeating that frame changes nothing and gives no jobs, so a camera that stands still never
// makes the cache thrash (once max_jobs has let all jobs through).
//
// Deterministic: the same calls give the same slots. touch() costs O(1) a listed tile; memory is
// 5 bytes a tile and 20 bytes a slot, besides lists as long as a frame's jobs and changes.
// Not thread-safe.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

constexpr std::uint32_t no_slot = 0xffffffffu;

// Decode `tile` into `slot`.
struct DecodeJob {
    std::uint32_t tile, slot;
    bool operator==(const DecodeJob&) const = default;
};

// An entry of the page table: the slot that holds `tile` now, or no_slot.
struct PageChange {
    std::uint32_t tile, slot;
    bool operator==(const PageChange&) const = default;
};

class TileCache {
public:
    // `slots` of a cache for tiles 0..tiles-1. bad_argument: no slots, more than 2^31 of them, or
    // more than 2^32 - 1 tiles. runtime: not enough memory.
    static Result<TileCache> create(std::uint64_t slots, std::uint64_t tiles);

    std::uint32_t slots() const { return slots_; }
    std::uint64_t tiles() const { return slot_of_.size(); }
    std::uint32_t resident() const { return resident_; } // occupied slots, <= slots()

    void begin_frame();

    // The current frame samples these tiles, in any order; tiles listed more than once count once.
    // Returns at most `max_jobs` jobs for tiles that were missing, in the order of the list, valid
    // until the next call; the page table shows them from now on. A frame may be told in several
    // calls, but tiles of later calls are then not safe from eviction by earlier ones.
    // bad_argument: a tile that is not there; nothing has changed then.
    Result<std::span<const DecodeJob>> touch(std::span<const std::uint32_t> tiles,
                                             std::uint32_t max_jobs);

    // Tiles of the current frame that got no slot when they were touched, each once: late and
    // deferred ones; and those that were put off. Failed tiles are not among them. Valid until the
    // next call.
    std::span<const std::uint32_t> waiting() const { return waiting_; }

    // The tile cannot be decoded: it loses its slot and is never given one again.
    // bad_argument: a tile that is not there.
    Status mark_failed(std::uint32_t tile);
    bool has_failed(std::uint32_t tile) const;

    // What the tile is decoded from cannot be had at the moment: it loses its slot and gets none in
    // the current frame; the next frame that touches it gives out its job again. Nothing happens to
    // tiles that have failed. bad_argument: a tile that is not there.
    Status put_off(std::uint32_t tile);

    // The slot of a tile, or no_slot, also for tiles that are not there.
    std::uint32_t slot_of(std::uint32_t tile) const;

    // What changed in the page table since the last call of this (in the beginning every entry is
    // no_slot), one entry a tile. Valid until the next call.
    std::span<const PageChange> take_changes();

    const TileCacheStats& stats() const { return stats_; }

private:
    enum Flag : std::uint8_t { failed = 1, waits = 2, changed = 4, not_now = 8 };

    TileCache(std::uint32_t slots, std::size_t tiles);
    void unlink(std::uint32_t slot);
    void link_newest(std::uint32_t slot);
    void renew(std::uint32_t slot);
    void request(std::uint32_t tile, std::uint32_t max_jobs);
    void wait(std::uint32_t tile, std::uint64_t& counter);
    void set_slot(std::uint32_t tile, std::uint32_t slot);
    void free_slot(std::uint32_t tile);

    std::uint32_t slots_;
    std::uint32_t resident_ = 0;
    std::uint64_t frame_ = 0;

    std::vector<std::uint32_t> slot_of_; // by tile
    std::vector<std::uint8_t> flags_;    // by tile

    // By slot. Occupied slots form a ring through index slots_: next_ of that is the slot touched
    // last, previous_ of it the one to evict. Free slots form a chain through next_ that ends there.
    std::vector<std::uint32_t> tile_of_, next_, previous_;
    std::vector<std::uint64_t> touched_; // frame
    std::uint32_t first_free_ = 0;

    std::vector<DecodeJob> jobs_;
    std::vector<std::uint32_t> waiting_, changed_;
    std::vector<PageChange> changes_;
    TileCacheStats stats_;
};

} // namespace tessera
