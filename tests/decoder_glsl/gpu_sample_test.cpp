// Sampling on the device: both residencies against the sampler on the CPU, and what surrounds
// them: budgets, coarse texels, eviction, damaged files.
#include "format/texture.h"
#include "decoder_glsl/gl_view_renderer.h"
#include "tests/support/decode_cases.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/sample_probes.h"

#include <cstring>

namespace tessera::test {
namespace {

// An open file, its texels decoded on the CPU.
class SampledFile final : public TexelLookup {
public:
    explicit SampledFile(Bytes bytes) : file(std::move(bytes)), source_(wrap_memory(file)) {
        auto opened = Decoder::open(*source_);
        EXPECT_TRUE(opened) << opened.status().message();
        decoder_.emplace(std::move(*opened));
        texels_.resize(desc().box_bytes(Box4::whole(desc().size)));
        EXPECT_TRUE(decoder_->decode_box(Box4::whole(desc().size), texels_));
    }
    const ContainerReader& reader() const { return decoder_->container(); }
    const TextureDesc& desc() const override { return decoder_->desc(); }
    Result<glm::dvec4> texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                             std::uint32_t t) override {
        const Extent4& n = desc().size;
        const std::size_t at = ((std::size_t{v} * n[0] + u) * n[3] + t) * n[2] + s;
        return texel_value(desc(), texels_.data() + at * desc().texel_bytes());
    }

    const Bytes file;

private:
    std::unique_ptr<ByteSource> source_;
    std::optional<Decoder> decoder_;
    Bytes texels_;
};

// Rough in one half, smooth in a quarter, and background in the rest: tiles of all kinds.
Bytes mixed_file(SampleType type, std::uint8_t channels, double quality, bool layers = false,
                 const Extent4& size = {80, 40, 20, 12}, const Extent4& tile = {32, 16, 8, 8}) {
    const TextureDesc desc{size, type, channels};
    const double gain = type == SampleType::half16 ? 4 : 1;
    MemoryTexture texture(desc, [&](int u, int v, int s, int t, int c) {
        if (c == 3)
            return u < 60 ? 1.0 : 0.25;
        if (u >= 40 && v >= 20)
            return 0.5 * gain;
        const double slow =
            0.5 + 0.3 * std::sin(0.2 * u + 0.3 * s + c) + 0.2 * std::cos(0.4 * t + 0.1 * v);
        const unsigned hash =
            static_cast<unsigned>(((u * 31 + v) * 37 + s) * 41 + t * 43 + c) * 2654435761u;
        return gain * (u < 40 ? 0.5 * slow + 0.5 * (hash >> 24) / 255.0 : slow);
    });
    EncodeOptions options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.tile_extent = tile;
    options.effort = 1; // predictions have tests of their own
    options.threads = 2;
    options.layers = layers;
    Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

class GpuSample : public GpuTest {
protected:
    // Colours at the probes, drawn until no tile is late.
    static std::vector<glm::vec4> sampled(SampledTexture& texture,
                                          const std::vector<Probe>& probes) {
        const auto program = compute_program("sample_points.comp.glsl", texture.defines());
        EXPECT_TRUE(program) << program.status().message();
        std::vector<glm::vec4> points;
        for (const Probe& probe : probes) {
            points.emplace_back(probe.n, 0.f);
            points.emplace_back(glm::normalize(probe.d), 0.f);
        }
        auto buffer =
            GlBuffer::create(points.size() * sizeof(glm::vec4), BufferUse::upload, "points");
        EXPECT_TRUE(buffer) << buffer.status().message();
        for (int frame = 0; frame < 8; ++frame) {
            EXPECT_TRUE(buffer->upload(0, std::as_bytes(std::span(points))));
            texture.bind();
            buffer->bind_storage(7);
            program->use();
            const auto groups = static_cast<GLuint>((probes.size() + 63) / 64);
            glDispatchCompute(std::min(groups, 1024u), (groups + 1023) / 1024, 1);
            glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            const auto report = texture.update(true);
            EXPECT_TRUE(report) << report.status().message();
            if (!report || (report->decoded == 0 && report->waiting == 0))
                break;
        }
        std::vector<glm::vec4> all(points.size()), colours;
        EXPECT_TRUE(buffer->read(0, std::as_writable_bytes(std::span(all))));
        for (std::size_t i = 0; i < all.size(); i += 2)
            colours.push_back(all[i]);
        return colours;
    }
};

// What tessera_sample() gives for a texel of fewer than four channels.
glm::dvec4 as_four(const glm::dvec4& c, int channels) {
    switch (channels) {
    case 1:
        return {c.x, c.x, c.x, 1};
    case 2:
        return {c.x, c.x, c.x, c.y};
    case 3:
        return {c.x, c.y, c.z, 1};
    default:
        return c;
    }
}

// The probes at which s means something (sample_probes.h), with what the CPU makes of them.
struct Judged {
    std::vector<Probe> probes;
    std::vector<glm::dvec4> expected;
};
Judged judge(SampledFile& file, unsigned count) {
    ProbeMaker maker(file.desc().size);
    Judged judged;
    for (unsigned i = 0; i < count; ++i) {
        const Probe probe = maker.make(i);
        const Condition condition = condition_of(file.desc().size, probe);
        if (condition.planar < 3e-4 || condition.jumps)
            continue;
        const auto colour = sample(file, probe.n, probe.d);
        EXPECT_TRUE(colour);
        judged.probes.push_back(probe);
        judged.expected.push_back(as_four(*colour, file.desc().channels));
    }
    return judged;
}

double worst_difference(const Judged& judged, const std::vector<glm::vec4>& colours) {
    double worst = 0;
    for (std::size_t i = 0; i < colours.size(); ++i)
        for (int c = 0; c < 4; ++c)
            worst = std::max(worst, std::abs(judged.expected[i][c] - colours[i][c]));
    return worst;
}

SampledTextureOptions with(Residency residency, bool filter, std::uint64_t budget = 256ull << 20) {
    SampledTextureOptions options;
    options.residency = residency;
    options.hardware_filter = filter;
    options.budget = budget;
    return options;
}

// Weights of filtering hardware have 8 bits: 1/512 off along s and along t.
constexpr double filter_precision = 2.0 / 512;

TEST_F(GpuSample, AMillionSamplesAgreeWithTheCpu) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 60));
    const Judged judged = judge(file, 1000000);
    for (const Residency residency : {Residency::on_load, Residency::on_feedback})
        for (const bool filter : {false, true}) {
            SCOPED_TRACE(std::string(name_of(residency)) + (filter ? " filtered" : ""));
            auto texture = SampledTexture::create(file.reader(), with(residency, filter));
            ASSERT_TRUE(texture) << texture.status().message();
            EXPECT_EQ(texture->damaged_tiles(), 0u);
            const double worst = worst_difference(judged, sampled(*texture, judged.probes));
            EXPECT_LE(worst, 1.0 / 255 + (filter ? filter_precision : 0));
            RecordProperty(std::string(name_of(residency)) + (filter ? "_filtered" : ""),
                           std::to_string(worst * 255));
        }
}

