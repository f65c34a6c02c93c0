// Sampling on the device: the three residencies against the sampler on the CPU, and what surrounds
// them: budgets, coarse texels, eviction, damaged files.
#include "codec/memory_source.h"
#include "decoder_glsl/gl_context.h"
#include "decoder_glsl/gl_view_renderer.h"
#include "tests/decode_cases.h"
#include "tests/sample_probes.h"

#include <cstdlib>
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
Bytes mixed_file(SampleType type, std::uint8_t channels, double quality) {
    const TextureDesc desc{{80, 40, 20, 12}, type, channels};
    const double gain = type == SampleType::half16 ? 4 : 1;
    MemoryTexture texture(desc, [&](int u, int v, int s, int t, int c) {
        if (c == 3)
            return u < 60 ? 1.0 : 0.25;
        if (u >= 40 && v >= 20)
            return 0.5 * gain;
        const double slow = 0.5 + 0.3 * std::sin(0.2 * u + 0.3 * s + c) + 0.2 * std::cos(0.4 * t + 0.1 * v);
        const unsigned hash = static_cast<unsigned>(((u * 31 + v) * 37 + s) * 41 + t * 43 + c) * 2654435761u;
        return gain * (u < 40 ? 0.5 * slow + 0.5 * (hash >> 24) / 255.0 : slow);
    });
    EncodeOptions options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.tile_extent = {32, 16, 8, 8};
    options.threads = 2;
    Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

class GpuSample : public ::testing::Test {
protected:
    void SetUp() override {
        if (std::getenv("TESSERA_NO_GPU") != nullptr)
            GTEST_SKIP() << "TESSERA_NO_GPU is set";
        auto context = HeadlessContext::create();
        ASSERT_TRUE(context) << context.status().message();
        context_.emplace(std::move(*context));
    }

    // Colours at the probes, drawn until no tile is late.
    static std::vector<glm::vec4> sampled(SampledTexture& texture, const std::vector<Probe>& probes) {
        const auto program = compute_program("sample_points.comp.glsl", texture.defines());
        EXPECT_TRUE(program) << program.status().message();
        std::vector<glm::vec4> points;
        for (const Probe& probe : probes) {
            points.emplace_back(probe.n, 0.f);
            points.emplace_back(glm::normalize(probe.d), 0.f);
        }
        auto buffer = GlBuffer::create(points.size() * sizeof(glm::vec4), BufferUse::upload, "points");
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

    std::optional<HeadlessContext> context_;
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
    for (const Residency residency :
         {Residency::on_load, Residency::on_feedback, Residency::on_sample})
        for (const bool filter : {false, true}) {
            if (filter && residency == Residency::on_sample)
                continue;
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

} // namespace
} // namespace tessera::test
