// The byte ranges of a request, and a response body made of them.
#pragma once

#include "format/byte_source.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

struct FilePart {
    std::uint64_t first = 0, last = 0; // bytes, both included, inside the file
    bool operator==(const FilePart&) const = default;
};

// Clips ranges to a file of `size` bytes and drops those outside it (RFC 9110, 14.1.2). A range is
// (first, last); -1 stands for a missing number, as in "5-" and "-5".
std::vector<FilePart> parts_of(const std::vector<std::pair<std::int64_t, std::int64_t>>& ranges,
                               std::uint64_t size);

// A body made of text and of parts of a file. It reads the file as it is sent.
class PartsBody {
public:
    explicit PartsBody(std::shared_ptr<ByteSource> file) : file_(std::move(file)) {}
    void add_text(std::string text);
    void add_part(const FilePart& part);
    // Adds all parts as multipart/byteranges (RFC 9110, 14.6).
    void add_multipart(const std::vector<FilePart>& parts, const std::string& boundary);

    std::uint64_t size() const { return size_; } // bytes
    // Passes the next bytes, at most 256 KiB, to `write`. False if the file cannot be read or
    // `write` returns false. Precondition: not at_end().
    bool send_some(const std::function<bool(const char*, std::size_t)>& write);
    bool at_end() const { return at_ == pieces_.size(); }

private:
    struct Piece {
        std::string text;
        std::uint64_t offset = 0, length = 0; // of a part of the file, if `text` is empty
    };
    std::shared_ptr<ByteSource> file_;
    std::vector<Piece> pieces_;
    std::uint64_t size_ = 0;
    std::size_t at_ = 0;
};

} // namespace tessera
