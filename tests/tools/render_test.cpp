// Drawing: cameras, the three kinds of renderer against each other, the verb.
#include "codec/encoder.h"
#include "corpus/bake.h"
#include "corpus/catalog.h"
#include "corpus/shade.h"
#include "tests/support/sample_probes.h"
#ifdef TESSERA_GPU
#include "tests/support/gpu_fixture.h"
#endif
#ifdef TESSERA_HTTP
#include "tests/support/raw_server.h"
#endif
#include "tests/support/test_folder.h"
#include "tools/verbs/command.h"
#include "tools/view/gpu_renderer.h"
#include "tools/picture/png_file.h"
#include "tools/view/render_views.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_file.h"
#include "tools/view/view_renderer.h"
#include "tools/view/view_report.h"

#include <ImfArray.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <mutex>
#include <optional>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tessera {
namespace {

using test::slurp;

namespace fs = std::filesystem;

const SphereWindow paper_window{glm::dvec3{0.0}, corpus::window_radius};
const glm::dvec3 grey{0.5};

Camera camera_at(const CameraPose& pose, const Lens& lens) {
    auto camera = make_camera(pose, lens);
    EXPECT_TRUE(camera.ok()) << camera.status().message();
    return *camera;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.x << " " << a.y << " " << a.z << " and " << b.x << " " << b.y << " " << b.z;
}

TEST(Camera, AimsAndStandsUpright) {
    const Lens lens{90, 200, 100};
    const Camera c = camera_at({{0, 0, 10}, {0, 0, 0}}, lens);
    expect_near(c.direction(100, 50), {0, 0, -1});
    expect_near(c.direction(100, 0), glm::normalize(glm::dvec3{0, 1, -1}));   // top: 45 degrees up
    expect_near(c.direction(200, 50), glm::normalize(glm::dvec3{2, 0, -1}));  // twice as wide
    expect_near(c.direction(0, 100), glm::normalize(glm::dvec3{-2, -1, -1})); // bottom left
    expect_near(glm::normalize(camera_at({{10, 0, 0}, {0, 0, 0}}, lens).right), {0, 0, -1});
    expect_near(glm::normalize(camera_at({{0, 10, 0}, {0, 0, 0}}, lens).up), {0, 0, -1});
    expect_near(glm::normalize(camera_at({{0, 10, 0}, {0, 0, 0}}, lens).right), {1, 0, 0});
    expect_near(glm::normalize(camera_at({{0, -10, 0}, {0, 0, 0}}, lens).up), {0, 0, 1});
    expect_near(glm::normalize(camera_at({{0, -10, 0}, {0, 0, 0}}, lens).right), {1, 0, 0});
}

TEST(Camera, KnowsThePapersViews) {
    const auto views = paper_views();
    ASSERT_EQ(views.size(), 5u);
    for (const std::size_t i : {0u, 1u, 2u})
        expect_near(camera_at(views[i].pose, {}).forward, {-1, 0, 0});
    expect_near(camera_at(views[3].pose, {}).forward, {0, 0, -1});
    expect_near(camera_at(views[4].pose, {}).forward, {0, -1, 0});
}

TEST(Camera, RefusesNonsense) {
    const CameraPose pose;
    for (const Lens& lens :
         {Lens{0, 8, 8}, {180, 8, 8}, {-3, 8, 8}, {std::nan(""), 8, 8}, {45, 0, 8}, {45, 8, 16385}})
        EXPECT_EQ(make_camera(pose, lens).status().code(), ErrorCode::bad_argument);
    EXPECT_FALSE(make_camera({{1, 2, 3}, {1, 2, 3}}, {}).ok());
    EXPECT_FALSE(make_camera({{1, 2, INFINITY}, {0, 0, 0}}, {}).ok());
}

TEST(Camera, Orbits) {
    const auto poses = orbit({{10, 2, 0}, {0, 1, 0}}, 4);
    ASSERT_TRUE(poses.ok());
    expect_near((*poses)[0].eye, {10, 2, 0});
    expect_near((*poses)[1].eye, {0, 2, -10});
    expect_near((*poses)[2].eye, {-10, 2, 0});
    expect_near((*poses)[3].eye, {0, 2, 10});
    EXPECT_FALSE(orbit({{0, 10, 0}, {0, 0, 0}}, 4).ok());
}

TEST(RenderViews, NumbersFiles) {
    ViewRequest request;
    request.output = "folder.d/out.png";
    auto plan = plan_views(request);
    ASSERT_TRUE(plan.ok());
    EXPECT_EQ(plan->front().output, "folder.d/out.png");
    request.views = "paper";
    plan = plan_views(request);
    ASSERT_EQ(plan->size(), 5u);
    EXPECT_EQ(plan->back().output, "folder.d/out-5.png");
    request.views = "2";
    plan = plan_views(request);
    ASSERT_EQ(plan->size(), 1u);
    expect_near(plan->front().camera.eye, {10, 0, -3});
    request.views.clear();
    request.orbit = 12;
    plan = plan_views(request);
    ASSERT_EQ(plan->size(), 12u);
    EXPECT_EQ(plan->front().output, "folder.d/out-01.png");
    EXPECT_EQ(plan->back().output, "folder.d/out-12.png");
    for (const char* size : {"0x5", "5", "x", "5x", "99999x5", "5x5x5", "-5x5"}) {
        request.size = size;
        EXPECT_FALSE(plan_views(request).ok()) << size;
    }
    request.size.clear();
    for (const char* eye : {"1,2", "1,2,3,4", "a,b,c", "1,,3", ","}) {
        request.eye = eye;
        EXPECT_FALSE(plan_views(request).ok()) << eye;
    }
}

// A baked texture in memory, and how often it was read.
class MemoryTexture final : public TexelSource {
public:
    explicit MemoryTexture(TexelSource& source)
        : desc_(source.desc()), texels_(desc_.box_bytes(Box4::whole(desc_.size))) {
        EXPECT_TRUE(source.read(Box4::whole(desc_.size), texels_).ok());
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        ++reads_;
        std::byte* to = out.data();
        const std::size_t n = desc_.texel_bytes();
        const Extent4& e = desc_.size;
        for (std::size_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::size_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                for (std::size_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
                    for (std::size_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s, to += n)
                        std::memcpy(to,
                                    texels_.data() +
                                        (((v * e[axis_u] + u) * e[axis_t] + t) * e[axis_s] + s) * n,
                                    n);
        return {};
    }
    int reads() const { return reads_; }

private:
    TextureDesc desc_;
    std::vector<std::byte> texels_;
    std::atomic<int> reads_{0};
};

std::unique_ptr<TexelSource> bake(const std::string& scene, const Extent4& size, unsigned samples) {
    auto source = corpus::make_baked_source(scene, size, samples, 1);
    EXPECT_TRUE(source.ok()) << source.status().message();
    return std::move(*source);
}

View view_of(ViewRenderer& renderer, const Camera& camera) {
    auto view = renderer.render(camera);
    EXPECT_TRUE(view.ok()) << view.status().message();
    return std::move(*view);
}

View texture_view(TexelSource& source, const Camera& camera, const RenderOptions& options = {},
                  const Extent4& block = {8, 8, 4, 4}) {
    return view_of(*make_texture_renderer(source, block, paper_window, grey, options), camera);
}

View truth_view(const std::string& scene, const Camera& camera, unsigned samples,
                const SphereWindow& window = paper_window) {
    return view_of(*make_truth_renderer(*corpus::make_scene(scene), window, samples, {}), camera);
}

const CameraPose aslant{{6, 3, 8}, {0, 0, 0}};

TEST(TextureRenderer, LazyBakingChangesNothing) {
    const auto lazy = bake("mirror", {32, 16, 9, 8}, 2);
    MemoryTexture whole(*lazy);
    const Camera camera = camera_at(aslant, {45, 60, 45});
    const View expected = texture_view(whole, camera, {1, 1u << 30, {}}, {32, 32, 32, 32});
    EXPECT_EQ(whole.reads(), 1);
    EXPECT_EQ(texture_view(*lazy, camera, {3, 1u << 30, {}}).rgb, expected.rgb);
    EXPECT_EQ(texture_view(*lazy, camera, {2, 1, {}}, {5, 3, 2, 1}).rgb, expected.rgb)
        << "a cache that keeps nothing";
    const int before = whole.reads();
    texture_view(whole, camera, {2, 1u << 30, {}}, {8, 8, 4, 4});
    EXPECT_LT(whole.reads() - before, 4 * 2 * 3 * 2) << "the far side is not read";
}

// One ray per pixel in both, so that nothing but the texture's resolution is between them.
TEST(TextureRenderer, ApproachesTheTruth) {
    for (const char* scene : {"composed", "gallery"})
        for (const NamedPose& named : paper_views()) {
            const Camera camera = camera_at(named.pose, {45, 40, 30});
            const auto psnr = [&](const Extent4& size) {
                const auto source = bake(scene, size, 1);
                return likeness_of(to_picture(truth_view(scene, camera, 1), SampleType::unorm8),
                                   to_picture(texture_view(*source, camera, {}, {2, 2, 2, 2}),
                                              SampleType::unorm8))
                    .psnr;
            };
            const double coarse = psnr({32, 16, 8, 8}), fine = psnr({8192, 4096, 2048, 2048});
            EXPECT_GT(fine, coarse + 10) << scene << " " << named.name;
            RecordProperty(std::string(scene) + " " + named.name,
                           std::to_string(coarse) + " " + std::to_string(fine));
        }
}

std::vector<std::byte> encoded(TexelSource& source, const EncodeOptions& options) {
    std::vector<std::byte> bytes;
    EXPECT_TRUE(encode_memory(source, bytes, options).ok());
    return bytes;
}

TEST(TextureRenderer, ReadsACompressedFile) {
    const auto source = bake("composed", {32, 16, 8, 8}, 2);
    EncodeOptions options;
    options.rate = {RateTarget::Kind::max_error, 0};
    const std::vector<std::byte> bytes = encoded(*source, options);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok());
    const auto texels = decoded_source(*decoder);
    const Camera camera = camera_at(aslant, {45, 60, 45});
    EXPECT_EQ(texture_view(*texels, camera, {}, decoder->container().grid().tile_extent()).rgb,
              texture_view(*source, camera).rgb);
}

TEST(TextureRenderer, KeepsOutsideTheSphere) {
    const auto source = bake("composed", {8, 4, 2, 2}, 1);
    const auto renderer = make_texture_renderer(*source, {8, 8, 8, 8}, paper_window, grey, {});
    const Lens lens{90, 8, 8};
    EXPECT_EQ(renderer->render(camera_at({{3.4, 0, 0}, {0, 0, 0}}, lens)).status().code(),
              ErrorCode::bad_argument);
    const View away = view_of(*renderer, camera_at({{5, 0, 0}, {10, 0, 0}}, lens));
    for (const float x : away.rgb)
        EXPECT_EQ(x, 0.5f);
}

TEST(TruthRenderer, TracesTheScene) {
    const corpus::Scene scene = *corpus::make_scene("composed");
    const Camera camera = camera_at(aslant, {45, 21, 15});
    const View view = truth_view("composed", camera, 1);
    for (std::uint32_t j = 0; j < 15; ++j)
        for (std::uint32_t i = 0; i < 21; ++i) {
            const glm::dvec3 expected =
                corpus::trace_scene(scene, {camera.eye, camera.direction(i + 0.5, j + 0.5)});
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(view.rgb[(std::size_t{j} * 21 + i) * 3 + static_cast<std::size_t>(c)],
                            expected[c], 1e-6);
        }
    // The same in a world twice as large and somewhere else.
    const glm::dvec3 there{1, -2, 5};
    const Camera moved =
        camera_at({aslant.eye * 2.0 + there, aslant.look * 2.0 + there}, {45, 21, 15});
    const View other = truth_view("composed", moved, 1, {there, 2 * corpus::window_radius});
    for (std::size_t i = 0; i < view.rgb.size(); ++i)
        EXPECT_NEAR(view.rgb[i], other.rgb[i], 1e-6);
}

TEST(ViewReport, Measures) {
    Picture a = blank_picture(16, 16, 100), b = blank_picture(16, 16, 110);
    EXPECT_NEAR(likeness_of(a, b).psnr, 20 * std::log10(25.5), 1e-9);
    EXPECT_EQ(likeness_of(a, a).ssim, 1);
    EXPECT_TRUE(std::isinf(likeness_of(a, a).psnr));
    const ViewFigures figures = measure({"x", a, a, b});
    const std::string table = to_table({figures});
    EXPECT_NE(table.find("28.13"), std::string::npos) << table;
    EXPECT_NE(table.find("same"), std::string::npos) << table;
    EXPECT_EQ(to_panels({"x", a, a, b}).size(), 4u);
    EXPECT_EQ(to_panels({"x", std::nullopt, std::nullopt, b}).size(), 1u);
    EXPECT_TRUE(measure({"x", std::nullopt, std::nullopt, b}).empty());
}

// The verb, in this process.
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
        std::reverse(words.begin(), words.end()); // as CLI11 wants them
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
        options.effort = 1; // no copies: every way of sampling
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

TEST_F(Render, DrawsMeasuresAndShows) {
    const std::string file = encode("composed", "c.tess");
    ASSERT_TRUE(
        run({file, "-o", at("v.png"), "--views", "paper", "--size", "40x30", "--truth", "composed",
             "--truth-spp", "2", "--sheet", at("s.png"), "--json", "--write-all"})
            .ok());
    const Json json = Json::parse(out_);
    ASSERT_EQ(json["views"].size(), 5u);
    for (const Json& view : json["views"]) {
        EXPECT_GT(view["compressed_uncompressed"]["psnr"].get<double>(), 35) << view;
        EXPECT_GT(view["compressed_truth"]["psnr"].get<double>(), 15) << view;
        EXPECT_LT(view["uncompressed_truth"]["ssim"].get<double>(), 1) << view;
        EXPECT_EQ(read_png_shape(view["output"].get<std::string>())->width, 40u);
    }
    EXPECT_GT(read_png_shape(at("s.png"))->height, 5u * 30);
    EXPECT_TRUE(fs::exists(at("v-5-truth.png")) && fs::exists(at("v-1-uncompressed.png")));
    // The original from a file, without a scene, and an orbit.
    ASSERT_TRUE(run({file, "-o", at("o.png"), "--orbit", "2", "--size", "8x8", "--original", file,
                     "--json"})
                    .ok());
    EXPECT_TRUE(Json::parse(out_)["views"][1]["compressed_uncompressed"]["psnr"].is_null());
    EXPECT_TRUE(fs::exists(at("o-2.png")));
    ASSERT_TRUE(run({file, "-o", at("q.png"), "--size", "8x8", "-q"}).ok());
    EXPECT_EQ(out_, "");
}

TEST_F(Render, DrawsATextureThatNoFileHolds) {
    const std::vector<std::string> how = {"--views", "1",        "--size", "40x30",
                                          "--truth", "composed", "--json"};
    std::vector<std::string> words = {
        "-o", at("s.png"), "--scene", "composed", "--texture-size", "32x16x8x8", "--spp", "2"};
    words.insert(words.end(), how.begin(), how.end());
    ASSERT_TRUE(run(words).ok());
    const Json scene = Json::parse(out_);
    words = {encode("composed", "c.tess"), "-o", at("c.png")};
    words.insert(words.end(), how.begin(), how.end());
    ASSERT_TRUE(run(words).ok());
    EXPECT_EQ(scene["views"][0]["uncompressed_truth"],
              Json::parse(out_)["views"][0]["uncompressed_truth"]);
    EXPECT_FALSE(scene["views"][0].contains("compressed_truth"));
    // 422 TB.
    EXPECT_TRUE(run({"-o", at("h.png"), "--scene", "lamps", "--texture-size", "65536x16384x256x256",
                     "--spp", "1", "--size", "8x6"})
                    .ok());
}

TEST_F(Render, WritesExr) {
    const std::string file = encode("lamps", "l.tess");
    ASSERT_TRUE(run({file, "-o", at("l.exr"), "--size", "32x20", "--truth", "lamps"}).ok());
    ASSERT_TRUE(run({file, "-o", at("l.png"), "--size", "32x20"}).ok());
    std::vector<float> rgb(32 * 20 * 3);
    Imf::InputFile in(at("l.exr").c_str());
    Imf::FrameBuffer frame;
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c)
        frame.insert(names[c],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(rgb.data() + c), 12, 12 * 32));
    in.setFrameBuffer(frame);
    in.readPixels(0, 19);
    const Picture shown = to_picture({32, 20, rgb}, SampleType::half16);
    std::vector<std::byte> png(shown.rgb.size());
    ASSERT_TRUE(read_png(at("l.png"), {32, 20, 3}, 20, [&](std::uint32_t y, auto row) {
                    std::memcpy(png.data() + y * 96, row.data(), 96);
                }).ok());
    EXPECT_EQ(shown.rgb, png);
    EXPECT_GT(*std::max_element(rgb.begin(), rgb.end()), 1.0f) << "scene-linear";
}

