// Payloads of one pass in a file: one record a tile, appended as tiles are finished.
//
// File: 8 bytes "TESSJTL2", 4 bytes length L, L bytes that say what pass this is, CRC32C of all
// before. Then records, little-endian: "TILE", payload length (4), tile (8), squared error (8),
// texel CRC (4), largest error (4), NaNs (4), infinities (4), CRC32C of these 40 bytes and of the
// payload (4), payload. Nothing is ever rewritten, so a kill leaves whole records and at most a torn
// one at the end.
#pragma once

#include "codec/journal/tile_store.h"

#include <memory>
#include <mutex>
#include <string>

namespace tessera {

class JournalTiles : public TileStore {
public:
    ~JournalTiles() override;
    JournalTiles(const JournalTiles&) = delete;
    JournalTiles& operator=(const JournalTiles&) = delete;

    // A new file, in place of one that is there. `pass`: what is in it, at most 1 MiB.
    static Result<std::unique_ptr<JournalTiles>>
    create(const std::string& path, std::uint64_t tiles, std::span<const std::byte> pass);
    // The same, without a name: gone with this object or with the process.
    static Result<std::unique_ptr<JournalTiles>> create_nameless(const std::string& path,
                                                                 std::uint64_t tiles);
    // What an earlier process left of the same pass: fills `figures` (one a tile) for the tiles that
    // are whole; the file is cut off before the first record that is not. Of anything else than the
    // pass `pass`, or of nothing, it makes a new file. Trusts no byte of it.
    static Result<std::unique_ptr<JournalTiles>> resume(const std::string& path,
                                                        std::span<const std::byte> pass,
                                                        std::vector<CodedTile>& figures);
    // Whether a file is long enough for a record after its header. Does not look at the record.
    static bool holds_any(const std::string& path);

    // Writes are one system call each and appended under a lock: at some kB a tile and ten or so
    // thousand tiles a second at most, collecting them would gain nothing and lose tiles to a kill.
    Status put(std::uint64_t tile, const CodedTile& figures,
               std::span<const std::byte> payload) override;
    // Checks the record's CRC again.
    Status get(std::uint64_t tile, std::vector<std::byte>& out) const override;

    bool has(std::uint64_t tile) const { return places_[tile].offset != 0; }
    // Treats a tile as if it had never been put; for records that are whole but make no sense.
    void forget(std::uint64_t tile) { places_[tile] = {}; }

private:
    struct Place {
        std::uint64_t offset = 0; // of the record; 0: none
        std::uint32_t bytes = 0;  // of the payload
    };
    JournalTiles(int descriptor, std::string path, std::uint64_t tiles)
        : descriptor_(descriptor), path_(std::move(path)), places_(tiles) {}
    Status begin(std::span<const std::byte> pass);
    bool scan(std::span<const std::byte> pass, std::vector<CodedTile>& figures);

    int descriptor_;
    std::string path_;
    std::mutex mutex_;
    std::uint64_t end_ = 0;
    std::vector<Place> places_;
};

} // namespace tessera
