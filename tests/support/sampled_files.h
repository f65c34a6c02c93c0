// Files that tests sample on the GPU.
#pragma once

#include "decoder_glsl/gl_view_renderer.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "decoder_glsl/shader_source.h"
#include "format/texture.h"
#include "tests/support/decode_cases.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/sample_probes.h"

#include <map>
#include <tuple>

namespace tessera::test::sampled_files {

// An open file and its texels, decoded on the CPU.
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

// Noise in one half, smooth in a quarter and background in the rest, so that there are tiles of all
// kinds.
inline Bytes make_mixed_file(SampleType type, std::uint8_t channels, double quality, bool layers,
                             const Extent4& size, const Extent4& tile) {
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
    options.effort = 0; // predictions are tested elsewhere
    options.threads = 2;
    options.layers = layers;
    Bytes file;
    const auto report = encode_memory(texture, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

// Encodes each file once.
inline const Bytes& mixed_file(SampleType type, std::uint8_t channels, double quality,
                               bool layers = false, const Extent4& size = {80, 40, 12, 10},
                               const Extent4& tile = {32, 16, 8, 8}) {
    static std::map<std::tuple<SampleType, int, double, bool, Extent4>, Bytes> all;
    Bytes& file = all[{type, channels, quality, layers, size}];
    if (file.empty())
        file = make_mixed_file(type, channels, quality, layers, size, tile);
    return file;
}

// tessera_sample() for a list of points: what tests compare with the CPU. A point is two vectors, from
// the centre and direction; the colour replaces the first.
inline Result<GlProgram> sample_points_program(const SampledTexture& texture) {
    TESSERA_TRY_ASSIGN(auto source,
                       shader_source("sample.glsl", ShaderDialect::gl450, texture.defines()));
    source += R"glsl(
layout(std430, binding = 7) buffer Points { vec4 points[]; };
layout(local_size_x = 64) in;
void main() {
    uint point = gl_WorkGroupID.y * 65536u + gl_GlobalInvocationID.x;
    if (point * 2u + 1u < uint(points.length()))
        points[point * 2u] = tessera_sample(points[point * 2u].xyz, points[point * 2u + 1u].xyz);
}
)glsl";
    return GlProgram::compute(source, "sample_points");
}

class GpuSample : public GpuTest {
protected:
    // Colours at the probes. Draws until all tiles that it needs are resident.
    static std::vector<glm::vec4> sampled(SampledTexture& texture,
                                          const std::vector<Probe>& probes) {
        const auto program = sample_points_program(texture);
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

inline SampledTextureOptions with(Residency residency, bool filter,
                                  std::uint64_t budget = 256ull << 20) {
    SampledTextureOptions options;
    options.residency = residency;
    options.hardware_filter = filter;
    options.budget = budget;
    return options;
}

} // namespace tessera::test::sampled_files
