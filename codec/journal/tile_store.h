// Keeps the payloads of a pass until the file is written: in memory, or in a journal on disk.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace tessera {

// Figures of a coded tile. These 40 bytes per tile are all that a pass holds in memory when its
// payloads are on disk.
struct CodedTile {
    std::uint64_t squared_error = 0; // of sample codes
    std::uint32_t levels_sum = 0;    // checksum of its levels (codec/pass/tile_figures.h)
    std::uint32_t max_error = 0;     // of sample codes
    std::uint32_t nan_count = 0, infinity_count = 0;
    std::uint32_t payload_bytes = 0;
};

class TileStore {
public:
    virtual ~TileStore() = default;
    // Stores the payload of a tile and replaces an earlier one. Thread-safe for different tiles.
    // Errors: io.
    virtual Status put(std::uint64_t tile, const CodedTile& figures,
                       std::span<const std::byte> payload) = 0;
    // Replaces `out` by the payload. Thread-safe, except against put() of the same tile. Errors:
    // io; bad_argument for a tile that was never put.
    virtual Status get(std::uint64_t tile, std::vector<std::byte>& out) const = 0;
};

class MemoryTileStore : public TileStore {
public:
    explicit MemoryTileStore(std::uint64_t tiles) : payloads_(tiles) {}
    Status put(std::uint64_t tile, const CodedTile&, std::span<const std::byte> payload) override {
        payloads_[tile].assign(payload.begin(), payload.end());
        return {};
    }
    Status get(std::uint64_t tile, std::vector<std::byte>& out) const override {
        out = payloads_[tile];
        return {};
    }

private:
    std::vector<std::vector<std::byte>> payloads_;
};

} // namespace tessera
