// Cameras, textures and views for the tests of rendering.
#pragma once

#include "codec/encoder.h"
#include "corpus/bake.h"
#include "tests/support/efforts.h"
#include "tests/support/test_folder.h"
#include "tools/picture/picture.h"
#include "tools/verbs/command.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_renderer.h"

#include <filesystem>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace tessera::test::rendering {

namespace fs = std::filesystem;
inline const SphereWindow paper_window{glm::dvec3{0.0}, corpus::window_radius};
inline const glm::dvec3 grey{0.5};

inline Camera camera_at(const CameraPose& pose, const Lens& lens) {
    auto camera = make_camera(pose, lens);
    EXPECT_TRUE(camera.ok()) << camera.status().message();
    return *camera;
}

inline void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.x << " " << a.y << " " << a.z << " and " << b.x << " " << b.y << " " << b.z;
}

inline std::unique_ptr<TexelSource> bake(const std::string& scene, const Extent4& size,
                                         unsigned samples) {
    auto source = corpus::make_baked_source(scene, size, samples, 1);
    EXPECT_TRUE(source.ok()) << source.status().message();
    return std::move(*source);
}

inline View view_of(ViewRenderer& renderer, const Camera& camera) {
    auto view = renderer.render(camera);
    EXPECT_TRUE(view.ok()) << view.status().message();
    return std::move(*view);
}

inline View texture_view(TexelSource& source, const Camera& camera,
                         const RenderOptions& options = {}, const Extent4& block = {8, 8, 4, 4}) {
    return view_of(*make_texture_renderer(source, block, paper_window, grey, options), camera);
}

inline const CameraPose aslant{{6, 3, 8}, {0, 0, 0}};

inline std::vector<std::byte> encoded(TexelSource& source, const EncodeOptions& options) {
    std::vector<std::byte> bytes;
    EXPECT_TRUE(encode_memory(source, bytes, options).ok());
    return bytes;
}

// Runs the verb `render` in this process.
class Render : public testing::Test {
protected:
    void SetUp() override { folder_ = test::make_test_folder("render"); }
    void TearDown() override { fs::remove_all(folder_); }

    std::string at(const std::string& name) const { return (folder_ / name).string(); }

    Status run(std::vector<std::string> words) {
        CLI::App app;
        Invocation chosen;
        add_render_command(app, chosen);
        words.insert(words.begin(), "render");
        std::reverse(words.begin(), words.end()); // CLI11 takes them in reverse order
        try {
            app.parse(words);
        } catch (const CLI::ParseError& e) {
            return {ErrorCode::bad_argument, e.what()};
        }
        testing::internal::CaptureStdout();
        const Status status = chosen.run();
        out_ = testing::internal::GetCapturedStdout();
        return status;
    }

    void fails(ErrorCode code, const std::vector<std::string>& words, const std::string& word) {
        const Status status = run(words);
        EXPECT_EQ(status.code(), code) << status.message();
        EXPECT_NE(status.message().find(word), std::string::npos) << status.message();
    }

    std::string encode(const std::string& scene, const std::string& name, bool on_sphere = true) {
        EncodeOptions options;
        options.effort = test::quick_effort;
        options.metadata = {{"Scene", scene}, {"Samples per texel", "2"}, {"Seed", "1"}};
        if (on_sphere) {
            options.description.proxy = Proxy::sphere;
            options.description.sphere_radius = 3.5f;
            options.description.surface_map = SurfaceMap::sphere_longitude_latitude;
            options.description.angular_map = AngularMap::hemisphere_alpha_beta;
        }
        const auto source = bake(scene, {32, 16, 8, 8}, 2);
        EXPECT_TRUE(encode_file(*source, at(name), options).ok());
        return at(name);
    }

    fs::path folder_;
    std::string out_;
};

} // namespace tessera::test::rendering
