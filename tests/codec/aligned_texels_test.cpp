// The grid of tiles of a texture whose views are aligned.
#include "codec/texels/aligned_texels.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random_box.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

const TextureDesc small{{9, 7, 5, 4}, SampleType::unorm8, 1};

// A value that differs between neighbouring texels.
std::byte value_at(const Extent4& x) {
    return static_cast<std::byte>(x[0] + 9 * x[1] + 71 * x[2] + 113 * x[3]);
}

// Records the box of the last read.
class Watched final : public TexelSource {
public:
    const TextureDesc& desc() const override { return small; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(small, box, out.size()));
        last = box;
        std::size_t i = 0;
        Extent4 x;
        for (x[1] = box.begin[1]; x[1] < box.end[1]; ++x[1])
            for (x[0] = box.begin[0]; x[0] < box.end[0]; ++x[0])
                for (x[3] = box.begin[3]; x[3] < box.end[3]; ++x[3])
                    for (x[2] = box.begin[2]; x[2] < box.end[2]; ++x[2])
                        out[i++] = value_at(x);
        return {};
    }
    Box4 last;
};

// Each grid position holds the nearest texel of its view. The mask is set only where that texel
// lies at this very position. Reading a box of the grid reads only the bounding box of these
// texels.
TEST(AlignedTexels, AreTheNearestOfTheirViews) {
    Random random(3);
    for (const ViewAlignment alignment : {ViewAlignment{2, -1}, ViewAlignment{-3, 2},
                                          ViewAlignment{0, 5}, ViewAlignment{127, -128}}) {
        const AlignedViews views(small.size, alignment);
        Watched source;
        const auto texels = texels_in_grid(source, views), mask = mask_of_grid(nullptr, views);
        EXPECT_EQ(texels->desc().size, views.grid_size());
        for (int round = 0; round < 40; ++round) {
            Box4 box = random_box(random, views.grid_size());
            for (std::size_t a = 0; a < 4; ++a)
                box.end[a] = std::min(box.end[a], box.begin[a] + 12);
            Bytes got(box.texels()), matters(got.size());
            ASSERT_TRUE(texels->read(box, got));
            ASSERT_TRUE(mask->read(box, matters));
            Box4 needed{small.size, {0, 0, 0, 0}};
            std::size_t i = 0;
            Extent4 x;
            for (x[1] = box.begin[1]; x[1] < box.end[1]; ++x[1])
                for (x[0] = box.begin[0]; x[0] < box.end[0]; ++x[0])
                    for (x[3] = box.begin[3]; x[3] < box.end[3]; ++x[3])
                        for (x[2] = box.begin[2]; x[2] < box.end[2]; ++x[2], ++i) {
                            Extent4 texel = x;
                            for (const int axis : {0, 1}) {
                                const auto a = static_cast<std::size_t>(axis);
                                const std::uint32_t shift =
                                    axis == 0 ? views.shift_u(x[2]) : views.shift_v(x[3]);
                                const int place = static_cast<int>(x[a]) - static_cast<int>(shift);
                                texel[a] = static_cast<std::uint32_t>(
                                    std::clamp(place, 0, static_cast<int>(small.size[a]) - 1));
                            }
                            EXPECT_EQ(got[i], value_at(texel));
                            EXPECT_EQ(matters[i] != std::byte{0}, views.place(texel) == x);
                            for (std::size_t a = 0; a < 4; ++a) {
                                needed.begin[a] = std::min(needed.begin[a], texel[a]);
                                needed.end[a] = std::max(needed.end[a], texel[a] + 1);
                            }
                        }
            EXPECT_EQ(source.last, needed) << to_string(source.last) << " " << to_string(needed);
        }
    }
}

} // namespace
} // namespace tessera::test
