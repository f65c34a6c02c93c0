// The rates of layers that are encoded together.
#include "tools/verbs/encode_layers.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace tessera;

// A square with a colour that varies, and differences of a third of it.
corpus::ModelLayers fitted_square() {
    SurfaceMesh square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    corpus::ModelLayers layers;
    const auto mesh = encode_mesh(square, {});
    EXPECT_TRUE(mesh.ok());
    layers.mesh = *mesh;
    const auto add = [&](LayerRole role, const Extent4& size, double scale) {
        corpus::LayerTexture layer = corpus::make_layer(role, size, 3);
        for (std::size_t i = 0; i < texel_count(size); ++i) {
            const double x = static_cast<double>(i);
            corpus::store_values(layer, i,
                                 {0.5 + 0.4 * std::sin(0.37 * x), 0.5 + 0.3 * std::sin(0.011 * x),
                                  0.5 + 0.4 * std::cos(1.9 * x)});
        }
        layer.scale = scale;
        layer.tile = {32, 32, std::min(size[2], 8u), std::min(size[3], 8u)};
        layers.layers.push_back(std::move(layer));
    };
    add(LayerRole::diffuse, {32, 32, 1, 1}, 1.0);
    add(LayerRole::shared_difference, {1, 1, 8, 8}, 0.3);
    return layers;
}

EncodeOptions quick(const corpus::ModelLayers& layers) {
    EncodeOptions options;
    options.mesh = layers.mesh;
    options.effort = 1;
    options.threads = 1;
    return options;
}

CodedLayers coded_at(const LayerRate& rate) {
    const corpus::ModelLayers layers = fitted_square();
    auto coded = encode_layers(layers, quick(layers), rate);
    EXPECT_TRUE(coded.ok()) << coded.status().message();
    for (CodedLayer& layer : coded->layers)
        layer.texture = nullptr; // `layers` ends here
    return std::move(*coded);
}

TEST(EncodeLayers, ReachesAPsnrOfTheirSumWithFewBytes) {
    const CodedLayers coded = coded_at({.least_psnr = 40});
    EXPECT_GE(coded.sum_psnr, 40.0);
    EXPECT_LT(coded.sum_psnr, 41.0);
    // A sample of the second layer changes the sum by 0.3 * 255 / 127 of itself.
    const double first = std::pow(10.0, -coded.layers[0].psnr / 10);
    const double second = std::pow(0.3 * 255 / 127, 2) * std::pow(10.0, -coded.layers[1].psnr / 10);
    EXPECT_NEAR(coded.sum_psnr, -10 * std::log10(first + second), 1e-6);
    EXPECT_LT(coded.file.size(), coded_at({.least_psnr = 46}).file.size());
    const corpus::ModelLayers layers = fitted_square();
    const auto missed = encode_layers(layers, quick(layers), {.least_psnr = 80});
    if (missed.ok()) // lossless layers are smaller than those of the best quality
        EXPECT_EQ(missed->sum_psnr, lossless_psnr);
    else
        EXPECT_EQ(missed.status().code(), ErrorCode::target_missed);
    EncodeOptions fallback = quick(layers);
    fallback.lossless_fallback = true;
    const auto lossless = encode_layers(layers, fallback, {.least_psnr = 80});
    ASSERT_TRUE(lossless.ok());
    EXPECT_EQ(lossless->sum_psnr, lossless_psnr);
}

TEST(EncodeLayers, KeepsToBitsAndErrors) {
    const double texels = 32 * 32 + 8 * 8;
    const CodedLayers coded = coded_at({.most_bits = 16});
    EXPECT_LE(8.0 * static_cast<double>(coded.file.size()), 16 * texels);
    EXPECT_GE(8.0 * static_cast<double>(coded.file.size()), 0.98 * 16 * texels);
    EXPECT_EQ(coded.file, coded_at({.most_bytes = std::uint64_t(2 * texels)}).file);
    EXPECT_EQ(rate_text(coded_at({.most_error = 0})), "lossless");
    const CodedLayers near = coded_at({.most_error = 3});
    EXPECT_FALSE(near.quality.has_value());
    EXPECT_GT(near.layers[0].psnr, 20 * std::log10(255.0 / 3));
    const corpus::ModelLayers layers = fitted_square();
    const Status small = encode_layers(layers, quick(layers), {.most_bits = 0.1}).status();
    EXPECT_NE(small.message().find("--target-bpt 0.1"), std::string::npos) << small.message();
}

} // namespace
