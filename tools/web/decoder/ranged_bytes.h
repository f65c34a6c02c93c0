// A file of which only some bytes are in memory. JavaScript fetches the missing ones, because only
// it can wait for a network.
#pragma once

#include "format/byte_source.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace tessera {

// Memory that JavaScript allocated with malloc() and filled.
struct FreeBytes {
    void operator()(std::byte* bytes) const { std::free(bytes); }
};
using JsBytes = std::unique_ptr<std::byte[], FreeBytes>;

// A read of missing bytes fails with the error io, and wanted() then lists them. The caller fetches
// them, passes them to keep() and repeats the read. Not thread-safe.
class RangedBytes : public ByteSource {
public:
    explicit RangedBytes(std::uint64_t size) : size_(size) {}

    // Stores the `length` bytes of the file at `offset`.
    void keep(std::uint64_t offset, std::size_t length, JsBytes bytes);
    // The missing bytes of all reads since forget_wanted(), merged into few requests, in ascending
    // order within a read.
    const std::vector<MergedRead>& wanted() const { return wanted_; }
    void forget_wanted() { wanted_.clear(); }
    // Frees the oldest pieces until at most `most` bytes are held. Must not be called between a
    // failed read and its repetition.
    void shrink(std::size_t most);

    std::uint64_t size() const override { return size_; }
    Status read(std::uint64_t offset, std::span<std::byte> out) override;
    Status read_many(std::span<const ReadRequest> requests) override;
    // A file that is completely in memory gains nothing from reading many ranges at once.
    bool wants_prefetch() const override { return held_ < size_; }
    std::string name() const override { return "the file"; }

private:
    struct Piece {
        std::size_t length = 0;
        std::uint64_t age = 0;
        JsBytes bytes;
    };
    // Returns false if a byte of the range is missing.
    bool copy(std::uint64_t offset, std::span<std::byte> out) const;

    std::uint64_t size_;
    std::map<std::uint64_t, Piece> pieces_; // by offset; they may overlap
    std::size_t held_ = 0;                  // bytes of all pieces
    std::size_t longest_ = 0;               // bytes of the longest piece so far
    std::uint64_t next_age_ = 0;
    std::vector<MergedRead> wanted_;
};

} // namespace tessera
