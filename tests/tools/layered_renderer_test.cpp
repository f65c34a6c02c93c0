#include "tools/view/layered_renderer.h"

#include "tests/support/memory_texture.h"
#include "tests/support/rendering.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

// Two squares of 2 x 2 units that face +z. The front one has the left half of the atlas, the one
// behind it the right half.
SurfaceMesh two_squares() {
    SurfaceMesh mesh;
    for (const float z : {0.0f, -1.0f})
        for (const auto& [x, y] : {std::pair{-1.f, -1.f}, {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}}) {
            mesh.positions.push_back({x, y, z});
            mesh.normals.push_back({0, 0, 1});
            mesh.uv.push_back({(x + 1) / 4 + (z == 0.0f ? 0.0f : 0.5f), (y + 1) / 2});
        }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    return mesh;
}

test::MemoryTexture picture(std::uint8_t channels, const std::function<double(int, int)>& value) {
    return {{{32, 16, 1, 1}, SampleType::unorm8, channels},
            [=](int u, int, int, int, int c) { return value(u, c); }};
}

glm::dvec3 seen_at(ViewRenderer& renderer, double x) {
    const View view = view_of(renderer, camera_at({{x, 0, 40}, {x, 0, 0}}, {1, 1, 1}));
    return {view.rgb[0], view.rgb[1], view.rgb[2]};
}

std::unique_ptr<ViewRenderer> renderer_of(std::span<const DrawnLayer> layers,
                                          const std::vector<DistantLight>& lights = {}) {
    RenderOptions options;
    options.threads = 1;
    auto made = make_layered_renderer(layers, lights, two_squares(), grey, options);
    EXPECT_TRUE(made.ok()) << made.status().message();
    return std::move(*made);
}

constexpr Extent4 tile{16, 16, 1, 1};

// Rays pass through what is not covered, to the surface behind it or to the background.
TEST(LayeredRenderer, RaysPassThroughHoles) {
    auto diffuse = picture(3, [](int u, int c) { return u < 16 ? (c == 0) : (c == 1); });
    auto coverage = picture(1, [](int u, int) { return u < 8 || u >= 24 ? 0.0 : 1.0; });
    const std::vector<DrawnLayer> layers{
        {LayerRole::diffuse, 1.0, &diffuse, tile, Transfer::srgb},
        {LayerRole::coverage, 1.0, &coverage, tile, Transfer::unspecified}};
    const auto renderer = renderer_of(layers);
    expect_near(seen_at(*renderer, 0.5), {1, 0, 0}, 1e-6);  // the front
    expect_near(seen_at(*renderer, -0.5), {0, 1, 0}, 1e-6); // through its hole
    // Behind the front's right half the other square has a hole, too, but it is hidden.
    auto nothing = picture(1, [](int, int) { return 0.0; });
    const std::vector<DrawnLayer> holes{
        {LayerRole::diffuse, 1.0, &diffuse, tile, Transfer::srgb},
        {LayerRole::coverage, 1.0, &nothing, tile, Transfer::unspecified}};
    expect_near(seen_at(*renderer_of(holes), 0.5), grey, 1e-6);
}