TEST_F(Render, RefusesWithReasons) {
    const std::string file = encode("composed", "c.tess"), out = at("v.png");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--eye", "1,0,0"}, "outside");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--fov", "180"}, "between 0 and 180");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--size", "0x4"}, "0x4");
    fails(ErrorCode::bad_argument, {file, "-o", at("v.jpg")}, ".png");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--truth", "nowhere"}, "aliasing-near");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--truth", "mirror"}, "composed");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--views", "6"}, "paper");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--sheet", out}, "a view's name");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--original", at("x.exr")}, "raw");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--via", "magic"}, "magic");
    fails(ErrorCode::bad_argument, {at("c.rgb"), "-o", out}, ".tess");
    fails(ErrorCode::unsupported, {encode("composed", "flat.tess", false), "-o", out}, "--proxy");
    fails(ErrorCode::bad_argument, {"-o", out}, "--scene");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--scene", "composed"}, "not both");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--texture-size", "8x8x8x8"}, "--scene");
    fails(ErrorCode::bad_argument, {file, "-o", out, "--spp", "2"}, "--truth");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "nowhere"}, "aliasing-near");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "composed", "--via", "load"}, "CPU");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "composed", "--texture-size", "8x8x8"},
          "8x8x8");
    fails(ErrorCode::bad_argument, {"-o", out, "--scene", "composed", "--truth", "mirror"},
          "mirror");
    fails(ErrorCode::io, {at("none.tess"), "-o", out}, "none.tess");
    fails(ErrorCode::io, {at("none.tess"), "-o", at("none/v.png")}, "no folder");
    fails(ErrorCode::io, {at("none.tess"), "-o", out, "--sheet", at("none/s.png")}, "no folder");
    std::ofstream(at("bad.tess")) << "not a texture";
    fails(ErrorCode::invalid_file, {at("bad.tess"), "-o", out}, "bad.tess");
    EXPECT_FALSE(fs::exists(out));
}

