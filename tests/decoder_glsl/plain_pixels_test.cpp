// Tests the layout of texels in an ordinary texture, without a GPU.
#include "decoder_glsl/batch/plain_pixels.h"

#include <gtest/gtest.h>
#include <vector>

namespace tessera {
namespace {

TEST(PlainPixels, LayersPartitionTheTexture) {
    TexelPlan plan;
    plan.fold_u = 3;
    plan.fold_v = 2;
    plan.folds_u = 3;
    const Extent4 size{8, 3, 4, 5}; // 3 x 2 layers, the last ones partly filled
    std::uint64_t texels = 0;
    for (std::uint32_t layer = 0; layer < 6; ++layer) {
        const Box4 box = box_of_layer(plan, size, layer);
        EXPECT_TRUE(is_inside(box, size)) << layer;
        texels += box.texels();
    }
    EXPECT_EQ(texels, texel_count(size));
    EXPECT_EQ(box_of_layer(plan, size, 5), (Box4{{6, 2, 0, 0}, {8, 3, 4, 5}}));
}

// The pixels of a box of 2 x 2 angular images of 2 x 1, in rows of 5 pixels.
std::vector<int> pixels_of(const TextureDesc& desc) {
    const Box4 box{{2, 4, 0, 0}, {4, 6, 2, 1}};
    std::vector<std::byte> texels(desc.box_bytes(box));
    for (std::size_t i = 0; i < texels.size(); ++i)
        texels[i] = std::byte(i + 1);
    std::vector<std::byte> pixels(2 * 5 * 4 * sample_bytes(desc.type), std::byte{200});
    put_pixels(desc, box, texels, 5, pixels);
    std::vector<int> numbers;
    for (const std::byte b : pixels)
        numbers.push_back(std::to_integer<int>(b));
    return numbers;
}

TEST(PlainPixels, AngularImagesAreSideBySide) {
    const auto pixels = pixels_of({{4, 6, 2, 1}, SampleType::unorm8, 1});
    std::vector<int> expected;
    for (const int grey : {1, 2, 3, 4, 0, 5, 6, 7, 8, 0})
        expected.insert(expected.end(), {grey ? grey : 200, grey ? grey : 200, grey ? grey : 200,
                                         grey ? 255 : 200});
    EXPECT_EQ(pixels, expected);
}

TEST(PlainPixels, EveryPixelHasFourChannelsOfTheSameType) {
    const auto first = [](std::uint8_t channels, SampleType type) {
        auto pixels = pixels_of({{4, 6, 2, 1}, type, channels});
        pixels.resize(4 * sample_bytes(type));
        return pixels;
    };
    EXPECT_EQ(first(2, SampleType::unorm8), (std::vector{1, 1, 1, 2}));
    EXPECT_EQ(first(3, SampleType::unorm8), (std::vector{1, 2, 3, 255}));
    EXPECT_EQ(first(4, SampleType::unorm8), (std::vector{1, 2, 3, 4}));
    EXPECT_EQ(first(1, SampleType::half16), (std::vector{1, 2, 1, 2, 1, 2, 0x00, 0x3C}));
    EXPECT_EQ(first(3, SampleType::half16), (std::vector{1, 2, 3, 4, 5, 6, 0x00, 0x3C}));
}

} // namespace
} // namespace tessera
