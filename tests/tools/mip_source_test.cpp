#include "tools/view/mip_source.h"

#include "tests/support/memory_texture.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

double noise(int u, int v, int s, int t, int c) {
    const unsigned hash =
        static_cast<unsigned>((((u * 31 + v) * 37 + s) * 41 + t * 43 + c) * 2654435761u);
    return (hash >> 24) / 255.0;
}

double value_at(const TextureDesc& desc, const Bytes& texels, const Extent4& at, std::size_t c) {
    const Extent4& n = desc.size;
    const std::size_t texel = ((std::size_t{at[1]} * n[0] + at[0]) * n[3] + at[3]) * n[2] + at[2];
    return texel_value(desc, texels.data() + texel * desc.texel_bytes())[static_cast<int>(c)];
}

TEST(MipSource, HoldsMeansOfOneChart) {
    const TileGrid grid({48, 32, 3, 2}, {16, 16, 3, 2});
    const AtlasMips mips(six_charts(1, false), grid);
    ASSERT_EQ(mips.count(), 4u);
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        MemoryTexture texture({grid.size(), type, 2}, noise);
        const auto source = make_mip_source(texture, mips, 16);
        const TextureDesc& desc = source->desc();
        ASSERT_EQ(desc.size, mips.kept_size());
        Bytes texels(desc.box_bytes(Box4::whole(desc.size)));
        ASSERT_TRUE(source->read(Box4::whole(desc.size), texels));
        // The mean covers only texels of one chart, also where charts meet.
        for (unsigned mip = 0; mip <= 4; ++mip)
            for (std::uint32_t y = 0; y < mips.size(mip)[1]; ++y)
                for (std::uint32_t x = 0; x < mips.size(mip)[0]; ++x) {
                    const std::uint32_t own = mips.charts(mip)[y * mips.size(mip)[0] + x];
                    if (own == 0)
                        continue;
                    double sum = 0, count = 0;
                    for (std::uint32_t v = y << mip; v < (y + 1) << mip; ++v)
                        for (std::uint32_t u = x << mip; u < (x + 1) << mip; ++u)
                            if (mips.charts(0)[v * 48 + u] == own) {
                                sum += value_at(texture.desc(), texture.texels, {u, v, 2, 1}, 1);
                                ++count;
                            }
                    const Extent4 at{mips.begin(mip)[0] + x, mips.begin(mip)[1] + y, 2, 1};
                    ASSERT_NEAR(value_at(desc, texels, at, 1), sum / count,
                                type == SampleType::unorm8 ? 0.50001 / 255 : 1.0 / 4096)
                        << mip << ": " << x << ", " << y;
                }
        auto random = Random(5);
        for (int i = 0; i < 40; ++i) {
            Box4 box;
            for (std::size_t a = 0; a < 4; ++a) {
                box.begin[a] = static_cast<std::uint32_t>(random() % desc.size[a]);
                box.end[a] = box.begin[a] + 1 +
                             static_cast<std::uint32_t>(random() % (desc.size[a] - box.begin[a]));
            }
            Bytes part(desc.box_bytes(box)), expected(part.size());
            ASSERT_TRUE(source->read(box, part));
            copy_box(box, Box4::whole(desc.size), texels, box, expected, desc.texel_bytes());
            ASSERT_TRUE(part == expected);
        }
    }
}

} // namespace
} // namespace tessera
