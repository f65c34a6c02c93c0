#include "tools/server/file_server_ranges.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::uint64_t streamed_bytes = 256 << 10; // most that one read brings

}

std::vector<FilePart> parts_of(const std::vector<std::pair<std::int64_t, std::int64_t>>& ranges,
                               std::uint64_t size) {
    std::vector<FilePart> parts;
    const auto length = static_cast<std::int64_t>(size);
    for (auto [first, last] : ranges) {
        if (first < 0 && last <= 0) // "-", "-0"
            continue;
        if (first < 0) { // the last `last` bytes
            first = std::max<std::int64_t>(0, length - last);
            last = length - 1;
        }
        if (last < 0 || last >= length)
            last = length - 1;
        if (first <= last)
            parts.push_back({static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(last)});
    }
    return parts;
}

void PartsBody::add_text(std::string text) {
    size_ += text.size();
    pieces_.push_back({std::move(text), 0, 0});
}

void PartsBody::add_part(const FilePart& part) {
    const std::uint64_t length = part.last - part.first + 1;
    size_ += length;
    pieces_.push_back({"", part.first, length});
}

void PartsBody::add_multipart(const std::vector<FilePart>& parts, const std::string& boundary) {
    for (const FilePart& part : parts) {
        add_text("\r\n--" + boundary + "\r\nContent-Type: application/octet-stream\r\n" +
                 "Content-Range: bytes " + std::to_string(part.first) + "-" +
                 std::to_string(part.last) + "/" + std::to_string(file_->size()) + "\r\n\r\n");
        add_part(part);
    }
    add_text("\r\n--" + boundary + "--\r\n");
}

bool PartsBody::send_some(const std::function<bool(const char*, std::size_t)>& write) {
    Piece& piece = pieces_[at_];
    if (!piece.text.empty()) {
        ++at_;
        return write(piece.text.data(), piece.text.size());
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(std::min(piece.length, streamed_bytes)));
    if (!file_->read(piece.offset, bytes).ok())
        return false;
    piece.offset += bytes.size();
    piece.length -= bytes.size();
    if (piece.length == 0)
        ++at_;
    return write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

} // namespace tessera