#ifdef TESSERA_GPU
class GpuRender : public Render {
protected:
    void SetUp() override {
        Render::SetUp();
        if (test::no_gpu_asked())
            GTEST_SKIP() << "TESSERA_NO_GPU=1";
    }

    // A file in small tiles, so that the borders of many cross the picture.
    static std::vector<std::byte> small_tiles(const std::string& scene, int effort = usual_effort) {
        const auto source = bake(scene, {64, 32, 16, 12}, 1);
        EncodeOptions options;
        options.tile_extent = {16, 8, 8, 8};
        options.effort = effort;
        options.tools = "-dense-tables"; // a decoder cannot tell
        return encoded(*source, options);
    }
};

// Where single precision cannot be held to double: less than a thousandth of the radius from the
// silhouette, where the place runs off like a square root and rounding decides between hit and
// miss; and what sample_probes.h excepts for all tests of the sampler.
bool is_ill_conditioned(const Extent4& size, const Camera& camera, std::uint32_t i,
                        std::uint32_t j) {
    const glm::dvec3 ray = camera.direction(i + 0.5, j + 0.5);
    const glm::dvec3 gap = camera.eye - glm::dot(camera.eye, ray) * ray;
    const double nearest = glm::length(gap) / corpus::window_radius;
    if (std::abs(nearest - 1) < 1e-3)
        return true;
    if (nearest > 1)
        return false;
    const glm::dvec3 place = gap - corpus::window_radius * std::sqrt(1 - nearest * nearest) * ray;
    const test::Condition c = test::condition_of(size, {glm::vec3(place), glm::vec3(-ray)});
    return c.planar < 3e-4 || c.jumps;
}

