// Compares drawing on the GPU with drawing on the CPU, and tests frames that sharpen progressively.
#include "codec/encoder.h"
#include "tests/support/efforts.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/rendering.h"
#include "tests/support/sample_probes.h"
#include "tests/support/test_folder.h"
#include "tools/picture/picture.h"
#include "tools/support/json_text.h"
#include "tools/verbs/command.h"
#include "tools/view/gpu_renderer.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_file.h"
#include "tools/view/view_renderer.h"
#include "tools/view/view_report.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <map>
#include <mutex>
#include <optional>
#include <unistd.h>
#ifdef TESSERA_HTTP
#include "tests/support/raw_server.h"
#endif

namespace tessera {
namespace {

using namespace tessera::test::rendering;

using test::slurp;
namespace fs = std::filesystem;

class GpuRender : public Render {
protected:
    void SetUp() override {
        Render::SetUp();
        if (test::no_gpu_asked())
            GTEST_SKIP() << "TESSERA_NO_GPU=1";
    }

    // A file with small tiles, so that many tile borders cross the picture.
    static std::vector<std::byte> small_tiles(const std::string& scene, int effort) {
        const auto source = bake(scene, {64, 32, 10, 9}, 1);
        EncodeOptions options;
        options.tile_extent = {16, 8, 8, 8};
        options.effort = effort;
        return encoded(*source, options);
    }
};

// True where single and double precision may differ: within a thousandth of the radius from the
// silhouette, where the position changes like a square root and rounding decides whether the ray
// hits; and where sample_probes.h says so.
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

// The largest difference over all well-conditioned pixels, as displayed, in steps of 8 bits.
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
        // Without and with copies.
        const bool copies = std::string(scene) == "lamps";
        const std::vector<std::byte> bytes =
            small_tiles(scene, copies ? test::copies_effort : test::quick_effort);
        const auto file = wrap_memory(bytes);
        const auto decoder = Decoder::open(*file);
        ASSERT_TRUE(decoder.ok());
        const auto texels = decoded_source(*decoder);
        const TextureDesc& desc = decoder->desc();
        const Camera cameras[] = {camera_at(aslant, {45, 80, 60}),
                                  camera_at({{0, 10, 0}, {0, 0, 0}}, {45, 60, 60}),
                                  camera_at({{-4, 0, 0}, {0, 0, 1}}, {70, 60, 48})};
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
    const std::vector<std::byte> bytes = small_tiles("composed", test::quick_effort);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok());
    const glm::dvec3 there{1, -2, 5};
    const auto here = make_gpu_renderer(decoder->container(), paper_window, grey, {"load", 64});
    const auto moved = make_gpu_renderer(decoder->container(), {there, 2 * corpus::window_radius},
                                         grey, {"load", 64});
    ASSERT_TRUE(here.ok() && moved.ok()); // one program can have two contexts
    const View a = view_of(**here, camera_at(aslant, {45, 60, 45}));
    const View b = view_of(
        **moved, camera_at({aslant.eye * 2.0 + there, aslant.look * 2.0 + there}, {45, 60, 45}));
    EXPECT_LE(worst_difference(a, b, decoder->desc().size, camera_at(aslant, {45, 60, 45}),
                               SampleType::unorm8),
              0.5);
}

TEST_F(GpuRender, LooksAsOnTheCpuFromInside) {
    const SphereWindow window{{0, 1.1, 0}, 0.4, true};
    const auto source = corpus::make_baked_source("composed", {64, 32, 16, 12}, 1, 1, window);
    ASSERT_TRUE(source.ok());
    EncodeOptions options;
    options.effort = test::quick_effort;
    options.description.proxy = Proxy::sphere_inside;
    options.description.sphere_radius = 0.4f;
    options.description.sphere_centre[1] = 1.1f;
    options.description.surface_map = SurfaceMap::sphere_longitude_latitude;
    options.description.angular_map = AngularMap::hemisphere_alpha_beta;
    const std::vector<std::byte> bytes = encoded(**source, options);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok()) << decoder.status().message();
    const auto texels = decoded_source(*decoder);
    const Camera camera = camera_at({{0.1, 1.2, 0.05}, {1, 0.4, 1.2}}, {80, 60, 45});
    const View expected =
        view_of(*make_texture_renderer(*texels, {16, 8, 8, 8}, window, grey, {}), camera);
    for (const char* via : {"load", "feedback"}) {
        const auto renderer = make_gpu_renderer(decoder->container(), window, grey, {via, 64});
        ASSERT_TRUE(renderer.ok()) << renderer.status().message();
        EXPECT_GT(likeness_of(to_picture(expected, SampleType::unorm8),
                              to_picture(view_of(**renderer, camera), SampleType::unorm8))
                      .psnr,
                  55)
            << via;
    }
}

