// The CPU renderers of textures and of scenes.
#include "codec/encoder.h"
#include "corpus/catalog.h"
#include "corpus/shade.h"
#include "tests/support/efforts.h"
#include "tests/support/rendering.h"
#include "tools/verbs/command.h"
#include "tools/view/texel_cache.h"
#include "tools/view/view_drawing.h"
#include "tools/view/view_file.h"
#include "tools/view/view_renderer.h"
#include "tools/view/view_report.h"

#include <cstring>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

// A texture in memory that counts its reads.
class CountedTexture final : public TexelSource {
public:
    explicit CountedTexture(TexelSource& source)
        : desc_(source.desc()), texels_(desc_.box_bytes(Box4::whole(desc_.size))) {
        EXPECT_TRUE(source.read(Box4::whole(desc_.size), texels_).ok());
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        ++reads_;
        copy_box(box, Box4::whole(desc_.size), texels_, box, out, desc_.texel_bytes());
        return {};
    }
    int reads() const { return reads_; }

private:
    TextureDesc desc_;
    std::vector<std::byte> texels_;
    std::atomic<int> reads_{0};
};

View truth_view(const std::string& scene, const Camera& camera, unsigned samples,
                const SphereWindow& window = paper_window) {
    return view_of(*make_truth_renderer(*corpus::make_scene(scene), window, samples, {}), camera);
}

// Where the rays of a pixel cross the picture: the mean, and the mean square of the distance from it
// along x and y.
std::array<glm::dvec3, 2> spread_of_rays(const RenderOptions& options) {
    const Camera camera = camera_at(aslant, {40, 64, 48});
    std::array<glm::dvec3, 2> moments{};
    for (const bool second : {false, true}) {
        const auto mean = mean_of_rays(
            camera, 50, 7, options, [&](const glm::dvec3& direction) -> Result<glm::dvec3> {
                const glm::dvec3 d = direction / glm::dot(direction, camera.forward);
                const glm::dvec3 at{
                    32.0 * (1.0 + glm::dot(d, camera.right) / glm::dot(camera.right, camera.right)),
                    24.0 * (1.0 - glm::dot(d, camera.up) / glm::dot(camera.up, camera.up)), 0.0};
                return second ? (at - moments[0]) * (at - moments[0]) : at;
            });
        EXPECT_TRUE(mean.ok());
        moments[second ? 1 : 0] = *mean;
    }
    return moments;
}

TEST(RaysOfAPixel, LieAroundItsCentre) {
    RenderOptions options;
    for (const unsigned rays : {1u, 2u, 3u, 4u, 5u, 16u, 64u}) {
        options.rays = rays;
        options.filter = {};
        expect_near(spread_of_rays(options)[0], {50.5, 7.5, 0.0}, 1e-9);
        options.filter = *corpus::PixelFilter::parse("blackman-harris");
        expect_near(spread_of_rays(options)[0], {50.5, 7.5, 0.0}, 1e-9);
    }
    // A square of one pixel has a variance of 1/12.
    options.filter = {};
    options.rays = 64;
    expect_near(spread_of_rays(options)[1], {1.0 / 12, 1.0 / 12, 0.0}, 0.005);
}

TEST(TextureRenderer, DrawsLazilyBakedTexturesTheSame) {
    const auto lazy = bake("mirror", {32, 16, 9, 8}, 2);
    CountedTexture whole(*lazy);
    const Camera camera = camera_at(aslant, {45, 60, 45});
    const View expected = texture_view(whole, camera, {1, 1u << 30, {}}, {32, 32, 32, 32});
    EXPECT_EQ(whole.reads(), 1);
    EXPECT_EQ(texture_view(*lazy, camera, {3, 1u << 30, {}}).rgb, expected.rgb);
    EXPECT_EQ(texture_view(*lazy, camera, {2, 1, {}}, {5, 3, 2, 1}).rgb, expected.rgb)
        << "without a cache";
    const int before = whole.reads();
    texture_view(whole, camera, {2, 1u << 30, {}}, {8, 8, 4, 4});
    EXPECT_LT(whole.reads() - before, 4 * 2 * 3 * 2) << "the far side is not read";
}

// Both use one ray per pixel, so that they differ only by the texture's resolution.
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

// The sphere encloses the observer and lies between the objects.
TEST(TextureRenderer, ApproachesTheTruthFromInside) {
    const SphereWindow window{{0, 1.1, 0}, 0.4, true};
    const Camera camera = camera_at({{0.1, 1.2, 0.05}, {1, 0.4, 1.2}}, {80, 40, 30});
    const Picture truth = to_picture(truth_view("composed", camera, 1, window), SampleType::unorm8);
    const auto psnr = [&](const Extent4& size) {
        const auto source = corpus::make_baked_source("composed", size, 1, 1, window);
        const auto renderer = make_texture_renderer(**source, {2, 2, 2, 2}, window, grey, {});
        EXPECT_EQ(renderer->render(camera_at(aslant, {45, 4, 3})).status().code(),
                  ErrorCode::bad_argument)
            << "an eye outside the sphere";
        return likeness_of(truth, to_picture(view_of(*renderer, camera), SampleType::unorm8)).psnr;
    };
    const double coarse = psnr({32, 16, 8, 8}), fine = psnr({8192, 4096, 2048, 2048});
    EXPECT_GT(fine, coarse + 10);
    EXPECT_GT(fine, 30);
}

TEST(TextureRenderer, ReadsACompressedFile) {
    const auto source = bake("composed", {32, 16, 8, 8}, 2);
    EncodeOptions options;
    options.rate = {RateTarget::Kind::max_error, 0};
    options.effort = test::quick_effort;
    const std::vector<std::byte> bytes = encoded(*source, options);
    const auto file = wrap_memory(bytes);
    const auto decoder = Decoder::open(*file);
    ASSERT_TRUE(decoder.ok());
    const auto texels = decoded_source(*decoder);
    const Camera camera = camera_at(aslant, {45, 60, 45});
    EXPECT_EQ(texture_view(*texels, camera, {}, decoder->container().grid().tile_extent()).rgb,
              texture_view(*source, camera).rgb);
}

TEST(TextureRenderer, NeedsAnEyeOutsideTheSphere) {
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
    // The same picture with the sphere scaled by two and moved.
    const glm::dvec3 there{1, -2, 5};
    const Camera moved =
        camera_at({aslant.eye * 2.0 + there, aslant.look * 2.0 + there}, {45, 21, 15});
    const View other = truth_view("composed", moved, 1, {there, 2 * corpus::window_radius});
    for (std::size_t i = 0; i < view.rgb.size(); ++i)
        EXPECT_NEAR(view.rgb[i], other.rgb[i], 1e-6);
}

} // namespace
} // namespace tessera
