#include "codec/trials/background.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

namespace tessera {
namespace {

constexpr std::size_t stride = 16; // texels

// How often each texel is there. Noise has as many as there are texels: a node of memory for each would take
// longer than a quick effort's trials.
class TexelCounts {
public:
    struct Entry {
        std::uint64_t texel = 0, count = 0; // count 0: free
    };

    void add(std::uint64_t texel, std::uint64_t count) {
        if (2 * used_ >= entries_.size())
            grow();
        Entry& entry = find(texel);
        used_ += entry.count == 0;
        entry.texel = texel;
        entry.count += count;
    }
    // Of equals the smallest; count 0 if there are none.
    Entry most() const {
        return *std::ranges::max_element(entries_, [](const Entry& a, const Entry& b) {
            return std::pair(a.count, b.texel) < std::pair(b.count, a.texel);
        });
    }

private:
    Entry& find(std::uint64_t texel) {
        std::size_t at = (texel * 0x9E3779B97F4A7C15u) >> shift_;
        while (entries_[at].count != 0 && entries_[at].texel != texel)
            at = (at + 1) & (entries_.size() - 1);
        return entries_[at];
    }
    void grow() {
        std::vector<Entry> old(2 * entries_.size());
        old.swap(entries_);
        --shift_;
        for (const Entry& entry : old)
            if (entry.count != 0)
                find(entry.texel) = entry;
    }

    static constexpr int first_bits = 10;
    std::vector<Entry> entries_ = std::vector<Entry>(std::size_t{1} << first_bits);
    int shift_ = 64 - first_bits; // entries_ has 2^(64 - shift_)
    std::size_t used_ = 0;
};

// Adds how often each texel that matters is there.
void count_runs(const TileTexels& tile, std::size_t size, TexelCounts& counts) {
    const std::byte* const texels = tile.texels.data();
    const std::size_t count = tile.texels.size() / size;
    const bool all_matter = tile.matters.empty();
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
        end = begin + 1;
        if (!all_matter && tile.is_free(begin))
            continue;
        const std::byte* const first = texels + begin * size;
        // Long runs in strides.
        while (all_matter && end + stride <= count &&
               std::memcmp(texels + (end - 1) * size, texels + end * size, stride * size) == 0)
            end += stride;
        while (end < count && (all_matter || !tile.is_free(end)) &&
               std::memcmp(first, texels + end * size, size) == 0)
            ++end;
        std::uint64_t texel = 0;
        for (std::size_t i = 0; i < size; ++i)
            texel |= std::to_integer<std::uint64_t>(first[i]) << (8 * i);
        counts.add(texel, end - begin);
    }
}

} // namespace

std::array<std::uint16_t, 4> find_background(const Sample& sample, const TextureDesc& desc) {
    TexelCounts counts;
    const std::size_t size = desc.texel_bytes();
    for (const TileTexels& tile : sample.tiles)
        count_runs(tile, size, counts);
    const TexelCounts::Entry most = counts.most();
    std::array<std::uint16_t, 4> background{};
    const int bits = 8 * static_cast<int>(sample_bytes(desc.type));
    for (int c = 0; c < desc.channels && most.count > 0; ++c)
        background[static_cast<std::size_t>(c)] =
            static_cast<std::uint16_t>(most.texel >> (bits * c) & ((1u << bits) - 1));
    return background;
}

} // namespace tessera
