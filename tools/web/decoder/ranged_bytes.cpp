#include "tools/web/decoder/ranged_bytes.h"

#include <algorithm>
#include <cstring>

namespace tessera {

void RangedBytes::keep(std::uint64_t offset, std::size_t length, JsBytes bytes) {
    Piece& piece = pieces_[offset];
    if (piece.length >= length)
        return;
    held_ += length - piece.length;
    longest_ = std::max(longest_, length);
    piece = {length, next_age_++, std::move(bytes)};
}

void RangedBytes::shrink(std::size_t most) {
    while (held_ > most && pieces_.size() > 1) {
        const auto oldest = std::ranges::min_element(
            pieces_, {}, [](const auto& entry) { return entry.second.age; });
        held_ -= oldest->second.length;
        pieces_.erase(oldest);
    }
}

bool RangedBytes::copy(std::uint64_t offset, std::span<std::byte> out) const {
    while (!out.empty()) {
        // Finds a piece that contains `offset`: the last one that begins at or before it, or an
        // earlier, longer one.
        auto at = pieces_.upper_bound(offset);
        std::size_t count = 0;
        while (count == 0 && at != pieces_.begin()) {
            --at;
            const std::uint64_t skip = offset - at->first;
            if (skip >= longest_)
                return false;
            if (skip < at->second.length) {
                count = static_cast<std::size_t>(
                    std::min<std::uint64_t>(out.size(), at->second.length - skip));
                std::memcpy(out.data(), at->second.bytes.get() + skip, count);
            }
        }
        if (count == 0)
            return false;
        offset += count;
        out = out.subspan(count);
    }
    return true;
}

Status RangedBytes::read(std::uint64_t offset, std::span<std::byte> out) {
    const ReadRequest request{offset, out};
    return read_many({&request, 1});
}

Status RangedBytes::read_many(std::span<const ReadRequest> requests) {
    std::vector<ReadRequest> missing;
    for (const ReadRequest& request : requests) {
        TESSERA_TRY(check_range(*this, request.offset, request.out.size()));
        if (!copy(request.offset, request.out))
            missing.push_back(request);
    }
    if (missing.empty())
        return {};
    const std::vector<MergedRead> reads = merge_reads(missing);
    wanted_.insert(wanted_.end(), reads.begin(), reads.end());
    return {ErrorCode::io,
            "bytes at offset " + std::to_string(missing.front().offset) + " have not been fetched"};
}

} // namespace tessera