// Over all pixels that can be judged, as displayed, in steps of 8 bits.
double worst_difference(const View& a, const View& b, const Extent4& size, const Camera& camera,
                        SampleType type) {
    const auto shown = [&](float x) {
        const double value = std::max(double{x}, 0.0);
        return 255 * (type == SampleType::half16 ? value / (1 + value) : value);
    };
    double worst = 0;
    std::size_t judged = 0;
    for (std::uint32_t j = 0; j < camera.height; ++j)
        for (std::uint32_t i = 0; i < camera.width; ++i) {
            if (is_ill_conditioned(size, camera, i, j))
                continue;
            ++judged;
            const std::size_t at = (std::size_t{j} * camera.width + i) * 3;
            for (std::size_t c = at; c < at + 3; ++c)
                worst = std::max(worst, std::abs(shown(a.rgb[c]) - shown(b.rgb[c])));
        }
    EXPECT_GT(judged, std::size_t{camera.width} * camera.height * 98 / 100);
    return worst;
}

TEST_F(GpuRender, EveryWayGivesTheSamePicture) {
    for (const char* scene : {"composed", "lamps"}) {
        // Without copies and with.
        const bool copies = std::string(scene) == "lamps";
        const std::vector<std::byte> bytes = small_tiles(scene, copies ? 5 : 3);
        const auto file = wrap_memory(bytes);
        const auto decoder = Decoder::open(*file);
        ASSERT_TRUE(decoder.ok());
        const auto texels = decoded_source(*decoder);
        const TextureDesc& desc = decoder->desc();
        const Camera cameras[] = {camera_at(aslant, {45, 120, 90}),
                                  camera_at({{0, 10, 0}, {0, 0, 0}}, {45, 90, 90}),
                                  camera_at({{-4, 0, 0}, {0, 0, 1}}, {70, 90, 70})};
        for (const char* via : {"gpu", "load", "feedback"}) {
            const auto renderer =
                make_gpu_renderer(decoder->container(), paper_window, grey, {via, 64});
            ASSERT_TRUE(renderer.ok()) << renderer.status().message();
            for (const Camera& camera : cameras) {
                const View expected = texture_view(*texels, camera, {}, {16, 8, 8, 8});
                const View view = view_of(**renderer, camera);
                EXPECT_EQ(view.remark, "");
                const double worst = worst_difference(view, expected, desc.size, camera, desc.type);
                RecordProperty(std::string(scene) + " " + via, std::to_string(worst));
                EXPECT_LE(worst, 1.5) << scene << " " << via << " " << camera.eye.x;
            }
            EXPECT_GT((*renderer)->device_use()->bytes, 0u);
            EXPECT_LE((*renderer)->device_use()->bytes, 64u << 20);
        }
    }
}

