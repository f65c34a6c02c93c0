// The bookkeeping of a tile cache of fixed size: which tile is in which slot. It needs no graphics.
//
// A frame lists the tiles that it samples. Each missing tile becomes a decode job for a free slot
// or, if there is none, for the slot of the tile that was touched least recently. Tiles of the
// current frame keep their slots. If a frame touches more tiles than there are slots, the rest must
// wait. Repeating that frame gives no jobs, so a camera that stands still never makes the cache
// thrash.
//
// Deterministic: the same calls give the same slots. touch() takes O(1) per listed tile. Memory is
// 5 bytes per tile and 20 bytes per slot, and lists as long as a frame's jobs and changes. Not
// thread-safe.
#pragma once

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

// A changed entry of the page table: the slot that holds `tile` now, or no_slot.
struct PageChange {
    std::uint32_t tile, slot;
    bool operator==(const PageChange&) const = default;
};

class TileCache {
public:
    // An empty cache of 1 to 2^31 slots for tiles 0..tiles-1, fewer than 2^32 of them. Errors:
    // bad_argument (another number of slots or tiles); runtime (not enough memory).
    static Result<TileCache> create(std::uint64_t slots, std::uint64_t tiles);

    std::uint32_t slots() const { return slots_; }

    void begin_frame();

    // Tells the cache that the current frame samples these tiles, in any order; repeated tiles
    // count once. Returns up to `max_jobs` jobs for missing tiles, in the order of the list; the
    // jobs are valid until the next call, and the page table shows them from now on. A frame may
    // make several calls, but a call can evict tiles that a later one lists. Errors: bad_argument
    // (a tile that does not exist; nothing has changed).
    Result<std::span<const DecodeJob>> touch(std::span<const std::uint32_t> tiles,
                                             std::uint32_t max_jobs);

    // The tiles of the current frame that have no slot, each once: because slots or max_jobs did
    // not suffice, or because of put_off(). Failed tiles are not listed. Valid until the next call.
    std::span<const std::uint32_t> waiting() const { return waiting_; }

    // Records that the tile cannot be decoded: it loses its slot and never gets one again. Errors:
    // bad_argument (a tile that does not exist).
    Status mark_failed(std::uint32_t tile);

    // Records that the tile's bytes are not available now: it loses its slot and gets none in the
    // current frame. The next frame that touches it gets a job for it. Failed tiles stay failed.
    // Errors: bad_argument (a tile that does not exist).
    Status put_off(std::uint32_t tile);

    // The slot of a tile, or no_slot, also for tiles that do not exist.
    std::uint32_t slot_of(std::uint32_t tile) const;

    // The entries of the page table that changed since the last call, each once. At first all
    // entries are no_slot. Valid until the next call.
    std::span<const PageChange> take_changes();

private:
    enum Flag : std::uint8_t { failed = 1, waits = 2, changed = 4, not_now = 8 };

    TileCache(std::uint32_t slots, std::size_t tiles);
    void unlink(std::uint32_t slot);
    void link_newest(std::uint32_t slot);
    void renew(std::uint32_t slot);
    void request(std::uint32_t tile, std::uint32_t max_jobs);
    void wait(std::uint32_t tile);
    void set_slot(std::uint32_t tile, std::uint32_t slot);
    void free_slot(std::uint32_t tile);
    Status no_such_tile(std::uint32_t tile) const;

    std::uint32_t slots_;
    std::uint64_t frame_ = 0;

    std::vector<std::uint32_t> slot_of_; // by tile
    std::vector<std::uint8_t> flags_;    // by tile

    // Indexed by slot. Occupied slots form a ring through index slots_: next_[slots_] was touched
    // last, and previous_[slots_] is evicted next. Free slots form a chain of next_ from
    // first_free_ to slots_.
    std::vector<std::uint32_t> tile_of_, next_, previous_;
    std::vector<std::uint64_t> touched_; // frame
    std::uint32_t first_free_ = 0;

    std::vector<DecodeJob> jobs_;
    std::vector<std::uint32_t> waiting_, changed_;
    std::vector<PageChange> changes_;
};

} // namespace tessera
