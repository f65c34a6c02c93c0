#include "codec/trials/background.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace tessera {
namespace {

// Counts texels in an open hash table: noise has as many different ones as there are texels, and a
// node of memory for each would take longer than the trials of a quick effort.
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
    // The most frequent texel, the smallest of equals; count 0 if there is none.
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
    int shift_ = 64 - first_bits; // there are 2^(64 - shift_) entries
    std::size_t used_ = 0;
};

// A texel as a number, its first byte lowest on every machine.
std::uint64_t number_of(const std::byte* texel, std::size_t size) {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < size; ++i)
        number |= std::to_integer<std::uint64_t>(texel[i]) << (8 * i);
    return number;
}

// Adds the texels that matter, run by run.
void count_texels(const TileTexels& tile, std::size_t size, TexelCounts& counts) {
    const std::span<const std::byte> texels = tile.texels;
    const std::size_t count = texels.size() / size;
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
        end = begin + 1;
        if (tile.is_free(begin))
            continue;
        const auto from = texels.subspan(begin * size), next = from.subspan(size);
        const auto same =
            std::mismatch(next.begin(), next.end(), from.begin()).first - next.begin();
        end += static_cast<std::size_t>(same) / size;
        if (!tile.matters.empty())
            end = static_cast<std::size_t>(
                std::find(tile.matters.begin() + begin, tile.matters.begin() + end, std::byte{0}) -
                tile.matters.begin());
        counts.add(number_of(from.data(), size), end - begin);
    }
}

} // namespace

std::array<std::uint16_t, 4> find_background(const Sample& sample, const TextureDesc& desc) {
    TexelCounts counts;
    for (const TileTexels& tile : sample.tiles)
        count_texels(tile, desc.texel_bytes(), counts);
    const TexelCounts::Entry most = counts.most();
    std::array<std::uint16_t, 4> background{};
    const int bits = 8 * static_cast<int>(sample_bytes(desc.type));
    for (int c = 0; c < desc.channels && most.count > 0; ++c)
        background[c] = static_cast<std::uint16_t>(most.texel >> (bits * c) & ((1u << bits) - 1));
    return background;
}

} // namespace tessera
