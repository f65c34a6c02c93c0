// The payloads of one pass in a file, to which finished tiles are appended.
//
// The file: 8 bytes "TESSJTL2", length L (4), L bytes that identify the pass, CRC32C of all before
// (4). Then one record per tile, little-endian: "TILE", payload length (4), tile (8), squared error
// (8), checksum of the levels (4), largest error (4), NaNs (4), infinities (4), CRC32C of these 40
// bytes and the payload (4), payload. Nothing is overwritten, so a kill leaves whole records and at
// most a torn one at the end.
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

    // Opens what an earlier process left of the pass that the bytes `pass` (at most 1 MiB)
    // identify. Fills `figures`, one per tile, for the tiles that are whole and cuts the file off
    // before the first record that is not. Makes a new file if there is none of this pass. Trusts
    // no byte of the file. Errors: io, bad_argument.
    static Result<std::unique_ptr<JournalTiles>> resume(const std::string& path,
                                                        std::span<const std::byte> pass,
                                                        std::vector<CodedTile>& figures);
    // A new file without a name, which disappears with this object or with the process.
    static Result<std::unique_ptr<JournalTiles>> create_nameless(const std::string& path,
                                                                 std::uint64_t tiles);
    // Whether a file is long enough for a record. Does not read the record.
    static bool holds_any(const std::string& path);

    // Appends a record with one system call. Collecting records would save nothing at some kB per
    // tile, and would lose tiles to a kill.
    Status put(std::uint64_t tile, const CodedTile& figures,
               std::span<const std::byte> payload) override;
    // Checks the CRC of the record again.
    Status get(std::uint64_t tile, std::vector<std::byte>& out) const override;

    bool has(std::uint64_t tile) const { return places_[tile].offset != 0; }
    // Treats a tile as if it had never been put: its record is whole but makes no sense.
    void forget(std::uint64_t tile) { places_[tile] = {}; }

private:
    struct Place {
        std::uint64_t offset = 0; // of the record; 0: none
        std::uint32_t bytes = 0;  // of the payload
    };
    JournalTiles(int descriptor, std::string path, std::uint64_t tiles)
        : descriptor_(descriptor), path_(std::move(path)), places_(tiles) {}
    static Result<std::unique_ptr<JournalTiles>> open(const std::string& path, std::uint64_t tiles);
    Status begin(std::span<const std::byte> pass);
    bool scan(std::span<const std::byte> pass, std::vector<CodedTile>& figures);

    int descriptor_;
    std::string path_;
    std::mutex mutex_;
    std::uint64_t end_ = 0;
    std::vector<Place> places_;
};

} // namespace tessera
