// A file of which some bytes are here: those that are not are asked of JavaScript, which alone can wait
// for a network.
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

// A piece of memory that JavaScript asked malloc() for and filled.
struct FreeBytes {
    void operator()(std::byte* bytes) const { std::free(bytes); }
};
using JsBytes = std::unique_ptr<std::byte[], FreeBytes>;

// A read fails where bytes are missing, and what it needs is then in wanted(): whoever called brings it
// with keep() and tries again. One thread.
class RangedBytes : public ByteSource {
public:
    explicit RangedBytes(std::uint64_t size) : size_(size) {}

    // `bytes`: `length` of them from `offset` on.
    void keep(std::uint64_t offset, std::size_t length, JsBytes bytes);
    // Of the reads since forget_wanted(): as few requests as pay, ascending.
    const std::vector<MergedRead>& wanted() const { return wanted_; }
    void forget_wanted() { wanted_.clear(); }
    // Lets the oldest pieces go until at most `most` bytes are held; never between a read that failed and
    // its repetition.
    void shrink(std::size_t most);

    std::uint64_t size() const override { return size_; }
    Status read(std::uint64_t offset, std::span<std::byte> out) override;
    Status read_many(std::span<const ReadRequest> requests) override;
    // Where all bytes are here, nothing is gained by asking for many at once.
    bool wants_prefetch() const override { return held_ < size_; }
    std::string name() const override { return "the file"; }

private:
    struct Piece {
        std::size_t length = 0;
        std::uint64_t age = 0;
        JsBytes bytes;
    };
    // False where a byte of the range is missing.
    bool copy(std::uint64_t offset, std::span<std::byte> out) const;

    std::uint64_t size_;
    std::map<std::uint64_t, Piece> pieces_; // by offset; they may overlap
    std::size_t held_ = 0, longest_ = 0;    // bytes: of all pieces, of the longest there was
    std::uint64_t next_age_ = 0;
    std::vector<MergedRead> wanted_;
};

} // namespace tessera