TEST_F(GpuRender, KeepsThePlaceOfTheSphere) {
    const std::vector<std::byte> bytes = small_tiles("composed");
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok());
    const glm::dvec3 there{1, -2, 5};
    const auto here = make_gpu_renderer(decoder->container(), paper_window, grey, {"load", 64});
    const auto moved = make_gpu_renderer(decoder->container(), {there, 2 * corpus::window_radius},
                                         grey, {"load", 64});
    ASSERT_TRUE(here.ok() && moved.ok()); // two contexts in one program
    const View a = view_of(**here, camera_at(aslant, {45, 60, 45}));
    const View b = view_of(
        **moved, camera_at({aslant.eye * 2.0 + there, aslant.look * 2.0 + there}, {45, 60, 45}));
    EXPECT_LE(worst_difference(a, b, decoder->desc().size, camera_at(aslant, {45, 60, 45}),
                               SampleType::unorm8),
              0.5);
}

// The budget that the remark gives holds what the view needs.
TEST_F(GpuRender, DrawsCoarselyWhatFindsNoPlace) {
    const auto source = bake("gallery", {256, 128, 8, 8}, 1);
    EncodeOptions options;
    options.tile_extent = {32, 16, 8, 8};
    options.rate = {RateTarget::Kind::quality, 20};
    const std::vector<std::byte> bytes = encoded(*source, options);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok());
    const auto texels = decoded_source(*decoder);
    const Camera camera = camera_at(aslant, {45, 80, 60});
    const Picture expected = to_picture(texture_view(*texels, camera), SampleType::unorm8);
    const auto tiny = make_gpu_renderer(decoder->container(), paper_window, grey, {"feedback", 6});
    ASSERT_TRUE(tiny.ok()) << tiny.status().message();
    const View coarse = view_of(**tiny, camera);
    EXPECT_LE((*tiny)->device_use()->bytes, (6u << 20) + camera.width * camera.height * 16 + 4096);
    unsigned missing = 0, touched = 0, budget = 0, advice = 0;
    ASSERT_EQ(std::sscanf(coarse.remark.c_str(),
                          "%u of the %u tiles that it touches found no place within --budget %u "
                          "and are drawn coarsely; --budget %u",
                          &missing, &touched, &budget, &advice),
              4)
        << coarse.remark;
    EXPECT_GT(missing, 0u);
    EXPECT_LT(missing, touched);
    EXPECT_EQ(budget, 6u);
    EXPECT_LT(advice, 20u) << "not just anything";
    EXPECT_EQ(view_of(**tiny, camera).rgb, coarse.rgb) << "a view that stands still keeps still";
    // Coarse is not empty: like the picture, unlike the background that it would be without.
    const double psnr = likeness_of(expected, to_picture(coarse, SampleType::unorm8)).psnr;
    EXPECT_GT(psnr, likeness_of(expected, blank_picture(80, 60, 128)).psnr + 3);
    const auto enough =
        make_gpu_renderer(decoder->container(), paper_window, grey, {"feedback", advice});
    ASSERT_TRUE(enough.ok()) << enough.status().message();
    const View whole = view_of(**enough, camera);
    EXPECT_EQ(whole.remark, "");
    EXPECT_GT(likeness_of(expected, to_picture(whole, SampleType::unorm8)).psnr, psnr + 10);
}

