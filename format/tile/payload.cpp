#include "format/tile/payload.h"

#include "format/tile/limits.h"

#include <string>

namespace tessera {
namespace {

Status damaged(const std::string& what) {
    return {ErrorCode::invalid_file, what};
}

// Reads the table at the start of a payload of odd length.
class TableReader {
public:
    explicit TableReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    bool u16(std::size_t& value) {
        if (bytes_.size() - at_ < 2)
            return false;
        value = std::to_integer<std::size_t>(bytes_[at_]) |
                (std::to_integer<std::size_t>(bytes_[at_ + 1]) << 8);
        at_ += 2;
        return true;
    }
    std::size_t at_ = 0;

private:
    std::span<const std::byte> bytes_;
};

} // namespace

Status split_payload(std::span<const std::byte> payload, int tile_texels, PayloadParts& parts) {
    parts.segments.clear();
    parts.corrections.clear();
    if (payload.size() % 2 == 0) {
        parts.segments.push_back({0, payload});
        return {};
    }
    const auto head = std::to_integer<unsigned>(payload[0]);
    const auto most_further = static_cast<unsigned>(most_segments(tile_texels)) - 1;
    const bool corrects = head > most_further;
    TableReader table(payload);
    table.at_ = 1;
    struct Entry {
        std::size_t first_block, words;
    };
    std::vector<Entry> entries(head & most_further);
    std::size_t words = 0, least = 0; // the second segment may begin with block 0, too
    for (Entry& entry : entries) {
        if (!table.u16(entry.first_block) || !table.u16(entry.words))
            return damaged("segment table cut off");
        if (entry.first_block < least || entry.first_block >= max_leaves)
            return damaged("segments out of order");
        least = entry.first_block + 1;
        words += entry.words;
    }
    std::vector<std::size_t> chunks;
    if (corrects) {
        const int count = (tile_texels + correction_chunk - 1) / correction_chunk;
        std::size_t mask = 0;
        if (!table.u16(mask) || (mask >> count) != 0)
            return damaged("bad correction mask");
        chunks.resize(static_cast<std::size_t>(count));
        for (std::size_t i = 0; i < chunks.size(); ++i) {
            if ((mask >> i & 1) != 0 && (!table.u16(chunks[i]) || chunks[i] == 0))
                return damaged("correction table cut off");
            words += chunks[i];
        }
    }
    const std::size_t body = payload.size() - table.at_;
    if (body % 2 != 0 || words > body / 2)
        return damaged("streams longer than the tile");
    std::size_t at = table.at_;
    const auto take = [&](std::size_t bytes) {
        const auto part = payload.subspan(at, bytes);
        at += bytes;
        return part;
    };
    parts.segments.push_back({0, take(body - 2 * words)});
    for (const Entry& entry : entries)
        parts.segments.push_back({static_cast<int>(entry.first_block), take(2 * entry.words)});
    for (const std::size_t chunk : chunks)
        parts.corrections.push_back(take(2 * chunk));
    return {};
}

} // namespace tessera
