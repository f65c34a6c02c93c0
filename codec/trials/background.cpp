#include "codec/trials/background.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
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

// A tile's texels as numbers, the first byte lowest.
class TexelNumbers {
public:
    TexelNumbers(std::span<const std::byte> texels, std::size_t size)
        : texels_(texels), size_(size), mask_(~std::uint64_t{0} >> (64 - 8 * size)) {}

    std::uint64_t at(std::size_t texel) const {
        const std::byte* const from = texels_.data() + texel * size_;
        std::uint64_t number = 0;
        if (texel * size_ + sizeof number <= texels_.size()) {
            std::memcpy(&number, from, sizeof number);
            if constexpr (std::endian::native == std::endian::little)
                return number & mask_;
            number = 0;
        }
        for (std::size_t i = 0; i < size_; ++i)
            number |= std::to_integer<std::uint64_t>(from[i]) << (8 * i);
        return number;
    }
    // Whether `stride` texels from there on are all like the one before.
    bool goes_on(std::size_t texel) const {
        return std::memcmp(texels_.data() + (texel - 1) * size_, texels_.data() + texel * size_,
                           stride * size_) == 0;
    }

private:
    std::span<const std::byte> texels_;
    std::size_t size_;
    std::uint64_t mask_;
};

// Adds how often each texel that matters is there.
void count_runs(const TileTexels& tile, std::size_t size, TexelCounts& counts) {
    const TexelNumbers texels(tile.texels, size);
    const std::size_t count = tile.texels.size() / size;
    const bool all_matter = tile.matters.empty();
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
        end = begin + 1;
        if (!all_matter && tile.is_free(begin))
            continue;
        const std::uint64_t texel = texels.at(begin);
        const auto goes_on = [&] {
            return end < count && (all_matter || !tile.is_free(end)) && texels.at(end) == texel;
        };
        if (goes_on()) {
            // Long runs in strides.
            while (all_matter && end + stride <= count && texels.goes_on(end))
                end += stride;
            while (goes_on())
                ++end;
        }
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