TEST_F(GpuRender, OrbitsByFeedback) {
    const std::string file = encode("composed", "c.tess");
    ASSERT_TRUE(run({file, "-o", at("f.png"), "--orbit", "3", "--size", "40x30", "--via",
                     "feedback", "--original", file, "--json"})
                    .ok());
    const Json json = Json::parse(out_);
    EXPECT_GT(json["device"]["bytes"].get<double>(), 0);
    for (const Json& view : json["views"])
        EXPECT_GT(view["compressed_uncompressed"]["psnr"].get<double>(), 45) << view;
    ASSERT_TRUE(run({file, "-o", at("g.png"), "--size", "8x8", "--via", "load"}).ok());
    EXPECT_NE(out_.find("MiB held"), std::string::npos) << out_;
    fails(ErrorCode::unsupported, {file, "-o", at("h.png"), "--via", "feedback", "--budget", "1"},
          "--via cpu");
}

// With coarse levels, on a sphere, of many tiles.
class Sharpening : public GpuRender {
protected:
    void SetUp() override {
        GpuRender::SetUp();
        if (IsSkipped())
            return;
        ::setenv("no_proxy", "127.0.0.1", 1);
        EncodeOptions options;
        options.layers = true;
        options.tile_extent = {16, 16, 8, 8};
        options.effort = 1;
        options.rate = {RateTarget::Kind::quality, 60};
        options.description.proxy = Proxy::sphere;
        options.description.sphere_radius = 3.5f;
        options.description.surface_map = SurfaceMap::sphere_longitude_latitude;
        options.description.angular_map = AngularMap::hemisphere_alpha_beta;
        const auto source = bake("gallery", {128, 64, 16, 16}, 1);
        bytes_ = encoded(*source, options);
        std::ofstream(at("g.tess"), std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes_.data()),
                   static_cast<std::streamsize>(bytes_.size()));
    }
    static Picture picture_at(const std::string& path) {
        const auto shape = read_png_shape(path);
        EXPECT_TRUE(shape.ok()) << path;
        Picture picture = blank_picture(shape->width, shape->height, 0);
        EXPECT_EQ(shape->channels, 3);
        EXPECT_TRUE(read_png(path, *shape, shape->height,
                             [&](std::uint32_t y, std::span<const std::byte> row) {
                                 std::memcpy(picture.rgb.data() + y * row.size(), row.data(),
                                             row.size());
                             })
                        .ok());
        return picture;
    }
    // Draws a view of the file or URL in frames; the frames as JSON.
    Json frames_of(const std::string& file, const std::string& name,
                   const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {file,       "-o",     at(name + ".png"), "--size",
                                          "160x120",  "--eye",  "8,3,6",           "--via",
                                          "feedback", "--json", "--frames"};
        words.insert(words.end(), more.begin(), more.end());
        const Status status = run(words);
        EXPECT_TRUE(status.ok()) << status.message();
        return status.ok() ? Json::parse(out_)["views"][0]["frames"] : Json::array();
    }

    std::vector<std::byte> bytes_;
};

