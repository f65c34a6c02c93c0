// Compares layers drawn on the GPU with layers drawn on the CPU.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/memory_texture.h"
#include "tests/support/mesh_views.h"
#include "tools/view/gpu_renderer.h"
#include "tools/view/layer_files.h"
#include "tools/view/layered_renderer.h"

#include <gtest/gtest.h>
#include <numbers>

namespace tessera::test {
namespace {

constexpr std::uint32_t light_count = 5;

// Waves of this many texels, and blocks of 4 texels, whose edges show wrong neighbours.
double waves(int u, int v, int c, double texels) {
    const double wave = std::sin((u + 0.6 * v) / texels * 2 * std::numbers::pi + c);
    return 0.5 + 0.3 * wave + ((u / 4 + v / 4 + c) % 2 == 0 ? 0.1 : -0.1);
}

struct LayerDesign {
    LayerRole role;
    Extent4 size;
    std::uint8_t channels;
    float scale;
    Transfer transfer;
    MemoryTexture::Function sample;
};

// Sizes and tiles differ, so that layers have mips of their own.
std::vector<LayerDesign> designs() {
    const auto wavy = [](double texels) {
        return [texels](int u, int v, int, int, int c) { return waves(u, v, c, texels); };
    };
    return {{LayerRole::diffuse, {48, 32, 1, 1}, 3, 0.7f, Transfer::srgb, wavy(9)},
            {LayerRole::emission, {24, 16, 1, 1}, 3, 0.2f, Transfer::srgb, wavy(7)},
            {LayerRole::specular, {48, 32, 1, 1}, 3, 0.5f, Transfer::srgb, wavy(14)},
            {LayerRole::roughness,
             {32, 32, 1, 1},
             1,
             1.0f,
             Transfer::linear,
             [](int u, int v, int, int, int) { return 0.1 + 0.5 * waves(u, v, 0, 11); }},
            {LayerRole::normal,
             {64, 48, 1, 1},
             2,
             1.0f,
             Transfer::linear,
             [](int u, int v, int, int, int c) { return 0.4 + 0.2 * waves(u, v, c, 20); }},
            {LayerRole::visibility,
             {32, 32, 3, 2},
             1,
             1.0f,
             Transfer::linear,
             [](int u, int v, int s, int t, int) { return 0.6 * waves(u, v, s + 3 * t, 8); }},
            {LayerRole::reflection,
             {16, 16, 6, 6},
             3,
             1.4f,
             Transfer::srgb,
             [](int u, int v, int s, int t, int c) { return waves(u + 2 * s, v + t, c, 12); }},
            {LayerRole::coverage,
             {32, 32, 1, 1},
             1,
             1.0f,
             Transfer::linear,
             [](int u, int v, int, int, int) { return waves(u, v, 0, 16) + 0.2; }},
            {LayerRole::environment,
             {3, 1, 16, 16},
             3,
             4.0f,
             Transfer::srgb,
             [](int u, int, int s, int t, int c) { return waves(s + u, t, c, 9 + u); }},
            {LayerRole::difference,
             {16, 16, 4, 4},
             3,
             0.2f,
             Transfer::unspecified,
             [](int u, int v, int s, int t, int c) { return waves(u + s, v + 2 * t, c, 10); }},
            {LayerRole::shared_difference,
             {1, 1, 16, 16},
             3,
             0.1f,
             Transfer::unspecified,
             [](int, int, int s, int t, int c) { return waves(s, t, c, 8); }},
            // Some places hide what is behind them, and some are invisible.
            {LayerRole::opacity,
             {32, 48, 1, 1},
             1,
             1.0f,
             Transfer::unspecified,
             [](int u, int v, int, int, int) {
                 return std::clamp(2.5 * waves(u, v, 0, 13) - 0.75, 0.0, 1.0);
             }}};
}

// In all directions, with sharp and wide highlights.
std::vector<DistantLight> five_lights() {
    std::vector<DistantLight> lights;
    for (std::uint32_t i = 0; i < light_count; ++i) {
        const float angle = 1.3f * static_cast<float>(i);
        lights.push_back({glm::normalize(glm::vec3(std::cos(angle), 0.4f, std::sin(angle))),
                          0.1f * static_cast<float>(i),
                          glm::vec3(0.3f, 0.2f, 0.1f) * static_cast<float>(i + 1)});
    }
    return lights;
}

Bytes layer_file(const LayerDesign& layer, const std::vector<std::byte>& mesh,
                 const Extent4& tile) {
    MemoryTexture texture({layer.size, SampleType::unorm8, layer.channels}, layer.sample);
    EncodeOptions options;
    options.effort = 0;
    options.rate = {RateTarget::Kind::quality, 80};
    options.tile_extent = tile;
    options.description.surface_map = SurfaceMap::mesh_uv;
    options.description.angular_map = AngularMap::octahedral_mirrored;
    options.description.transfer = layer.transfer;
    if (layer.role == LayerRole::diffuse) {
        options.description.proxy = Proxy::mesh;
        options.mesh = mesh;
    }
    Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

// A file with the diffuse layer and those of `roles`.
Bytes file_of_layers(const std::vector<LayerRole>& roles, bool lit,
                     const std::vector<std::byte>& mesh, const Extent4& tile = {16, 16, 6, 6}) {
    std::vector<Bytes> files;
    std::vector<LayerFile> further;
    for (const LayerDesign& layer : designs())
        if (layer.role == LayerRole::diffuse || std::ranges::find(roles, layer.role) != roles.end())
            files.push_back(layer_file(layer, mesh, tile));
    std::size_t at = 1;
    for (const LayerDesign& layer : designs())
        if (std::ranges::find(roles, layer.role) != roles.end())
            further.push_back({layer.role, layer.scale, files[at++]});
    auto joined = join_layers(files[0], designs()[0].scale, further,
                              lit ? five_lights() : std::vector<DistantLight>{});
    EXPECT_TRUE(joined.ok()) << joined.status().message();
    return joined.ok() ? std::move(*joined) : Bytes{};
}

// The layers of a file, opened, with a renderer on the CPU.
struct OpenedLayers {
    std::unique_ptr<ByteSource> bytes;
    std::optional<Decoder> decoder;
    std::vector<OpenLayerFile> further;
    std::vector<std::unique_ptr<TexelSource>> texels;
    std::unique_ptr<ViewRenderer> on_cpu;

    OpenedLayers(const Bytes& file, const SurfaceMesh& mesh) : bytes(wrap_memory(file)) {
        auto opened = Decoder::open(*bytes);
        EXPECT_TRUE(opened.ok()) << opened.status().message();
        decoder.emplace(std::move(*opened));
        auto layers = open_layers(*bytes, decoder->container(), {});
        EXPECT_TRUE(layers.ok()) << layers.status().message();
        further = std::move(*layers);
        std::vector<DrawnLayer> drawn;
        const auto add = [&](LayerRole role, float scale, const Decoder& layer) {
            texels.push_back(decoded_source(layer));
            drawn.push_back({role, static_cast<double>(scale), texels.back().get(),
                             layer.container().grid().tile_extent(),
                             layer.container().description().transfer});
        };
        add(LayerRole::diffuse, decoder->container().layers().scale, *decoder);
        for (const OpenLayerFile& layer : further)
            add(layer.info.role, layer.info.scale, *layer.decoder);
        auto renderer = make_layered_renderer(drawn, decoder->container().layers().lights, mesh,
                                              backdrop_grey, {});
        EXPECT_TRUE(renderer.ok()) << renderer.status().message();
        on_cpu = std::move(*renderer);
    }

    Result<std::unique_ptr<ViewRenderer>> on_gpu(const SurfaceMesh& mesh,
                                                 const GpuRenderOptions& options) const {
        const ContainerReader& first = decoder->container();
        std::vector<GpuLayer> drawn = {{LayerRole::diffuse, first.layers().scale, &first}};
        for (const OpenLayerFile& layer : further)
            drawn.push_back({layer.info.role, layer.info.scale, &layer.decoder->container()});
        return make_gpu_renderer(drawn, first.layers().lights, mesh, backdrop_grey, options);
    }
};

using GpuLayers = GpuTest;

void expect_alike(const SurfaceMesh& mesh, const Camera& camera, double may_differ,
                  ViewRenderer& on_gpu, ViewRenderer& on_cpu) {
    SCOPED_TRACE("x = " + std::to_string(camera.eye.x));
    const std::vector<int> seen = triangles_seen(mesh, camera);
    const Likeness l = likeness(mesh_view_of(on_gpu, camera), mesh_view_of(on_cpu, camera), seen);
    EXPECT_LE(l.wrong, may_differ * static_cast<double>(seen.size()));
    EXPECT_GT(l.whole, seen.size() / 2);
}

TEST_F(GpuLayers, LookAsOnTheCpu) {
    using enum LayerRole;
    struct {
        std::vector<LayerRole> roles;
        bool lit;
    } const files[] = {{{emission, specular, roughness, normal, visibility, reflection}, true},
                       {{specular, roughness, normal, visibility, reflection, environment}, true},
                       {{specular, visibility, coverage}, true},
                       {{specular, normal, reflection}, true}, // lights that nothing blocks
                       {{emission, reflection}, false},
                       {{difference, shared_difference}, false},
                       {{specular, reflection, difference}, true},
                       {{specular, reflection, opacity}, true},
                       {{coverage, difference, opacity}, false}};
    const std::vector<std::byte> stream = stream_of(box_and_ball());
    const SurfaceMesh mesh = decoded(stream);
    for (const auto& [roles, lit] : files) {
        SCOPED_TRACE(std::to_string(roles.size()) + " layers");
        const Bytes file = file_of_layers(roles, lit, stream);
        const OpenedLayers opened(file, mesh);
        const auto gpu = opened.on_gpu(mesh, {"load", 64});
        ASSERT_TRUE(gpu.ok()) << gpu.status().message();
        for (const auto& [camera, may_differ] : places())
            expect_alike(mesh, camera, may_differ, **gpu, *opened.on_cpu);
    }
}

// All roles that a pixel samples in another way with a tile cache: several lights, which lie in
// several tiles, two mips, a texture without an atlas, and what decides about holes.
TEST_F(GpuLayers, InTileCachesLookAsOnTheCpu) {
    using enum LayerRole;
    const std::vector<std::byte> stream = stream_of(box_and_ball());
    const SurfaceMesh mesh = decoded(stream);
    for (const auto& roles :
         {std::vector{specular, roughness, normal, visibility, reflection, environment, coverage},
          std::vector{emission, difference, shared_difference, opacity}}) {
        SCOPED_TRACE(std::to_string(roles.size()) + " layers");
        const bool lit = roles.front() == specular;
        const Bytes file = file_of_layers(roles, lit, stream, {16, 16, 2, 2});
        const OpenedLayers opened(file, mesh);
        const auto gpu = opened.on_gpu(mesh, {"feedback", 64});
        ASSERT_TRUE(gpu.ok()) << gpu.status().message();
        unsigned frames = 0, touched = 0;
        (*gpu)->watch([&](unsigned number, const DrawnFrame& frame, const auto&) -> Status {
            frames = std::max(frames, number);
            touched = frame.touched;
            return {};
        });
        for (const auto& [camera, may_differ] : places())
            expect_alike(mesh, camera, may_differ, **gpu, *opened.on_cpu);
        EXPECT_GE(frames, 2u); // the first one marks the tiles
        EXPECT_GT(touched, 6u);
    }
}

TEST_F(GpuLayers, NeedABudgetForAllOfThem) {
    const std::vector<std::byte> stream = stream_of(box_and_ball());
    const SurfaceMesh mesh = decoded(stream);
    const Bytes file = file_of_layers({LayerRole::specular, LayerRole::normal}, false, stream);
    const OpenedLayers opened(file, mesh);
    const auto refused = opened.on_gpu(mesh, {"load", 32});
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.status().code(), ErrorCode::unsupported);
    EXPECT_NE(refused.status().message().find("--budget 33M"), std::string::npos)
        << refused.status().message();
    EXPECT_TRUE(opened.on_gpu(mesh, {"gpu", 33}).ok());
}

} // namespace
} // namespace tessera::test
