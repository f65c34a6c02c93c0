// Tests views drawn on a GPU: budgets, coarse texels, eviction, lost reads, damage.
#include "decoder_glsl/gl_view_renderer.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "format/texture.h"
#include "tests/support/rewritten_file.h"
#include "tests/support/sample_probes.h"
#include "tests/support/sampled_files.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tessera::test {
namespace {

using namespace tessera::test::sampled_files;

class GpuView : public GpuSample {};

// A camera that looks at the centre of the sphere, `degrees` around it.
ViewCamera camera_at(double degrees, std::uint32_t width = 96, std::uint32_t height = 72) {
    const double a = degrees * pi / 180;
    const auto vec = [](double x, double y, double z) {
        return std::array<float, 3>{static_cast<float>(x), static_cast<float>(y),
                                    static_cast<float>(z)};
    };
    ViewCamera camera;
    camera.eye = vec(10 * std::sin(a), 3, 10 * std::cos(a));
    const double length = std::sqrt(109.0);
    const glm::dvec3 forward{-10 * std::sin(a) / length, -3 / length, -10 * std::cos(a) / length};
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(right, forward);
    camera.forward = vec(forward.x, forward.y, forward.z);
    camera.right = vec(0.5 * right.x, 0.5 * right.y, 0.5 * right.z);
    camera.up = vec(0.375 * up.x, 0.375 * up.y, 0.375 * up.z);
    camera.radius = 3.5f;
    camera.outside = {0.25f, 0.5f, 0.75f, 1.f};
    camera.width = width;
    camera.height = height;
    return camera;
}

std::vector<float> drawn(SampledTexture& texture, GlViewRenderer& renderer,
                         const ViewCamera& camera) {
    for (int frame = 0; frame < 8; ++frame) {
        EXPECT_TRUE(renderer.draw(camera));
        const auto report = texture.update(true);
        EXPECT_TRUE(report) << report.status().message();
        if (!report || report->decoded == 0)
            break;
    }
    const auto picture = renderer.read();
    EXPECT_TRUE(picture);
    return picture ? *picture : std::vector<float>();
}

// Tiles of a view that have no slot once every tile that can be decoded has been.
std::uint32_t missing_in(SampledTexture& texture, GlViewRenderer& renderer,
                         const ViewCamera& camera) {
    for (int frame = 0; frame < 8; ++frame) {
        EXPECT_TRUE(renderer.draw(camera));
        const auto report = texture.update(true);
        if (report && report->decoded == 0)
            return report->missing;
    }
    ADD_FAILURE() << "tiles are decoded without end";
    return 0;
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(double{a[i]} - b[i]));
    return largest;
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::abs(double{a[i]} - b[i]);
    return sum / static_cast<double>(a.size());
}

// The smallest budget, in steps of 1/8 MiB, that is enough to create a cache.
std::uint64_t smallest_budget(const ContainerReader& reader) {
    for (std::uint64_t budget = 1ull << 20;; budget += 1ull << 17)
        if (SampledTexture::create(reader, with(Residency::on_feedback, true, budget)))
            return budget;
}

TEST_F(GpuView, BudgetsHoldAndAMovingCameraIsServed) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    auto whole = SampledTexture::create(file.reader(), with(Residency::on_load, true));
    ASSERT_TRUE(whole) << whole.status().message();
    auto reference = GlViewRenderer::create(*whole);
    ASSERT_TRUE(reference);

    const std::uint64_t least = smallest_budget(file.reader());
    for (const std::uint64_t budget :
         {least, least + (std::uint64_t{3} << 20), std::uint64_t{64} << 20}) {
        SCOPED_TRACE(budget);
        auto texture =
            SampledTexture::create(file.reader(), with(Residency::on_feedback, true, budget));
        ASSERT_TRUE(texture) << texture.status().message();
        EXPECT_LE(texture->bytes(), budget);
        auto renderer = GlViewRenderer::create(*texture);
        ASSERT_TRUE(renderer) << renderer.status().message();
        for (int frame = 0; frame < 24; ++frame) {
            ASSERT_TRUE(renderer->draw(camera_at(15.0 * frame)));
            const auto report = texture->update(true);
            ASSERT_TRUE(report) << report.status().message();
            EXPECT_LE(texture->bytes(), budget);
            EXPECT_LE(report->decoded, texture->cache_slots());
        }
        // When the camera stops, no more tiles are decoded.
        drawn(*texture, *renderer, camera_at(0));
        ASSERT_TRUE(renderer->draw(camera_at(0)));
        const auto still = texture->update(true);
        ASSERT_TRUE(still);
        EXPECT_EQ(still->decoded, 0u);
        const auto picture = drawn(*texture, *renderer, camera_at(0));
        const auto expected = drawn(*whole, *reference, camera_at(0));
        if (still->waiting == 0)
            EXPECT_LE(largest_difference(picture, expected), 1.0 / 255);
        else // coarse texels replace missing tiles, so the picture is complete but blurred
            EXPECT_LE(mean_difference(picture, expected), 0.1);
        if (still->waiting > 0) {
            auto enough =
                SampledTexture::create(file.reader(), with(Residency::on_feedback, true,
                                                           texture->budget_for(still->touched)));
            ASSERT_TRUE(enough) << enough.status().message();
            EXPECT_GE(enough->cache_slots(), still->touched);
        }
        EXPECT_TRUE(budget != least || still->waiting > 0) << texture->cache_slots() << " slots";
        EXPECT_TRUE(budget != 64ull << 20 || still->waiting == 0);
    }
}