TEST_F(Sharpening, FirstFramesAreCoarseAndNear) {
    const Json frames = frames_of(at("g.tess"), "v");
    ASSERT_EQ(frames.size(), 2u) << frames;
    EXPECT_EQ(frames[0]["coarse"], frames[0]["touched"]);
    EXPECT_GT(frames[0]["touched"], 20);
    EXPECT_EQ(frames[0]["decoded"], 0);
    EXPECT_LT(frames[0]["bytes"], bytes_.size() / 4) << "no tile was read";
    EXPECT_EQ(frames[1]["decoded"], frames[0]["touched"]);
    EXPECT_EQ(frames[1]["coarse"], 0);
    EXPECT_LT(frames[1]["bytes"], bytes_.size());
    const Picture coarse = picture_at(at("v-frame-1.png")), sharp = picture_at(at("v.png"));
    EXPECT_TRUE(slurp(at("v-frame-2.png")) == slurp(at("v.png")));
    const double psnr = likeness_of(sharp, coarse).psnr;
    RecordProperty("coarse_psnr", std::to_string(psnr));
    EXPECT_GT(psnr, 20);
    Picture shifted = sharp; // by a tenth of its width
    std::rotate(shifted.rgb.begin(), shifted.rgb.begin() + 16 * 3, shifted.rgb.end());
    EXPECT_GT(psnr, likeness_of(sharp, shifted).psnr + 1);
    EXPECT_GT(psnr, likeness_of(sharp, blank_picture(160, 120, 128)).psnr + 3);
}

// Means of all decoded tiles, which need every tile, and those of the level give much the same first
// frame; the last one is the same.
TEST_F(Sharpening, LevelsReplaceMeansOfAllTiles) {
    const auto source = wrap_memory(bytes_);
    const auto decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder.ok());
    const ContainerReader& reader = decoder->container();
    const auto texels = decoded_level(*decoder, reader.levels().size() - 1);
    const Camera camera = camera_at({{8, 3, 6}, {0, 0, 0}}, {45, 160, 120});
    std::vector<Picture> first, last;
    for (const bool from_level : {false, true}) {
        GpuRenderOptions options{"feedback", 64, 0, {}, nullptr, {}};
        if (from_level) {
            options.coarse_level = reader.levels().back();
            options.coarse_texels = texels.get();
        }
        const auto renderer = make_gpu_renderer(reader, paper_window, grey, options);
        ASSERT_TRUE(renderer.ok()) << renderer.status().message();
        (*renderer)->watch([&](unsigned number, const DrawnFrame&, const auto& picture) -> Status {
            if (number == 1)
                first.push_back(to_picture(*picture(), SampleType::unorm8));
            return {};
        });
        last.push_back(to_picture(view_of(**renderer, camera), SampleType::unorm8));
    }
    EXPECT_EQ(first.size(), 2u);
    EXPECT_TRUE(last[0].rgb == last[1].rgb);
    const double means = likeness_of(last[0], first[0]).psnr;
    const double level = likeness_of(last[1], first[1]).psnr;
    RecordProperty("means_psnr", std::to_string(means));
    RecordProperty("level_psnr", std::to_string(level));
    EXPECT_GT(level, means - 3) << means;
    EXPECT_GT(likeness_of(first[0], first[1]).psnr, 22) << level << " " << means;
}

TEST_F(Sharpening, InStepsOnRequest) {
    frames_of(at("g.tess"), "v");
    const Json frames = frames_of(at("g.tess"), "w", {"--tiles-per-frame", "7"});
    ASSERT_GT(frames.size(), 4u);
    for (std::size_t i = 1; i < frames.size(); ++i) {
        EXPECT_LE(frames[i]["decoded"], 7);
        EXPECT_EQ(frames[i]["coarse"].get<int>(),
                  frames[i - 1]["coarse"].get<int>() - frames[i]["decoded"].get<int>());
    }
    EXPECT_EQ(frames.back()["coarse"], 0);
    EXPECT_TRUE(slurp(at("v.png")) == slurp(at("w.png")));
    EXPECT_TRUE(fs::exists(at("w-frame-" + std::to_string(frames.size()) + ".png")));
    ASSERT_TRUE(run({at("g.tess"), "-o", at("o.png"), "--orbit", "2", "--size", "40x30", "--via",
                     "feedback", "--log"})
                    .ok());
    EXPECT_EQ(out_.rfind("view 1 frame 1: ", 0), 0u) << out_;
    EXPECT_NE(out_.find("view 2 frame 1: "), std::string::npos) << out_;
    EXPECT_NE(out_.find(" coarse, 0 reads, 0 bytes\n"), std::string::npos) << out_;
    fails(ErrorCode::bad_argument, {at("g.tess"), "-o", at("o.png"), "--frames"}, "feedback");
    fails(ErrorCode::bad_argument, {at("g.tess"), "-o", at("o.png"), "--tiles-per-frame", "3"},
          "feedback");
}