TEST_F(GpuSample, EveryTypeAndChannelCount) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16})
        for (std::uint8_t channels = 1; channels <= 4; ++channels) {
            SampledFile file(mixed_file(type, channels, 40));
            const Judged judged = judge(file, 4000);
            const double range = type == SampleType::half16 ? 4 : 1;
            for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
                SCOPED_TRACE(std::string(name_of(residency)) + " x" + std::to_string(channels));
                auto texture = SampledTexture::create(file.reader(), with(residency, false));
                ASSERT_TRUE(texture) << texture.status().message();
                EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)), range / 255);
            }
        }
}

// Whole textures, caches, borders and coarse texels; a small budget makes many batches.
TEST_F(GpuSample, PredictedTilesAreSampledAsOnTheCpu) {
    for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
        const std::uint8_t channels = type == SampleType::unorm8 ? 3 : 4;
        SampledFile file(random_case(50u + channels, type, channels, {64, 32, 16, 12},
                                     {32, 16, 8, 8}, 0.6, 0.005, 4, 0.6)
                             .file);
        const Judged judged = judge(file, 2000);
        double range = 1; // halves are whatever random levels make
        for (const glm::dvec4& colour : judged.expected)
            for (int c = 0; c < 4; ++c)
                range = std::max(range, std::abs(colour[c]));
        const auto check = [&](Residency residency, bool filter, std::uint64_t budget) {
            SCOPED_TRACE(std::string(name_of(residency)) + " x" + std::to_string(channels) +
                         (filter ? " filtered " : " ") + std::to_string(budget >> 10) + " KiB");
            auto texture = SampledTexture::create(file.reader(), with(residency, filter, budget));
            ASSERT_TRUE(texture) << texture.status().message();
            EXPECT_EQ(texture->damaged_tiles(), 0u);
            EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)),
                      range * (1.0 / 255 + (filter ? filter_precision : 0)));
            EXPECT_LE(texture->bytes(), budget);
        };
        check(Residency::on_load, false, 256ull << 20);
        check(Residency::on_feedback, false, 256ull << 20);
        check(Residency::on_feedback, true, 48ull << 20);
    }
}

