// The means that form coarse levels, and interpolation between them.
#include "codec/decoder.h"
#include "codec/texels/level_texels.h"
#include "format/tile/colour_transform.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace test;

// The mean of the covered texels as FORMAT.md 5.4 defines it.
double mean_of(const MemoryTexture& texture, const LevelEntry& level, const Extent4& at, int c) {
    const TextureDesc& desc = texture.desc();
    double sum = 0, count = 0;
    Box4 box = covered_by(Box4::of_texel(at), level, LevelEntry{desc.size, 0, 0, 0});
    Bytes texels(desc.box_bytes(box));
    MemoryTexture copy = texture;
    EXPECT_TRUE(copy.read(box, texels).ok());
    const std::size_t bytes = sample_bytes(desc.type);
    for (std::size_t i = static_cast<std::size_t>(c) * bytes; i < texels.size();
         i += desc.texel_bytes(), ++count)
        sum += sample_code(load_sample(texels.data() + i, desc.type), desc.type);
    return sum / count;
}

TEST(LevelTexels, MeansMatchTheirDefinition) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        const TextureDesc desc{{21, 10, 5, 7}, type, 3};
        Random random(5);
        MemoryTexture texture(desc, [&](int, int, int, int, int) { return random.unit() - 0.3; });
        const LevelEntry level = coarse_level(desc.size, 2, 1, 0), full{desc.size, 0, 0, 0};
        const Box4 box{{1, 0, 1, 0}, level.size};
        LevelMeans means(desc, full, level, box);
        // The means are computed from pieces as large as tiles.
        const TileGrid grid(desc.size, {8, 4, 3, 2});
        for (std::uint64_t i = 0; i < grid.tiles(); ++i) {
            Bytes texels(desc.box_bytes(grid.box(i)));
            ASSERT_TRUE(texture.read(grid.box(i), texels).ok());
            means.add(grid.box(i), texels);
        }
        Bytes out(desc.box_bytes(box));
        means.finish(out);
        std::size_t at = 0;
        for (std::uint32_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::uint32_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::uint32_t t = box.begin[3]; t < box.end[3]; ++t)
                    for (std::uint32_t s = box.begin[2]; s < box.end[2]; ++s)
                        for (int c = 0; c < 3; ++c, at += sample_bytes(type))
                            ASSERT_NEAR(sample_code(load_sample(out.data() + at, type), type),
                                        mean_of(texture, level, {u, v, s, t}, c), 0.5 + 1e-9);
    }
}

TEST(LevelTexels, InterpolationGoesThroughCentresAndKeepsRamps) {
    const TextureDesc desc{{37, 18, 9, 8}, SampleType::half16, 1};
    const LevelEntry full{desc.size, 0, 0, 0}, level = coarse_level(desc.size, 2, 1, 0);
    // The level samples a ramp of codes at the centres that FORMAT.md 5.4 defines.
    const auto ramp = [](double u, double v, double s, double t) {
        return 1000 + 40 * u + 24 * v + 16 * s - 8 * t;
    };
    TextureDesc coarse = desc;
    coarse.size = level.size;
    Bytes texels(coarse.box_bytes(Box4::whole(level.size)));
    std::size_t at = 0;
    for (std::uint32_t v = 0; v < level.size[1]; ++v)
        for (std::uint32_t u = 0; u < level.size[0]; ++u)
            for (std::uint32_t t = 0; t < level.size[3]; ++t)
                for (std::uint32_t s = 0; s < level.size[2]; ++s, at += 2)
                    store_sample(texels.data() + at,
                                 static_cast<std::uint16_t>(
                                     ramp(4 * u + 1.5, 4 * v + 1.5, 2 * s + 0.5, 2 * t + 0.5)),
                                 desc.type);
    for (const Box4& box : {Box4::whole(desc.size), Box4{{5, 3, 2, 1}, {29, 17, 7, 8}},
                            Box4{{36, 17, 8, 7}, {37, 18, 9, 8}}}) {
        const Box4 support = support_of(box, full, level);
        ASSERT_TRUE(is_inside(support, level.size));
        Bytes part(coarse.box_bytes(support)), out(desc.box_bytes(box));
        copy_box(support, Box4::whole(level.size), texels, support, part, 2);
        interpolate_level(part, support, box, full, level, desc, out);
        const auto clamped = [](double x, double least, double most) {
            return std::clamp(x, least, most);
        };
        at = 0;
        for (std::uint32_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::uint32_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::uint32_t t = box.begin[3]; t < box.end[3]; ++t)
                    for (std::uint32_t s = box.begin[2]; s < box.end[2]; ++s, at += 2)
                        ASSERT_NEAR(load_sample(out.data() + at, desc.type),
                                    ramp(clamped(u, 1.5, 4.0 * (level.size[0] - 1) + 1.5),
                                         clamped(v, 1.5, 4.0 * (level.size[1] - 1) + 1.5),
                                         clamped(s, 0.5, 2.0 * (level.size[2] - 1) + 0.5),
                                         clamped(t, 0.5, 2.0 * (level.size[3] - 1) + 0.5)),
                                    1.0)
                            << u << " " << v << " " << s << " " << t;
    }
}

} // namespace
} // namespace tessera