TEST_F(GpuView, ASlowOrbitDecodesFewTilesAFrame) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    auto texture = SampledTexture::create(file.reader(), with(Residency::on_feedback, true));
    ASSERT_TRUE(texture);
    auto renderer = GlViewRenderer::create(*texture);
    ASSERT_TRUE(renderer);
    ASSERT_TRUE(renderer->draw(camera_at(0)));
    const auto cold = texture->update(true);
    ASSERT_TRUE(cold);
    EXPECT_GT(cold->decoded, 5u);
    std::uint32_t later = 0;
    for (int frame = 1; frame <= 10; ++frame) {
        ASSERT_TRUE(renderer->draw(camera_at(frame)));
        const auto report = texture->update(true);
        ASSERT_TRUE(report);
        EXPECT_TRUE(report->current);
        later += report->decoded;
    }
    EXPECT_LT(later, cold->decoded);
}

// The first frame of a camera that sees most of the window.
std::vector<float> first_frame(const SampledTexture& texture) {
    auto renderer = GlViewRenderer::create(texture);
    EXPECT_TRUE(renderer && renderer->draw(camera_at(200)));
    return *renderer->read();
}

TEST_F(GpuView, CoarseTexelsStandInBeforeTilesCome) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    auto whole = SampledTexture::create(file.reader(), with(Residency::on_load, true));
    auto coarse = SampledTexture::create(file.reader(), with(Residency::on_feedback, true));
    auto options = with(Residency::on_feedback, true);
    options.coarse = false;
    auto none = SampledTexture::create(file.reader(), options);
    ASSERT_TRUE(whole && coarse && none);
    const auto truth = first_frame(*whole);
    const double with_coarse = mean_difference(first_frame(*coarse), truth);
    EXPECT_LT(with_coarse, 0.06);
    EXPECT_LT(with_coarse, 0.5 * mean_difference(first_frame(*none), truth));
}

