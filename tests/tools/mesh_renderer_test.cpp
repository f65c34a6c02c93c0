#include "tools/view/mesh_renderer.h"

#include "corpus/trace/ray_scene.h"
#include "tests/support/memory_texture.h"
#include "tests/support/rendering.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

// A square of 2 x 2 units in z = 0, seen from +z. u grows with x and v with y.
SurfaceMesh square() {
    SurfaceMesh mesh;
    for (const auto& [x, y] : {std::pair{-1.f, -1.f}, {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}}) {
        mesh.positions.push_back({x, y, 0});
        mesh.normals.push_back({0, 0, 1});
        mesh.uv.push_back({(x + 1) / 2, (y + 1) / 2});
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(MeshRays, HitFrontsAndPassThroughBacks) {
    const SurfaceMesh mesh = square();
    const auto made = corpus::RayScene::make(mesh.positions, mesh.triangles, true);
    ASSERT_TRUE(made.ok()) << made.status().message();
    const auto tangents = mesh_tangents(mesh);
    for (const glm::dvec2& at : {glm::dvec2(0, 0), glm::dvec2(-0.9, 0.3), glm::dvec2(0.5, -0.7)}) {
        const auto hit = made->first_hit({at.x, at.y, 4}, {0, 0, -1});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->distance, 4, 1e-6);
        const SurfacePoint p = surface_point(mesh, tangents, hit->triangle, hit->barycentric);
        expect_near(p.position, {at.x, at.y, 0}, 1e-6);
        EXPECT_NEAR(p.uv.x, (at.x + 1) / 2, 1e-6);
        EXPECT_FALSE(made->first_hit({at.x, at.y, -4}, {0, 0, 1})) << "hit from behind";
    }
    EXPECT_FALSE(made->first_hit({1.01, 0, 4}, {0, 0, -1}));
    EXPECT_FALSE(made->first_hit({0, 0, 4}, {0, 0, 1})) << "hit by a ray that leads away";
}

// Each position and direction of the texture has its own colour.
TEST(MeshRenderer, ShowsTheFootprintOfEveryPixel) {
    test::MemoryTexture texture({{8, 8, 6, 6}, SampleType::unorm8, 3},
                                [](int u, int v, int s, int t, int c) {
                                    return c == 0 ? u / 8.0 : c == 1 ? v / 8.0 : (s + 2 * t) / 16.0;
                                });
    for (const AngularMap map :
         {AngularMap::octahedral_hemisphere, AngularMap::octahedral_mirrored}) {
        const SurfaceMesh mesh = square();
        RenderOptions options;
        options.threads = 2;
        auto renderer = make_mesh_renderer(texture, {4, 4, 3, 3}, {mesh, map}, grey, options);
        ASSERT_TRUE(renderer.ok()) << renderer.status().message();
        const Camera camera = camera_at({{1, 0.5, 3}, {0, 0, 0}}, {45, 24, 18});
        const View view = view_of(**renderer, camera);
        unsigned on_it = 0;
        for (std::uint32_t j = 0; j < 18; ++j)
            for (std::uint32_t i = 0; i < 24; ++i) {
                const float* rgb = view.rgb.data() + (std::size_t{j} * 24 + i) * 3;
                const glm::dvec3 seen{rgb[0], rgb[1], rgb[2]};
                const glm::dvec3 d = camera.direction(i + 0.5, j + 0.5);
                const glm::dvec3 at = camera.eye - d * (camera.eye.z / d.z);
                if (std::abs(at.x) > 1 || std::abs(at.y) > 1) {
                    expect_near(seen, grey, 1e-6);
                    continue;
                }
                ++on_it;
                const SurfaceFrame frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
                glm::dvec3 expected{0.0};
                for (const WeightedTexel& tap :
                     mesh_footprint(texture.desc().size, map, {(at.x + 1) / 2, (at.y + 1) / 2},
                                    octahedral_place(map, frame, -d)))
                    expected +=
                        tap.weight *
                        glm::dvec3(std::round(255 * tap.u / 8.0), std::round(255 * tap.v / 8.0),
                                   std::round(255 * (tap.s + 2 * tap.t) / 16.0)) /
                        255.0;
                expect_near(seen, expected, 1e-4);
            }
        EXPECT_GT(on_it, 60u);
    }
}

TEST(MeshRenderer, SeveralRaysSmoothEdges) {
    test::MemoryTexture texture({{1, 1, 1, 1}, SampleType::unorm8, 1},
                                [](int, int, int, int, int) { return 1.0; });
    RenderOptions options;
    options.rays = 16;
    auto renderer =
        make_mesh_renderer(texture, {1, 1, 1, 1}, {square(), AngularMap::octahedral_hemisphere},
                           glm::dvec3(0), options);
    ASSERT_TRUE(renderer.ok());
    const View view = view_of(**renderer, camera_at({{0, 0, 3.3}, {0, 0, 0}}, {45, 25, 25}));
    unsigned between = 0;
    for (const float value : view.rgb)
        between += value > 0.05f && value < 0.95f;
    EXPECT_GT(between, 3 * 40u);
}

} // namespace
} // namespace tessera