// The budget that the remark recommends is enough for the view.
TEST_F(GpuRender, DrawsCoarselyWhatFindsNoPlace) {
    const auto source = bake("gallery", {256, 128, 8, 8}, 1);
    EncodeOptions options;
    options.tile_extent = {32, 16, 8, 8};
    options.rate = {RateTarget::Kind::quality, 20};
    options.effort = test::quick_effort;
    const std::vector<std::byte> bytes = encoded(*source, options);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok());
    const auto texels = decoded_source(*decoder);
    const Camera camera = camera_at(aslant, {45, 80, 60});
    const Picture expected = to_picture(texture_view(*texels, camera), SampleType::unorm8);
    const auto tiny = make_gpu_renderer(decoder->container(), paper_window, grey, {"feedback", 5});
    ASSERT_TRUE(tiny.ok()) << tiny.status().message();
    const View coarse = view_of(**tiny, camera);
    EXPECT_LE((*tiny)->device_use()->bytes, (5u << 20) + camera.width * camera.height * 16 + 4096);
    unsigned missing = 0, touched = 0, budget = 0, advice = 0;
    ASSERT_EQ(std::sscanf(coarse.remark.c_str(),
                          "%u of the %u tiles in view do not fit into --budget %uM "
                          "and are drawn coarsely; --budget %uM",
                          &missing, &touched, &budget, &advice),
              4)
        << coarse.remark;
    EXPECT_GT(missing, 0u);
    EXPECT_LT(missing, touched);
    EXPECT_EQ(budget, 5u);
    EXPECT_LT(advice, 20u) << "not just anything";
    EXPECT_EQ(view_of(**tiny, camera).rgb, coarse.rgb) << "a view that stands still keeps still";
    // The coarse picture resembles the expected one more than plain background does.
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
    ASSERT_TRUE(run({file, "-o", at("f.png"), "--orbit", "3", "--pixels", "40x30", "--via",
                     "feedback", "--original", file, "--json"})
                    .ok());
    const Json json = Json::parse(out_);
    EXPECT_GT(json["device"]["bytes"].get<double>(), 0);
    for (const Json& view : json["views"])
        EXPECT_GT(view["compressed_uncompressed"]["psnr"].get<double>(), 45) << view;
    ASSERT_TRUE(run({file, "-o", at("g.png"), "--pixels", "8x8", "--via", "load"}).ok());
    EXPECT_NE(out_.find("MiB held"), std::string::npos) << out_;
    fails(ErrorCode::unsupported, {file, "-o", at("h.png"), "--via", "feedback", "--budget", "1M"},
          "--via cpu");
}

