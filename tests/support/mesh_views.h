// A mesh to draw, cameras for it, and comparisons of its pictures by different renderers.
#pragma once

#include "corpus/trace/ray_scene.h"
#include "format/surface_mesh.h"
#include "tests/support/meshes.h"
#include "tools/view/camera.h"
#include "tools/view/view_renderer.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tessera::test {

inline const glm::dvec3 backdrop_grey{0.5};

inline void append_mesh(SurfaceMesh& to, const SurfaceMesh& from) {
    const auto base = static_cast<std::uint32_t>(to.positions.size());
    const auto append = [](auto& values, const auto& more) {
        values.insert(values.end(), more.begin(), more.end());
    };
    append(to.positions, from.positions);
    append(to.normals, from.normals);
    append(to.uv, from.uv);
    for (const auto& [a, b, c] : from.triangles)
        to.triangles.push_back({a + base, b + base, c + base});
}

// A box and a ball that partly hide each other. Both have the same texture.
inline SurfaceMesh box_and_ball() {
    SurfaceMesh mesh = six_charts(1, false), ball = six_charts(2, true);
    for (glm::vec3& position : ball.positions)
        position = position * 1.5f + glm::vec3(2.4f, 0.3f, -0.5f);
    append_mesh(mesh, ball);
    return mesh;
}

inline std::vector<std::byte> stream_of(const SurfaceMesh& mesh) {
    auto stream = encode_mesh(mesh, MeshQuantisation{});
    EXPECT_TRUE(stream.ok()) << stream.status().message();
    return stream.ok() ? std::move(*stream) : std::vector<std::byte>{};
}

// The mesh as viewers decode it.
inline SurfaceMesh decoded(const std::vector<std::byte>& stream) {
    auto mesh = decode_mesh(stream, 1u << 28);
    EXPECT_TRUE(mesh.ok()) << mesh.status().message();
    return mesh.ok() ? std::move(*mesh) : SurfaceMesh{};
}

inline Camera camera_at(const glm::dvec3& eye, const glm::dvec3& look, double fov = 50) {
    auto camera = make_camera({eye, look}, {fov, 96, 72});
    EXPECT_TRUE(camera.ok()) << camera.status().message();
    return *camera;
}

inline View mesh_view_of(ViewRenderer& renderer, const Camera& camera) {
    auto view = renderer.render(camera);
    EXPECT_TRUE(view.ok()) << view.status().message();
    return view.ok() ? std::move(*view) : View{};
}

// What a pixel shows: the number of a triangle, or one of these values.
inline constexpr int several = -1, nothing = -2;
inline std::vector<int> triangles_seen(const SurfaceMesh& mesh, const Camera& camera) {
    const auto fronts = corpus::RayScene::make(mesh.positions, mesh.triangles, true);
    EXPECT_TRUE(fronts.ok());
    const auto seen = [&](double x, double y) {
        const auto hit = fronts->first_hit(camera.eye, camera.direction(x, y));
        return hit ? static_cast<int>(hit->triangle) : nothing;
    };
    std::vector<int> all;
    for (std::uint32_t j = 0; j < camera.height; ++j)
        for (std::uint32_t i = 0; i < camera.width; ++i) {
            int one = seen(i + 0.5, j + 0.5);
            for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
                one = seen(i + x, j + y) == one ? one : several;
            all.push_back(one);
        }
    return all;
}

// Counts of the pixels that show one triangle or nothing, and of those that differ.
struct Likeness {
    std::size_t whole = 0, empty = 0, wrong = 0;
};
inline Likeness likeness(const View& a, const View& b, const std::vector<int>& seen) {
    // One step of 8 bits, the weights of filtering hardware, and the rounding of half floats.
    constexpr double tolerance = 1.0 / 255 + 2.0 / 512 + 1.0 / 2048;
    Likeness l;
    EXPECT_EQ(a.rgb.size(), b.rgb.size());
    for (std::size_t i = 0; i < seen.size() && a.rgb.size() == b.rgb.size(); ++i) {
        double worst = 0;
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
            worst = std::max(worst, std::abs(double{a.rgb[c]} - b.rgb[c]));
        l.whole += seen[i] != several;
        l.empty += seen[i] == nothing;
        l.wrong += seen[i] != several && worst > tolerance;
    }
    return l;
}

// From close by, triangles extend behind the observer. GPUs clip them into parts, and a pixel on
// the line between two parts is a mean of two positions. From afar, mips are blended by differences
// between pixels, which are not constant within a pixel.
struct Place {
    Camera camera;
    double may_differ; // share of pixels that may differ
};
inline std::vector<Place> places() {
    return {{camera_at({6, 3, 5}, {1, 0, 0}), 0.015},
            {camera_at({-30, 8, 20}, {0.9, 0, 0}), 0.001},
            {camera_at({6, 3, 5}, {16, 3, 5}), 0}, // looks away from both
            {camera_at({1.6, 1.2, 2.2}, {0.8, 0.2, 0}), 0.035},
            {camera_at({0, 1.2, 0}, {3, 0, -0.5}), 0.03}};
}

} // namespace tessera::test
