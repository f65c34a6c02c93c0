#include "tools/gltf/mean_picture.h"

#include "tests/support/memory_texture.h"
#include "tests/support/rendering.h"
#include "tools/view/mesh_renderer.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

// A right-angled triangle in z = 0 that covers the half of the atlas above its diagonal.
SurfaceMesh half_square() {
    SurfaceMesh mesh;
    for (const auto& [x, y] : {std::pair{0.f, 0.f}, {1.f, 0.f}, {0.f, 1.f}}) {
        mesh.positions.push_back({x, y, 0});
        mesh.normals.push_back({0, 0, 1});
        mesh.uv.push_back({x, y});
    }
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TEST(MeanPicture, ViewsSurroundTheNormalByTheCosine) {
    const SurfaceFrame frame{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& view : mean_views(frame)) {
        EXPECT_NEAR(glm::length(view), 1.0, 1e-12);
        EXPECT_GT(glm::dot(view, frame.ez), 0.0);
        sum += view;
    }
    // The mean cosine of such a distribution is 2/3.
    expect_near(sum / static_cast<double>(mean_view_count), {0, 2.0 / 3.0, 0}, 0.04);
}

TEST(MeanPicture, IsTheMeanOverDirectionsAndContinuesBeyondTheSurface) {
    constexpr std::uint32_t side = 8;
    // Red is that of the place, green depends on the direction, blue is 1 off the surface.
    test::MemoryTexture texture(
        {{side, side, 4, 4}, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
            return c == 0 ? (u + v) / 16.0 : c == 1 ? (s + t) / 6.0 : u + v > 8 ? 1.0 : 0.0;
        });
    const SurfaceMesh mesh = half_square();
    RenderOptions options;
    auto renderer = make_mesh_renderer(texture, {side, side, 4, 4},
                                       {mesh, AngularMap::octahedral_hemisphere}, grey, options);
    ASSERT_TRUE(renderer.ok());
    options.threads = 3;
    const auto picture =
        draw_mean_picture(**renderer, mesh, SampleType::unorm8, {side, side}, options);
    ASSERT_TRUE(picture.ok()) << picture.status().message();
    EXPECT_FALSE(picture->has_alpha);
    ASSERT_EQ(picture->pixels.size(), side * side * 3u);
    const auto at = [&](std::uint32_t u, std::uint32_t v, std::uint32_t c) {
        return static_cast<int>(picture->pixels[(std::size_t{v} * side + u) * 3 + c]);
    };
    for (std::uint32_t v = 0; v < side; ++v)
        for (std::uint32_t u = 0; u + v < side - 1; ++u) {
            EXPECT_NEAR(at(u, v, 0), (u + v) / 16.0 * 255.0, 1.0);
            EXPECT_NEAR(at(u, v, 1), 127.5, 3.0) << "the map is symmetric";
            EXPECT_EQ(at(u, v, 2), 0);
        }
    EXPECT_EQ(at(7, 7, 2), 0) << "pixels off the surface continue its colours";
    EXPECT_GT(at(7, 7, 0), 60);
    EXPECT_EQ(draw_mean_picture(**renderer, mesh, SampleType::unorm8, {side, side}, {})->pixels,
              picture->pixels);
}

TEST(MeanPicture, NeedsAMesh) {
    test::MemoryTexture texture({{4, 4, 2, 2}, SampleType::unorm8, 3},
                                [](int, int, int, int, int) { return 1.0; });
    const auto sphere = make_texture_renderer(texture, {4, 4, 2, 2}, {}, grey, {});
    const std::vector<SurfacePoint> points(1);
    EXPECT_EQ(sphere->mean_values(points, glm::dvec2(0.1)).status().code(), ErrorCode::unsupported);
}

} // namespace
} // namespace tessera