// Files with coarse levels and many tiles, on a sphere.
class Sharpening : public GpuRender {
protected:
    static void SetUpTestSuite() {
        if (test::no_gpu_asked())
            return;
        ::setenv("no_proxy", "127.0.0.1", 1);
        EncodeOptions options;
        options.layers = true;
        options.tile_extent = {16, 16, 8, 8};
        options.effort = test::quick_effort;
        options.rate = {RateTarget::Kind::quality, 60};
        options.description.proxy = Proxy::sphere;
        options.description.sphere_radius = 3.5f;
        options.description.surface_map = SurfaceMap::sphere_longitude_latitude;
        options.description.angular_map = AngularMap::hemisphere_alpha_beta;
        const auto source = bake("gallery", {128, 64, 12, 12}, 1);
        bytes_ = encoded(*source, options);
    }
    static void TearDownTestSuite() { bytes_ = {}; }
    void SetUp() override {
        GpuRender::SetUp();
        if (IsSkipped())
            return;
        std::ofstream(at("g.tess"), std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes_.data()),
                   static_cast<std::streamsize>(bytes_.size()));
    }
    static Picture picture_at(const std::string& path) {
        const auto picture = read_png(path);
        EXPECT_TRUE(picture.ok()) << picture.status().message();
        return *picture;
    }
    // Draws a view of a file or URL and returns its frames as JSON.
    Json frames_of(const std::string& file, const std::string& name,
                   const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {file,       "-o",     at(name + ".png"), "--pixels",
                                          "96x72",    "--eye",  "8,3,6",           "--via",
                                          "feedback", "--json", "--frames"};
        words.insert(words.end(), more.begin(), more.end());
        const Status status = run(words);
        EXPECT_TRUE(status.ok()) << status.message();
        return status.ok() ? Json::parse(out_)["views"][0]["frames"] : Json::array();
    }

    static inline std::vector<std::byte> bytes_; // encoded once
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
    Picture shifted = sharp; // shifted by a tenth of its width
    std::rotate(shifted.rgb.begin(), shifted.rgb.begin() + 10 * 3, shifted.rgb.end());
    EXPECT_GT(psnr, likeness_of(sharp, shifted).psnr + 1);
    EXPECT_GT(psnr, likeness_of(sharp, blank_picture(96, 72, 128)).psnr + 3);
}

// The first frame is about as good from the coarse level as from means of all tiles, which need
// every tile. The last frame is the same.
TEST_F(Sharpening, LevelsReplaceMeansOfAllTiles) {
    const auto source = wrap_memory(bytes_);
    const auto decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder.ok());
    const ContainerReader& reader = decoder->container();
    const auto texels = decoded_level(*decoder, reader.levels().size() - 1);
    const Camera camera = camera_at({{8, 3, 6}, {0, 0, 0}}, {45, 96, 72});
    std::vector<Picture> first, last;
    for (const bool from_level : {false, true}) {
        GpuRenderOptions options{"feedback", 64, 0, {}, {}};
        if (from_level)
            options.coarse = {reader.levels().back(), texels.get()};
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
    ASSERT_TRUE(run({at("g.tess"), "-o", at("o.png"), "--orbit", "2", "--pixels", "40x30", "--via",
                     "feedback", "--log"})
                    .ok());
    EXPECT_EQ(out_.rfind("view 1 frame 1: ", 0), 0u) << out_;
    EXPECT_NE(out_.find("view 2 frame 1: "), std::string::npos) << out_;
    EXPECT_NE(out_.find(" coarse, 0 reads, 0 bytes\n"), std::string::npos) << out_;
    fails(ErrorCode::bad_argument, {at("g.tess"), "-o", at("o.png"), "--frames"}, "feedback");
    fails(ErrorCode::bad_argument, {at("g.tess"), "-o", at("o.png"), "--tiles-per-frame", "3"},
          "feedback");
}

// Tiles that a partial file does not have stay coarse.
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
        if (length == first) // only coarse data
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
        run({server.url(), "-o", at("x.png"), "--pixels", "40x30", "--via", "feedback"}).ok());
    EXPECT_NE(out_.find("view 1 frame 2: "), std::string::npos) << "usual for URLs\n" << out_;
    ASSERT_TRUE(run({server.url(), "-o", at("x.png"), "--pixels", "40x30"}).ok());
    EXPECT_NE(out_.find("view 1: "), std::string::npos) << out_;
    ASSERT_TRUE(
        run({server.url(), "-o", at("x.png"), "--pixels", "40x30", "--via", "feedback", "-q"})
            .ok());
    EXPECT_EQ(out_, "");
}

// The server refuses requests and cuts off responses. One range fails longer than requests are
// repeated, so that a frame lacks it and the next frame requests it again.
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

    // If the server never recovers, the view fails with the server's error.
    const test::RawServer gone([&](const std::string& head, unsigned number) {
        return test::RawServer::Answer{
            number < 3 ? test::PartAnswer(head, file).text()
                       : "HTTP/1.1 503 Later\r\nRetry-After: 0\r\nContent-Length: 0\r\n\r\n"};
    });
    fails(ErrorCode::io,
          {gone.url(), "-o", at("x.png"), "--pixels", "40x30", "--via", "feedback", "-q"}, "503");
}
#endif

} // namespace
} // namespace tessera
