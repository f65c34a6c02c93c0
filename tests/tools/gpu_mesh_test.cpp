// Compares meshes drawn on the GPU with meshes drawn on the CPU.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "corpus/trace/ray_scene.h"
#include "tests/support/angular_maps.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/memory_texture.h"
#include "tests/support/meshes.h"
#include "tools/view/gpu_camera.h"
#include "tools/view/gpu_renderer.h"
#include "tools/view/mesh_renderer.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

const glm::dvec3 backdrop_grey{0.5};

// A box and a ball that partly hide each other. Both have the same texture.
SurfaceMesh box_and_ball() {
    SurfaceMesh mesh = six_charts(1, false), ball = six_charts(2, true);
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (glm::vec3& position : ball.positions)
        position = position * 1.5f + glm::vec3(2.4f, 0.3f, -0.5f);
    const auto append = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    append(mesh.positions, ball.positions);
    append(mesh.normals, ball.normals);
    append(mesh.uv, ball.uv);
    for (const auto& [a, b, c] : ball.triangles)
        mesh.triangles.push_back({a + base, b + base, c + base});
    return mesh;
}

std::vector<std::byte> stream_of(const SurfaceMesh& mesh) {
    auto stream = encode_mesh(mesh, MeshQuantisation{});
    EXPECT_TRUE(stream.ok()) << stream.status().message();
    return stream.ok() ? std::move(*stream) : std::vector<std::byte>{};
}

// The mesh as viewers decode it.
SurfaceMesh decoded(const std::vector<std::byte>& stream) {
    auto mesh = decode_mesh(stream, 1u << 28);
    EXPECT_TRUE(mesh.ok()) << mesh.status().message();
    return mesh.ok() ? std::move(*mesh) : SurfaceMesh{};
}

// Noise, and background in some regions, so that there are tiles of all kinds.
Bytes rough_file(AngularMap map, const std::vector<std::byte>& stream) {
    MemoryTexture texture(
        {{48, 32, 10, 8}, SampleType::unorm8, 3}, [](int u, int v, int s, int t, int c) {
            const unsigned hash =
                static_cast<unsigned>((((u * 31 + v) * 37 + s) * 41 + t * 43 + c) * 2654435761u);
            return u < 16 && v < 16 ? 0.5 : (hash >> 24) / 255.0;
        });
    EncodeOptions options;
    options.effort = 0;
    options.rate = {RateTarget::Kind::quality, 60};
    options.tile_extent = {16, 16, 4, 4};
    options.description.proxy = Proxy::mesh;
    options.description.surface_map = SurfaceMap::mesh_uv;
    options.description.angular_map = map;
    options.mesh = stream;
    Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

using GpuMesh = GpuTest;

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& look, double fov = 50) {
    auto camera = make_camera({eye, look}, {fov, 96, 72});
    EXPECT_TRUE(camera.ok()) << camera.status().message();
    return *camera;
}

View mesh_view_of(ViewRenderer& renderer, const Camera& camera) {
    auto view = renderer.render(camera);
    EXPECT_TRUE(view.ok()) << view.status().message();
    return view.ok() ? std::move(*view) : View{};
}

// Draws the view with a renderer whose texels are all loaded.
View mesh_view_of(GlViewRenderer& renderer, const Camera& camera) {
    EXPECT_TRUE(renderer.draw(gpu_camera(camera, SphereWindow{}, backdrop_grey)));
    const auto pixels = renderer.read();
    View view{camera.width, camera.height, {}};
    for (std::size_t i = 0; pixels.ok() && i < pixels->size(); ++i)
        if (i % 4 < 3)
            view.rgb.push_back((*pixels)[i]);
    return view;
}

