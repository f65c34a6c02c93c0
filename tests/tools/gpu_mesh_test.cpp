// Compares meshes drawn on the GPU with meshes drawn on the CPU.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/support/angular_maps.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/memory_texture.h"
#include "tests/support/mesh_views.h"
#include "tools/view/gpu_camera.h"
#include "tools/view/gpu_renderer.h"
#include "tools/view/mesh_renderer.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

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

// Draws the view with a renderer whose texels are all loaded.
View gl_view_of(GlViewRenderer& renderer, const Camera& camera) {
    EXPECT_TRUE(renderer.draw(gpu_camera(camera, SphereWindow{}, backdrop_grey)));
    const auto pixels = renderer.read();
    View view{camera.width, camera.height, {}};
    for (std::size_t i = 0; pixels.ok() && i < pixels->size(); ++i)
        if (i % 4 < 3)
            view.rgb.push_back((*pixels)[i]);
    return view;
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
                    likeness(gl_view_of(*renderer, camera), mesh_view_of(**cpu, camera), seen);
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
    append_mesh(hidden, mesh);
    EXPECT_EQ(touched(hidden), alone);
}

} // namespace
} // namespace tessera::test
