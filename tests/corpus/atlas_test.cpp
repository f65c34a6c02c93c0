// Tests where charts lie in the atlas and that their gutters belong to them.
#include "corpus/surface/texel_places.h"
#include "tests/support/baked_surfaces.h"

#include <algorithm>

namespace tessera::corpus {
namespace {

using namespace support;

TEST(Atlas, ChartsBeginAtTilesAndDoNotOverlap) {
    for (const SceneInfo& info : scenes()) {
        const Texels2 tile{32, 16};
        const SceneSurface surface = surface_of(surfaces_of(info.name), 8, tile);
        std::vector<int> owners(surface.size[0] / tile[0] * (surface.size[1] / tile[1]), 0);
        for (const Chart& chart : surface.charts) {
            Texels2 end{};
            for (std::size_t a = 0; a < 2; ++a) {
                EXPECT_EQ(chart.begin[a] % tile[a], 0u) << info.name;
                EXPECT_EQ(surface.size[a] % tile[a], 0u) << info.name;
                EXPECT_GT(chart.extent[a], 2 * gutter) << info.name;
                end[a] = chart.begin[a] + chart.extent[a];
                ASSERT_LE(end[a], surface.size[a]) << info.name;
            }
            for (std::uint32_t y = chart.begin[1] / tile[1]; y * tile[1] < end[1]; ++y)
                for (std::uint32_t x = chart.begin[0] / tile[0]; x * tile[0] < end[0]; ++x)
                    EXPECT_EQ(owners[y * (surface.size[0] / tile[0]) + x]++, 0) << info.name;
        }
    }
}

// The four taps around every corner and around random positions show the chart of that position.
TEST(Atlas, EveryTapHasATriangleOfItsChart) {
    const Scene scene = surfaces_of("composed");
    const SceneSurface surface = surface_of(scene, 8);
    const auto lit = lit_surface(scene, surface);
    const auto mesh = decode_mesh(*encode_mesh(surface.mesh, MeshQuantisation{}), 1u << 28);
    for (const auto& triangle : mesh->triangles)
        for (int i = 0; i <= 6; ++i)
            for (int j = 0; i + j <= 6; ++j) {
                const float p = static_cast<float>(i) / 6, q = static_cast<float>(j) / 6;
                const glm::vec2 uv = mesh->uv[triangle[0]] * (1 - p - q) +
                                     mesh->uv[triangle[1]] * p + mesh->uv[triangle[2]] * q;
                const double x = uv.x * surface.size[0], y = uv.y * surface.size[1];
                for (int tap = 0; tap < 4; ++tap) {
                    const auto u = static_cast<std::uint32_t>(x - 0.5 + tap % 2);
                    const auto v = static_cast<std::uint32_t>(y - 0.5 + tap / 2);
                    ASSERT_TRUE(lit->places().matters(u, v)) << x << ' ' << y;
                    EXPECT_TRUE(lit->chart_at(u, v).contains({x, y})) << x << ' ' << y;
                }
            }
}

TEST(Atlas, NearAndFarHaveTheirDensity) {
    Scene scene;
    scene.objects = {plane({0, -4, 0}, 8, 8, {}), plane({0, -1, 0}, 8, 8, {}),
                     plane({0, -1, 0}, 8, 8, {})};
    scene.objects[2].material.mirror = 1;
    const SceneSurface surface = surface_of(scene, 32);
    const auto width = [&](std::size_t i) { return surface.charts[i].extent[0]; };
    EXPECT_NEAR(width(0), 8 * 32 * 10 / 14.0 + 2, 9);
    EXPECT_NEAR(width(1), 8 * 32 * 10 / 11.0 + 2, 9);
    EXPECT_LT(width(2), width(1) / 2);
}

TEST(Atlas, RefusesOptionsAndScenesWithoutAnAtlas) {
    const Scene scene = surfaces_of("composed");
    SurfaceOptions options;
    options.atlas.density = 0;
    EXPECT_EQ(make_scene_surface(scene, options).status().code(), ErrorCode::bad_argument);
    options.atlas.density = 1e9;
    EXPECT_EQ(make_scene_surface(scene, options).status().code(), ErrorCode::unsupported);
    options = {};
    options.atlas.tile = {2, 32};
    EXPECT_EQ(make_scene_surface(scene, options).status().code(), ErrorCode::bad_argument);
    Scene endless;
    endless.objects = {plane({0, 0, 0}, std::numeric_limits<double>::infinity(), 1, {})};
    EXPECT_EQ(make_scene_surface(endless, {}).status().code(), ErrorCode::unsupported);
    EXPECT_EQ(make_scene_surface(Scene{}, {}).status().code(), ErrorCode::unsupported);
}

} // namespace
} // namespace tessera::corpus