// A source that fails while a test sets a failure.
class MoodySource final : public ByteSource {
public:
    explicit MoodySource(ByteSource& inner) : inner_(inner) {}
    std::uint64_t size() const override { return inner_.size(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        if (!failure.ok())
            return failure;
        bytes += out.size();
        return inner_.read(offset, out);
    }
    bool wants_prefetch() const override { return prefetch; }
    std::string name() const override { return "moody"; }

    Status failure;
    bool prefetch = false;
    std::uint64_t bytes = 0;

private:
    ByteSource& inner_;
};

// Coarse texels come from a coarse level instead of all tiles, for both sample types.
TEST_F(GpuView, CoarseLevelsStandIn) {
    for (const auto& [type, channels, prefetch] :
         {std::tuple<SampleType, std::uint8_t, bool>{SampleType::unorm8, 3, false},
          {SampleType::half16, 4, true}}) {
        SCOPED_TRACE(int{channels});
        const Bytes file = mixed_file(type, channels, 60, true);
        const auto memory = wrap_memory(file);
        MoodySource source(*memory);
        source.prefetch = prefetch;
        const auto decoder = Decoder::open(source);
        ASSERT_TRUE(decoder) << decoder.status().message();
        const ContainerReader& reader = decoder->container();
        ASSERT_GE(reader.levels().size(), 2u);
        const auto level = decoded_level(*decoder, reader.levels().size() - 1);
        auto options = with(Residency::on_feedback, true);
        options.coarse_from = {reader.levels().back(), level.get()};
        auto texture = SampledTexture::create(reader, options);
        ASSERT_TRUE(texture) << texture.status().message();
        EXPECT_LT(source.bytes, file.size() / 4) << "no tile of the texture";
        auto whole = SampledTexture::create(reader, with(Residency::on_load, true));
        options.coarse = false;
        auto none = SampledTexture::create(reader, options);
        ASSERT_TRUE(whole && none);
        const auto truth = first_frame(*whole);
        const double near = mean_difference(first_frame(*texture), truth);
        EXPECT_LT(near, 0.06 * (type == SampleType::half16 ? 4 : 1));
        EXPECT_LT(near, 0.7 * mean_difference(first_frame(*none), truth));
    }
}

// Tiles that are read at the second attempt, whether they are requested one by one or together.
TEST_F(GpuView, LostReadsAreRepeated) {
    const Bytes file = mixed_file(SampleType::unorm8, 3, 60, true);
    const auto memory = wrap_memory(file);
    MoodySource source(*memory);
    SampledFile sound(file);
    auto whole = SampledTexture::create(sound.reader(), with(Residency::on_load, false));
    ASSERT_TRUE(whole);
    const auto truth = first_frame(*whole);
    auto options = with(Residency::on_feedback, false);
    options.coarse = false;
    for (const bool prefetch : {false, true}) {
        SCOPED_TRACE(prefetch);
        source.prefetch = prefetch;
        const auto decoder = Decoder::open(source);
        ASSERT_TRUE(decoder) << decoder.status().message();
        auto texture = SampledTexture::create(decoder->container(), options);
        ASSERT_TRUE(texture) << texture.status().message();
        auto renderer = GlViewRenderer::create(*texture);
        ASSERT_TRUE(renderer);
        for (const Status& failure : {Status(ErrorCode::io, "the line is dead"),
                                      Status(ErrorCode::runtime, "interrupted")}) {
            source.failure = failure;
            ASSERT_TRUE(renderer->draw(camera_at(200)));
            const auto report = texture->update(true);
            ASSERT_TRUE(report) << report.status().message();
            EXPECT_EQ(report->trouble.code(), failure.code());
            EXPECT_GT(report->touched, 0u);
            EXPECT_EQ(report->missing, report->touched);
            EXPECT_EQ(report->waiting, report->touched);
            EXPECT_EQ(report->decoded, 0u);
        }
        source.failure = {};
        const auto picture = drawn(*texture, *renderer, camera_at(200));
        EXPECT_LE(largest_difference(picture, truth),
                  1e-5); // without the weights of filtering hardware
        EXPECT_EQ(missing_in(*texture, *renderer, camera_at(200)), 0u) << "no tile has failed";
    }
}

TEST_F(GpuView, UpdatesThatDoNotWaitArriveALittleLater) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    auto texture = SampledTexture::create(file.reader(), with(Residency::on_feedback, true));
    auto whole = SampledTexture::create(file.reader(), with(Residency::on_load, true));
    ASSERT_TRUE(texture && whole);
    auto renderer = GlViewRenderer::create(*texture);
    auto reference = GlViewRenderer::create(*whole);
    ASSERT_TRUE(renderer && reference);
    std::uint32_t decoded = 0;
    for (int frame = 0; frame < 12; ++frame) {
        ASSERT_TRUE(renderer->draw(camera_at(30)));
        const auto report = texture->update(false);
        ASSERT_TRUE(report) << report.status().message();
        decoded += report->decoded;
    }
    EXPECT_GT(decoded, 0u);
    EXPECT_LE(largest_difference(*renderer->read(), drawn(*whole, *reference, camera_at(30))),
              1.0 / 255);
}

// The weights of sixteen texels add up to 1 except for rounding.
constexpr float most_colour = 1.000001f;

TEST_F(GpuView, DamagedTilesAreCountedAndDrawnAsBackground) {
    const Bytes good = mixed_file(SampleType::unorm8, 3, 50);
    const Bytes bad = rewritten(good, [](ContainerContents&, std::vector<Bytes>& tiles) {
        tiles[1] = Random(5).bytes(200); // does not decode, although its checksums are correct
    });
    const auto source = wrap_memory(bad);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
        SCOPED_TRACE(name_of(residency));
        auto texture = SampledTexture::create(*reader, with(residency, false));
        ASSERT_TRUE(texture) << texture.status().message();
        auto renderer = GlViewRenderer::create(*texture);
        ASSERT_TRUE(renderer);
        for (const float value : drawn(*texture, *renderer, camera_at(100)))
            ASSERT_TRUE(value >= 0 && value <= most_colour);
        EXPECT_EQ(texture->damaged_tiles(), 1u);
    }
}

