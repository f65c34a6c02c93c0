// Texels between levels: means of many for a coarser one, interpolation for a finer one
// (FORMAT.md 5.4).
#pragma once

#include "format/container/level_table.h"
#include "format/texture.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Texels of `fine` that the texels `box` of `coarse` stand for. Precondition: `coarse` follows `fine`
// in a level table.
Box4 covered_by(const Box4& box, const LevelEntry& coarse, const LevelEntry& fine);

// Sums over the texels of one box of a coarse level, fed with boxes of the finer one.
class LevelMeans {
public:
    // Holds 8 bytes a sample of `box`.
    LevelMeans(const TextureDesc& desc, const LevelEntry& fine, const LevelEntry& coarse,
               const Box4& box);
    // Adds the part of `fine_box` that the box stands for; every texel must be added once.
    void add(const Box4& fine_box, std::span<const std::byte> texels);
    // The means, rounded to codes, ties upwards. Precondition: `out` has the bytes of the box.
    void finish(std::span<std::byte> out) const;

private:
    TextureDesc desc_;
    LevelEntry fine_, coarse_;
    Box4 box_;
    std::vector<std::int64_t> sums_; // of sample codes
};

// Texels of `coarse` between which the texels `box` of `fine` lie.
Box4 support_of(const Box4& box, const LevelEntry& fine, const LevelEntry& coarse);

// Texels `box` of `fine` by linear interpolation of codes along all four axes. `texels` are those of
// `support`, which is support_of(box). Pure. Memory: 8 bytes a sample of `box`.
void interpolate_level(std::span<const std::byte> texels, const Box4& support, const Box4& box,
                       const LevelEntry& fine, const LevelEntry& coarse, const TextureDesc& desc,
                       std::span<std::byte> out);

} // namespace tessera