// A part of a file: what is not there stays coarse.
TEST_F(Sharpening, ShowsBeginningsOfFiles) {
    const auto source = wrap_memory(bytes_);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader.ok());
    const std::uint64_t first = reader->locate(0)->offset;
    for (const std::uint64_t length : {first, first + (bytes_.size() - first) / 2}) {
        fs::copy_file(at("g.tess"), at("part.tess"), fs::copy_options::overwrite_existing);
        fs::resize_file(at("part.tess"), length);
        const Json frames = frames_of(at("part.tess"), "part", {"--allow-partial"});
        ASSERT_FALSE(frames.empty());
        EXPECT_GT(frames.back()["coarse"], 0);
        if (length == first) // nothing but coarse data
            EXPECT_EQ(frames.back()["coarse"], frames.back()["touched"]);
        else
            EXPECT_LT(frames.back()["coarse"], frames.back()["touched"]);
    }
}

#ifdef TESSERA_HTTP
TEST_F(Sharpening, ComesOverANetworkInFewRequests) {
    frames_of(at("g.tess"), "near");
    const std::string file(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    const test::RawServer server([&](const std::string& head, unsigned) {
        return test::RawServer::Answer{test::PartAnswer(head, file).text()};
    });
    const Json frames = frames_of(server.url(), "far");
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_LE(frames[0]["requests"], 3);
    EXPECT_LT(frames[0]["bytes"], bytes_.size() / 4);
    EXPECT_TRUE(slurp(at("far.png")) == slurp(at("near.png")));
    EXPECT_TRUE(slurp(at("far-frame-1.png")) == slurp(at("near-frame-1.png")));
    EXPECT_EQ(server.requests(),
              frames[0]["requests"].get<unsigned>() + frames[1]["requests"].get<unsigned>());
    ASSERT_TRUE(
        run({server.url(), "-o", at("x.png"), "--size", "40x30", "--via", "feedback"}).ok());
    EXPECT_NE(out_.find("view 1 frame 2: "), std::string::npos) << "usual for URLs\n" << out_;
    ASSERT_TRUE(run({server.url(), "-o", at("x.png"), "--size", "40x30"}).ok());
    EXPECT_NE(out_.find("view 1: "), std::string::npos) << out_;
    ASSERT_TRUE(
        run({server.url(), "-o", at("x.png"), "--size", "40x30", "--via", "feedback", "-q"}).ok());
    EXPECT_EQ(out_, "");
}

// Refusals, and answers that break off; one range fails for longer than its requests are repeated, so
// that a whole frame goes without, and the next one asks again.
TEST_F(Sharpening, OutlivesAFailingNetwork) {
    frames_of(at("g.tess"), "near");
    const std::string file(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    std::mutex mutex;
    std::map<std::uint64_t, unsigned> asked;
    std::optional<std::uint64_t> stubborn;
    const test::RawServer server([&](const std::string& head, unsigned number) {
        const std::string good = test::PartAnswer(head, file).text();
        const std::lock_guard lock(mutex);
        const std::uint64_t first = test::range_of(head)->first;
        if (number >= 3 && !stubborn)
            stubborn = first;
        const unsigned before = asked[first]++;
        if (stubborn == first ? before < 6 : number >= 3 && before == 0 && first % 2 == 0)
            return test::RawServer::Answer{
                "HTTP/1.1 503 Later\r\nRetry-After: 0\r\nContent-Length: 0\r\n\r\n"};
        if (number >= 3 && before == 0)
            return test::RawServer::Answer{good.substr(0, good.size() - 1), false};
        return test::RawServer::Answer{good};
    });
    const Json frames = frames_of(server.url(), "far");
    ASSERT_EQ(frames.size(), 3u) << frames;
    EXPECT_TRUE(frames[1].contains("trouble")) << frames;
    EXPECT_EQ(frames[1]["coarse"], frames[0]["coarse"]);
    EXPECT_FALSE(frames[2].contains("trouble")) << frames;
    EXPECT_TRUE(slurp(at("far.png")) == slurp(at("near.png")));

    // A server that never recovers ends the view with its own reason.
    const test::RawServer gone([&](const std::string& head, unsigned number) {
        return test::RawServer::Answer{
            number < 3 ? test::PartAnswer(head, file).text()
                       : "HTTP/1.1 503 Later\r\nRetry-After: 0\r\nContent-Length: 0\r\n\r\n"};
    });
    fails(ErrorCode::io,
          {gone.url(), "-o", at("x.png"), "--size", "40x30", "--via", "feedback", "-q"}, "503");
}
#endif
#endif

} // namespace
} // namespace tessera