// A wrong page checksum is detected while frames are drawn. The update reports it, and tiles of
// that page are never shown undecoded.
TEST_F(GpuView, PagesThatCannotBeReadLeaveTheirTilesCoarse) {
    Bytes file = mixed_file(SampleType::unorm8, 3, 50);
    file[file.size() - 100] ^= std::byte{1};
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader) << reader.status().message();
    auto options = with(Residency::on_feedback, true);
    EXPECT_FALSE(SampledTexture::create(*reader, options)) << "coarse texels read every page";
    options.coarse = false;
    auto texture = SampledTexture::create(*reader, options);
    ASSERT_TRUE(texture) << texture.status().message();
    auto renderer = GlViewRenderer::create(*texture);
    ASSERT_TRUE(renderer);
    unsigned errors = 0;
    for (int frame = 0; frame < 12; ++frame) {
        ASSERT_TRUE(renderer->draw(camera_at(30.0 * frame)));
        const auto report = texture->update(true);
        errors += !report;
        EXPECT_TRUE(report || report.status().code() == ErrorCode::invalid_file);
    }
    EXPECT_GE(errors, 1u);
    // Only the tiles of the page are lost.
    std::uint32_t lost = 0, most_missing = 0;
    for (std::uint64_t tile = 0; tile < reader->tile_count(); ++tile)
        lost += !reader->load_tile(tile).ok();
    EXPECT_GE(lost, 1u);
    EXPECT_LE(lost, 8u);
    for (int view = 0; view < 12; ++view)
        most_missing =
            std::max(most_missing, missing_in(*texture, *renderer, camera_at(30.0 * view)));
    EXPECT_EQ(most_missing, lost);
    for (const float value : drawn(*texture, *renderer, camera_at(0)))
        ASSERT_TRUE(value >= 0 && value <= most_colour);
}

// Draws the same view with a fragment shader, as an engine does.
TEST_F(GpuView, FragmentShadersDrawTheSame) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
        SCOPED_TRACE(name_of(residency));
        auto texture = SampledTexture::create(file.reader(), with(residency, false));
        ASSERT_TRUE(texture);
        auto renderer = GlViewRenderer::create(*texture);
        ASSERT_TRUE(renderer);
        const ViewCamera camera = camera_at(130);
        const auto expected = drawn(*texture, *renderer, camera); // also sets the view's uniforms
        const auto vertex = shader_source("render.vert.glsl", ShaderDialect::gl450);
        const auto fragment =
            shader_source("render.frag.glsl", ShaderDialect::gl450, texture->defines());
        ASSERT_TRUE(vertex && fragment);
        const auto program = GlProgram::graphics(*vertex, *fragment, "render");
        ASSERT_TRUE(program) << program.status().message();
        const auto target =
            GlTexture::create(TexelFormat::rgba32f, {camera.width, camera.height, 1}, "target");
        ASSERT_TRUE(target);
        GLuint framebuffer = 0, vertices = 0;
        glCreateFramebuffers(1, &framebuffer);
        glNamedFramebufferTextureLayer(framebuffer, GL_COLOR_ATTACHMENT0, target->id(), 0, 0);
        glCreateVertexArrays(1, &vertices);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        glBindVertexArray(vertices);
        glViewport(0, 0, static_cast<GLsizei>(camera.width), static_cast<GLsizei>(camera.height));
        texture->bind();
        program->use();
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        std::vector<float> upside_down(expected.size()), picture;
        ASSERT_TRUE(target->read(0, std::as_writable_bytes(std::span(upside_down))));
        const std::size_t row = std::size_t{camera.width} * 4;
        for (std::size_t y = camera.height; y-- > 0;)
            picture.insert(picture.end(),
                           upside_down.begin() + static_cast<std::ptrdiff_t>(y * row),
                           upside_down.begin() + static_cast<std::ptrdiff_t>((y + 1) * row));
        EXPECT_LE(largest_difference(picture, expected), 1e-3);
        glDeleteFramebuffers(1, &framebuffer);
        glDeleteVertexArrays(1, &vertices);
    }
}

} // namespace
} // namespace tessera::test