// Tiles of sides above 32, odd ones too; some too long for borders in a cache.
TEST_F(GpuSample, LongTilesAreSampledAsOnTheCpu) {
    const auto check = [](const Bytes& bytes) {
        SampledFile file(bytes);
        SCOPED_TRACE("tiles " + to_string(file.reader().header().tile_extent));
        const Judged judged = judge(file, 2000);
        double range = 1; // halves are whatever random levels make
        for (const glm::dvec4& colour : judged.expected)
            for (int c = 0; c < 4; ++c)
                range = std::max(range, std::abs(colour[c]));
        for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
            SCOPED_TRACE(name_of(residency));
            auto texture = SampledTexture::create(file.reader(), with(residency, true));
            ASSERT_TRUE(texture) << texture.status().message();
            EXPECT_EQ(texture->damaged_tiles(), 0u);
            EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)),
                      range * (1.0 / 255 + filter_precision));
        }
    };
    check(mixed_file(SampleType::unorm8, 3, 60, false, {128, 64, 4, 4}, {64, 64, 4, 4}));
    check(mixed_file(SampleType::half16, 4, 60, false, {125, 45, 6, 5}, {63, 45, 3, 3}));
    check(mixed_file(SampleType::unorm8, 3, 60, false, {64, 2, 32, 32}, {64, 1, 32, 32}));
    // Trees of 11 levels.
    check(
        random_case(63, SampleType::unorm8, 3, {128, 2, 32, 2}, {64, 1, 32, 1}, 0.99, 0.3, 4).file);
    check(
        random_case(62, SampleType::half16, 3, {125, 45, 6, 5}, {63, 45, 5, 3}, 0.6, 0.005, 4, 0.6)
            .file);
}

// A camera that looks at the middle of the sphere from `degrees` around it.
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

// The smallest budget in steps of an eighth of a MiB that a cache can be made with.
std::uint64_t smallest_budget(const ContainerReader& reader) {
    for (std::uint64_t budget = 1ull << 20;; budget += 1ull << 17)
        if (SampledTexture::create(reader, with(Residency::on_feedback, true, budget)))
            return budget;
}

