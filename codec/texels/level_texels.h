// Conversion between levels: means for a coarser, interpolation for a finer one (FORMAT.md 5.4).
#pragma once

#include "format/container/level_table.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// The texels of `fine` that the texels `box` of `coarse` cover. `coarse` is the level after `fine`.
Box4 covered_by(const Box4& box, const LevelEntry& coarse, const LevelEntry& fine);

// Means of one box of a coarse level, computed from boxes of the finer level.
class LevelMeans {
public:
    // Holds 8 bytes per sample of `box`.
    LevelMeans(const TextureDesc& desc, const LevelEntry& fine, const LevelEntry& coarse,
               const Box4& box);
    // Adds the part of `fine_box` that the coarse box covers. Each texel must be added exactly
    // once.
    void add(const Box4& fine_box, std::span<const std::byte> texels);
    // Writes the means, rounded to codes, ties upwards. `out` must have the size of the box.
    void finish(std::span<std::byte> out) const;

private:
    TextureDesc desc_;
    LevelEntry fine_, coarse_;
    Box4 box_;
    std::vector<std::int64_t> sums_; // of sample codes
};

// The texels of `coarse` that interpolating the texels `box` of `fine` needs.
Box4 support_of(const Box4& box, const LevelEntry& fine, const LevelEntry& coarse);

// Computes the texels `box` of `fine` by linear interpolation of codes along all four axes.
// `texels` holds the box `support`, which is support_of(box). Memory: 8 bytes per sample of `box`.
void interpolate_level(std::span<const std::byte> texels, const Box4& support, const Box4& box,
                       const LevelEntry& fine, const LevelEntry& coarse, const TextureDesc& desc,
                       std::span<std::byte> out);

} // namespace tessera