// What a pixel shows: the number of a triangle, or one of these values.
constexpr int several = -1, nothing = -2;
std::vector<int> triangles_seen(const SurfaceMesh& mesh, const Camera& camera) {
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
Likeness likeness(const View& a, const View& b, const std::vector<int>& seen) {
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
std::vector<Place> places() {
    return {{camera_at({6, 3, 5}, {1, 0, 0}), 0.015},
            {camera_at({-30, 8, 20}, {0.9, 0, 0}), 0.001},
            {camera_at({6, 3, 5}, {16, 3, 5}), 0}, // looks away from both
            {camera_at({1.6, 1.2, 2.2}, {0.8, 0.2, 0}), 0.035},
            {camera_at({0, 1.2, 0}, {3, 0, -0.5}), 0.03}};
}

TEST_F(GpuMesh, LooksAsOnTheCpu) {
    const std::vector<std::byte> stream = stream_of(box_and_ball());
    const SurfaceMesh mesh = decoded(stream);
    for (const AngularMap map : {hemisphere, mirrored}) {
        SCOPED_TRACE(name_of(map));
        const Bytes bytes = rough_file(map, stream);
        const auto file = wrap_memory(bytes);
        const auto decoder = Decoder::open(*file);
        ASSERT_TRUE(decoder.ok()) << decoder.status().message();
        const auto texels = decoded_source(*decoder);
        const auto cpu =
            make_mesh_renderer(*texels, {16, 16, 4, 4}, {mesh, map}, backdrop_grey, {});
        ASSERT_TRUE(cpu.ok()) << cpu.status().message();
        for (const bool filter : {false, true}) {
            const auto texture = SampledTexture::from_texels(decoder->container(), *texels, filter);
            ASSERT_TRUE(texture.ok()) << texture.status().message();
            auto renderer = GlViewRenderer::create(*texture, mesh);
            ASSERT_TRUE(renderer.ok()) << renderer.status().message();
            for (const auto& [camera, may_differ] : places()) {
                SCOPED_TRACE("x = " + std::to_string(camera.eye.x));
                const std::vector<int> seen = triangles_seen(mesh, camera);
                const Likeness l =
                    likeness(mesh_view_of(*renderer, camera), mesh_view_of(**cpu, camera), seen);
                EXPECT_LE(l.wrong, may_differ * static_cast<double>(seen.size()));
                EXPECT_GT(l.whole, seen.size() / 2);
                EXPECT_EQ(l.empty == seen.size(), camera.forward.x > 0.999);
            }
        }
    }
}

TEST_F(GpuMesh, LooksTheSameOnFeedback) {
    const std::vector<std::byte> stream = stream_of(box_and_ball());
    const SurfaceMesh mesh = decoded(stream);
    const Bytes bytes = rough_file(mirrored, stream);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok()) << decoder.status().message();
    const auto texels = decoded_source(*decoder);
    const auto cpu =
        make_mesh_renderer(*texels, {16, 16, 4, 4}, {mesh, mirrored}, backdrop_grey, {});
    ASSERT_TRUE(cpu.ok()) << cpu.status().message();
    const auto gpu = make_gpu_renderer(decoder->container(), mesh, backdrop_grey, {"feedback", 64});
    ASSERT_TRUE(gpu.ok()) << gpu.status().message();
    std::vector<DrawnFrame> frames; // frames of the latest view
    (*gpu)->watch([&](unsigned number, const DrawnFrame& frame, const auto&) -> Status {
        frames.resize(number);
        frames.back() = frame;
        return {};
    });
    for (const auto& [camera, may_differ] : places()) {
        SCOPED_TRACE("x = " + std::to_string(camera.eye.x));
        const std::vector<int> seen = triangles_seen(mesh, camera);
        const Likeness l = likeness(mesh_view_of(**gpu, camera), mesh_view_of(**cpu, camera), seen);
        EXPECT_LE(l.wrong, may_differ * static_cast<double>(seen.size()));
        EXPECT_EQ(frames.back().coarse, 0u);
        EXPECT_EQ(frames.back().touched == 0, l.empty == seen.size());
        EXPECT_LT(frames.back().touched, decoder->container().tile_count());
    }
}

// All pixels of a wall that faces the camera have the same mip, so GPU and CPU agree.
TEST_F(GpuMesh, MipsLookAsOnTheCpu) {
    SurfaceMesh wall = six_charts(1, false); // six charts one texel apart, side by side
    for (std::size_t i = 0; i < wall.positions.size(); ++i) {
        wall.positions[i] = {wall.uv[i].x * 3 - 1.5f, wall.uv[i].y * 2 - 1, 0};
        wall.normals[i] = {0, 0, 1};
    }
    const std::vector<std::byte> stream = stream_of(wall);
    const SurfaceMesh mesh = decoded(stream);
    const std::pair<AngularMap, const char*> ways[] = {{hemisphere, "load"},
                                                       {mirrored, "feedback"}};
    for (const auto& [map, via] : ways) {
        SCOPED_TRACE(via);
        const Bytes bytes = rough_file(map, stream);
        const auto file = wrap_memory(bytes);
        const auto decoder = Decoder::open(*file);
        ASSERT_TRUE(decoder.ok()) << decoder.status().message();
        const auto texels = decoded_source(*decoder);
        const auto cpu =
            make_mesh_renderer(*texels, {16, 16, 4, 4}, {mesh, map}, backdrop_grey, {});
        ASSERT_TRUE(cpu.ok()) << cpu.status().message();
        const auto gpu = make_gpu_renderer(decoder->container(), mesh, backdrop_grey, {via, 64});
        ASSERT_TRUE(gpu.ok()) << gpu.status().message();
        for (const double distance : {6.0, 13.0, 30.0, 70.0}) {
            SCOPED_TRACE("distance " + std::to_string(distance));
            const Camera camera = camera_at({0.3, 0.2, distance}, {0.3, 0.2, 0}, 150.0 / distance);
            const std::vector<int> seen = triangles_seen(mesh, camera);
            const Likeness l =
                likeness(mesh_view_of(**gpu, camera), mesh_view_of(**cpu, camera), seen);
            EXPECT_GT(l.whole - l.empty, seen.size() / 8);
            EXPECT_LE(l.wrong, 3u); // positions on the line between the texels of two charts
        }
    }
}

// A small ball behind the box, with another part of the texture, marks no tile.
TEST_F(GpuMesh, HiddenSurfacesMarkNothing) {
    SurfaceMesh hidden = six_charts(1, true);
    for (std::size_t i = 0; i < hidden.positions.size(); ++i) {
        hidden.positions[i] *= 0.3f;
        hidden.uv[i] = hidden.uv[i] * 0.1f + 0.9f;
    }
    SurfaceMesh mesh = six_charts(1, false);
    for (glm::vec2& uv : mesh.uv)
        uv = uv * 0.3f + 0.5f;
    const Bytes bytes = rough_file(hemisphere, stream_of(mesh));
    const auto file = wrap_memory(bytes);
    const auto reader = ContainerReader::open(*file);
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    SampledTextureOptions options;
    options.coarse = false;
    auto texture = SampledTexture::create(*reader, options);
    ASSERT_TRUE(texture.ok()) << texture.status().message();
    const auto touched = [&](const SurfaceMesh& seen) {
        auto renderer = GlViewRenderer::create(*texture, seen);
        EXPECT_TRUE(renderer.ok()) << renderer.status().message();
        EXPECT_TRUE(renderer->draw(gpu_camera(camera_at({6, 3, 5}, {0, 0, 0}), {}, backdrop_grey)));
        const auto report = texture->update(true);
        return report.ok() ? report->touched : 0;
    };
    const std::uint32_t alone = touched(mesh);
    EXPECT_GT(alone, 0u);
    EXPECT_GT(touched(hidden), 0u);
    // The hidden ball comes first, so that it is drawn before the box that hides it.
    const auto base = static_cast<std::uint32_t>(hidden.positions.size());
    const auto append = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    append(hidden.positions, mesh.positions);
    append(hidden.normals, mesh.normals);
    append(hidden.uv, mesh.uv);
    for (const auto& [a, b, c] : mesh.triangles)
        hidden.triangles.push_back({a + base, b + base, c + base});
    EXPECT_EQ(touched(hidden), alone);
}

} // namespace
} // namespace tessera::test