TEST_F(GpuSample, BudgetsHoldAndAMovingCameraIsServed) {
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
        // Still now: nothing more happens than what happened already.
        drawn(*texture, *renderer, camera_at(0));
        ASSERT_TRUE(renderer->draw(camera_at(0)));
        const auto still = texture->update(true);
        ASSERT_TRUE(still);
        EXPECT_EQ(still->decoded, 0u);
        const auto picture = drawn(*texture, *renderer, camera_at(0));
        const auto expected = drawn(*whole, *reference, camera_at(0));
        if (still->waiting == 0)
            EXPECT_LE(largest_difference(picture, expected), 1.0 / 255);
        else // coarse texels stand in: the picture is there, blurred
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

TEST_F(GpuSample, ASlowOrbitDecodesFewTilesAFrame) {
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

// The first frame at a camera that sees most of the window.
std::vector<float> first_frame(const SampledTexture& texture) {
    auto renderer = GlViewRenderer::create(texture);
    EXPECT_TRUE(renderer && renderer->draw(camera_at(200)));
    return *renderer->read();
}

TEST_F(GpuSample, CoarseTexelsStandInBeforeTilesCome) {
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

// Says no for as long as it is told to.
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

// A coarse level instead of all tiles, of either sample type, whose texels come as they may.
TEST_F(GpuSample, CoarseLevelsStandIn) {
    for (const auto& [type, channels, prefetch] :
         {std::tuple<SampleType, std::uint8_t, bool>{SampleType::unorm8, 3, false},
          {SampleType::half16, 4, true}}) {
        SCOPED_TRACE(int{channels});
        const Bytes file = mixed_file(type, channels, 75, true);
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

TEST_F(GpuSample, CoarseTexelsOfSomethingElseAreRefused) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    Bytes texels(file.desc().box_bytes(Box4::whole(file.desc().size)));
    MemorySource source(file.desc(), texels);
    auto options = with(Residency::on_feedback, true);
    options.coarse_from = {coarse_level(file.desc().size, 1, 1, 0), &source};
    EXPECT_EQ(SampledTexture::create(file.reader(), options).status().code(),
              ErrorCode::bad_argument);
}

// Tiles that come at a second try, whether they are asked for one by one or together.
TEST_F(GpuSample, LostReadsAreRepeated) {
    const Bytes file = mixed_file(SampleType::unorm8, 3, 75, true);
    const auto memory = wrap_memory(file);
    MoodySource source(*memory);
    SampledFile sound(file);
    auto whole = SampledTexture::create(sound.reader(), with(Residency::on_load, true));
    ASSERT_TRUE(whole);
    const auto truth = first_frame(*whole);
    auto options = with(Residency::on_feedback, true);
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
        EXPECT_LE(largest_difference(picture, truth), 1 / 255.0);
        EXPECT_EQ(texture->cache_stats()->failures, 0u);
    }
}

TEST_F(GpuSample, UpdatesThatDoNotWaitArriveALittleLater) {
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

// A file with tile 1 made of bytes that decode to nothing sound, its checksums right.
Bytes with_bad_tile(const Bytes& good) {
    const auto source = wrap_memory(good);
    const auto decoder = Decoder::open(*source);
    EXPECT_TRUE(decoder);
    const ContainerReader& reader = decoder->container();
    const FileHeader& header = reader.header();
    ContainerContents contents;
    contents.desc = header.desc;
    contents.tile_extent = header.tile_extent;
    contents.description = header.description;
    contents.colour = header.colour;
    contents.background = header.background;
    contents.codec_parameters = reader.codec_parameters();
    Random random(5);
    std::vector<Bytes> tiles(reader.tile_count());
    for (std::uint64_t i = 0; i < tiles.size(); ++i)
        EXPECT_TRUE(reader.read_tile(i, tiles[i]));
    tiles[1] = random.bytes(200);
    contents.tile = [&](std::uint64_t tile) { return std::span<const std::byte>(tiles[tile]); };
    Bytes file;
    VectorSink sink(file);
    EXPECT_TRUE(write_container(contents, sink));
    return file;
}

TEST_F(GpuSample, DamagedTilesAreCountedAndDrawnAsBackground) {
    const Bytes good = mixed_file(SampleType::unorm8, 3, 50);
    const Bytes bad = with_bad_tile(good);
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
            ASSERT_TRUE(value >= 0 && value <= 1);
        EXPECT_EQ(texture->damaged_tiles(), 1u);
    }
}

// A page whose checksum is wrong is found while frames are drawn: the update says so, and what was to
// be decoded with it is never shown undecoded.
TEST_F(GpuSample, PagesThatCannotBeReadLeaveTheirTilesCoarse) {
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
    EXPECT_GE(texture->cache_stats()->failures, 1u);
    EXPECT_LE(texture->cache_stats()->failures, 8u);
    for (const float value : drawn(*texture, *renderer, camera_at(0)))
        ASSERT_TRUE(value >= 0 && value <= 1);
}

TEST_F(GpuSample, SaysWhatDoesNotFit) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    const auto refusal = [&](const ContainerReader& reader, Residency residency,
                             std::uint64_t budget) {
        const auto texture = SampledTexture::create(reader, with(residency, true, budget));
        EXPECT_FALSE(texture);
        EXPECT_EQ(texture.status().code(), ErrorCode::unsupported);
        return texture.status().message();
    };
    EXPECT_NE(refusal(file.reader(), Residency::on_load, 1 << 20).find("budget"),
              std::string::npos);
    EXPECT_NE(refusal(file.reader(), Residency::on_feedback, 1 << 18).find("budget"),
              std::string::npos);

    const DecodeCase lossless = encoded_case("smooth", {{33, 21, 9, 6}, SampleType::unorm8, 3},
                                             {RateTarget::Kind::max_error, 0});
    SampledFile exact(lossless.file);
    const Judged judged = judge(exact, 4000);
    for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
        auto texture = SampledTexture::create(exact.reader(), with(residency, false));
        ASSERT_TRUE(texture) << texture.status().message();
        EXPECT_LE(worst_difference(judged, sampled(*texture, judged.probes)), 1.0 / 255);
    }
    EXPECT_EQ(choose_residency(file.reader(), 1ull << 30), Residency::on_load);
    EXPECT_EQ(choose_residency(file.reader(), 2ull << 20), Residency::on_feedback);
}

// The same view from a fragment shader, as an engine would draw it.
TEST_F(GpuSample, FragmentShadersDrawTheSame) {
    SampledFile file(mixed_file(SampleType::unorm8, 3, 50));
    for (const Residency residency : {Residency::on_load, Residency::on_feedback}) {
        SCOPED_TRACE(name_of(residency));
        auto texture = SampledTexture::create(file.reader(), with(residency, false));
        ASSERT_TRUE(texture);
        auto renderer = GlViewRenderer::create(*texture);
        ASSERT_TRUE(renderer);
        const ViewCamera camera = camera_at(130);
        const auto expected = drawn(*texture, *renderer, camera); // and the view's uniforms
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