double displayed_value(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}
double linear_value(double x) {
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

// A quarter of the front's light, brighter than a display shows, and three quarters of what is behind:
// the other square, and through its half, the background.
TEST(LayeredRenderer, MixesLightBehindByOpacity) {
    auto diffuse = picture(3, [](int u, int c) { return u < 16 ? (c == 0) : (c == 1) * 0.5; });
    auto opacity = picture(1, [](int u, int) { return u < 16 ? 0.25 : u < 24 ? 1.0 : 0.5; });
    std::vector<DrawnLayer> layers{
        {LayerRole::diffuse, 2.0, &diffuse, tile, Transfer::unspecified},
        {LayerRole::opacity, 1.0, &opacity, tile, Transfer::unspecified}};
    const auto renderer = renderer_of(layers);
    const double o = 64 / 255.0, half = 128 / 255.0, back = 2 * half;
    expect_near(seen_at(*renderer, -0.5),
                {displayed_value(2 * o), displayed_value((1 - o) * std::min(back, 1.0)), 0}, 1e-6);
    const double far = (1 - o) * (1 - half) * linear_value(grey.x);
    expect_near(seen_at(*renderer, 0.5),
                {displayed_value(2 * o + far),
                 displayed_value((1 - o) * (half * back + (1 - half) * linear_value(grey.x))),
                 displayed_value(far)},
                1e-6);
    // Differences belong to the surface: they count before it is mixed.
    test::MemoryTexture shared(
        {{1, 1, 8, 8}, SampleType::unorm8, 3},
        [](int, int, int, int, int c) { return c == 2 ? 1.0 : 128 / 255.0; });
    layers.push_back(
        {LayerRole::shared_difference, 0.5, &shared, {1, 1, 8, 8}, Transfer::unspecified});
    const double own = o * linear_value(0.5), behind = std::min(back, 1.0);
    expect_near(seen_at(*renderer_of(layers), -0.5),
                {displayed_value(o), displayed_value((1 - o) * behind),
                 displayed_value(own + (1 - o) * linear_value(0.5))},
                1e-6);
}

// Light is added in linear values and shown as sRGB, with the scales of the layers.
TEST(LayeredRenderer, AddsLinearLight) {
    auto diffuse = picture(3, [](int, int) { return 0.5; });
    auto emission = picture(3, [](int, int) { return 0.25; });
    const std::vector<DrawnLayer> layers{
        {LayerRole::diffuse, 0.5, &diffuse, tile, Transfer::unspecified},
        {LayerRole::emission, 2.0, &emission, tile, Transfer::unspecified}};
    const double light = 0.5 * std::round(127.5) / 255 + 2.0 * std::round(63.75) / 255;
    expect_near(seen_at(*renderer_of(layers), 0.0),
                glm::dvec3(1.055 * std::pow(light, 1 / 2.4) - 0.055), 2e-3);
}

// A light that the visibility blocks gives nothing, and one that it does not, what Reflectance says.
TEST(LayeredRenderer, VisibilitySelectsLights) {
    const std::vector<DistantLight> lights{{{0, 0, 1}, 0.3f, {0.2f, 0, 0}},
                                           {{0, 0, 1}, 0.3f, {0, 0.2f, 0}}};
    auto diffuse = picture(3, [](int, int) { return 0.0; });
    auto specular = picture(3, [](int, int) { return 1.0; });
    test::MemoryTexture visibility({{32, 16, 2, 1}, SampleType::unorm8, 1},
                                   [](int, int, int s, int, int) { return s == 0 ? 1.0 : 0.0; });
    const std::vector<DrawnLayer> layers{
        {LayerRole::diffuse, 1.0, &diffuse, tile, Transfer::srgb},
        {LayerRole::specular, 1.0, &specular, tile, Transfer::srgb},
        {LayerRole::visibility, 1.0, &visibility, {16, 16, 2, 1}, Transfer::unspecified}};
    const glm::dvec3 seen = seen_at(*renderer_of(layers, lights), 0.0);
    Reflectance mirror;
    mirror.specular = glm::dvec3(1.0);
    const double light = mirror.of(lights[0]).x;
    EXPECT_NEAR(seen.x, 1.055 * std::pow(light, 1 / 2.4) - 0.055, 1e-3);
    EXPECT_EQ(seen.y, 0.0);
}

// The environment takes the place of lights with a spread, as far as they are not blocked. Its lobes
// follow the roughness.
TEST(LayeredRenderer, EnvironmentReplacesLightsWithSpread) {
    const std::vector<DistantLight> lights{{{0, 0, 1}, 0.3f, {0.2f, 0.2f, 0.2f}},
                                           {{0, 0, 1}, 0.0f, {0, 0.001f, 0}}};
    auto diffuse = picture(3, [](int, int) { return 0.0; });
    auto specular = picture(3, [](int, int) { return 1.0; });
    auto roughness = picture(1, [](int, int) { return 25.0 / 255.0; });
    test::MemoryTexture visibility({{32, 16, 2, 1}, SampleType::unorm8, 1},
                                   [](int, int, int s, int, int) { return s == 0 ? 0.6 : 1.0; });
    // The lobe for 25 / 255 is between the first and the second of four.
    test::MemoryTexture environment(
        {{4, 1, 8, 8}, SampleType::unorm8, 3},
        [](int u, int, int, int, int c) { return u <= 1 && c == 0 ? 0.4 : 0.0; });
    const std::vector<DrawnLayer> layers{
        {LayerRole::diffuse, 1.0, &diffuse, tile, Transfer::srgb},
        {LayerRole::specular, 1.0, &specular, tile, Transfer::srgb},
        {LayerRole::roughness, 1.0, &roughness, tile, Transfer::unspecified},
        {LayerRole::visibility, 1.0, &visibility, {16, 16, 2, 1}, Transfer::unspecified},
        {LayerRole::environment, 3.0, &environment, {4, 1, 8, 8}, Transfer::unspecified}};
    const glm::dvec3 seen = seen_at(*renderer_of(layers, lights), 0.0);
    Reflectance mirror;
    mirror.specular = glm::dvec3(1.0);
    mirror.roughness = 25.0 / 255.0;
    const auto displayed = [](double x) { return 1.055 * std::pow(x, 1 / 2.4) - 0.055; };
    const double share = 0.6 * mirror.of_reflection().x * 3.0 * 0.4 * 0.4;
    EXPECT_NEAR(seen.x, displayed(share), 2e-3);
    EXPECT_NEAR(seen.y, displayed(mirror.of(lights[1]).y), 2e-3);
    EXPECT_EQ(seen.z, 0.0);
}

// Differences change display values, not light, and add up.
TEST(LayeredRenderer, DifferencesChangeDisplayValues) {
    auto diffuse = picture(3, [](int, int) { return 0.5; });
    test::MemoryTexture difference({{2, 2, 4, 4}, SampleType::unorm8, 3},
                                   [](int, int, int, int, int c) { return c == 0 ? 1.0 : 0.25; });
    test::MemoryTexture shared({{1, 1, 8, 8}, SampleType::unorm8, 3},
                               [](int, int, int, int, int) { return 0.0; });
    const std::vector<DrawnLayer> layers{
        {LayerRole::diffuse, 1.0, &diffuse, tile, Transfer::srgb},
        {LayerRole::difference, 0.3, &difference, {2, 2, 4, 4}, Transfer::unspecified},
        {LayerRole::shared_difference, 0.1, &shared, {1, 1, 8, 8}, Transfer::unspecified}};
    const double half = std::round(127.5) / 255;
    const glm::dvec3 seen = seen_at(*renderer_of(layers), 0.0);
    EXPECT_NEAR(seen.x, half + 0.3 - 0.1, 1e-4);
    EXPECT_NEAR(seen.y, half + 0.3 * (std::round(63.75) - 128) / 127 - 0.1, 1e-4);
}

} // namespace
} // namespace tessera
