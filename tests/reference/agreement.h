// Textures given by their codes, and comparisons of the library with the second decoder.
#pragma once

#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/reference/spec_decoder.h"
#include "tests/support/efforts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace tessera::test {

using Bytes = std::vector<std::byte>;
using Kind = RateTarget::Kind;
namespace reference = tessera_reference;

inline std::uint16_t half_of_code(int code) {
    return static_cast<std::uint16_t>(code < 0 ? 0x8000 | -code : code);
}

// A texture given by codes: 0..255, or the low 15 bits of a half with its sign.
class CodeTexture : public TexelSource {
public:
    using Function = std::function<double(double u, double v, double s, double t, int c)>;

    // f maps coordinates in 0..1 to values in 0..1, which span the codes 0..255, or 0..31743 of
    // halves.
    CodeTexture(TextureDesc desc, const Function& f) : desc_(desc) {
        const auto n = desc_.size;
        for (std::uint32_t v = 0; v < n[1]; ++v)
            for (std::uint32_t u = 0; u < n[0]; ++u)
                for (std::uint32_t t = 0; t < n[3]; ++t)
                    for (std::uint32_t s = 0; s < n[2]; ++s)
                        for (int c = 0; c < desc_.channels; ++c)
                            store(f((u + 0.5) / n[0], (v + 0.5) / n[1], (s + 0.5) / n[2],
                                    (t + 0.5) / n[3], c));
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        const std::size_t texel = desc_.texel_bytes();
        const std::size_t row = (box.end[2] - box.begin[2]) * texel;
        std::byte* to = out.data();
        for (std::size_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::size_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::size_t t = box.begin[3]; t < box.end[3]; ++t, to += row) {
                    const std::size_t from =
                        ((v * desc_.size[0] + u) * desc_.size[3] + t) * desc_.size[2] +
                        box.begin[2];
                    std::memcpy(to, &texels_[from * texel], row);
                }
        return {};
    }

private:
    void store(double x) {
        if (desc_.type == SampleType::unorm8) {
            texels_.push_back(static_cast<std::byte>(std::lround(std::clamp(x, 0.0, 1.0) * 255)));
            return;
        }
        const int code = static_cast<int>(std::lround(std::clamp(x, -1.0, 1.0) * 31743));
        texels_.push_back(static_cast<std::byte>(half_of_code(code) & 255));
        texels_.push_back(static_cast<std::byte>(half_of_code(code) >> 8));
    }

    TextureDesc desc_;
    Bytes texels_;
};

inline double random_unit(std::mt19937& engine) {
    return engine() / 4294967296.0;
}

inline CodeTexture::Function pattern(const std::string& name) {
    if (name == "black")
        return [](double, double, double, double, int) { return 0.0; };
    if (name == "constant")
        return [](double, double, double, double, int c) { return 0.3 + 0.2 * c; };
    const auto engine = std::make_shared<std::mt19937>(5u);
    if (name == "noise")
        return [engine](double, double, double, double, int) { return random_unit(*engine); };
    if (name == "signed") // half floats of both signs
        return
            [engine](double, double, double, double, int) { return 2 * random_unit(*engine) - 1; };
    const auto waves = [](double u, double v, double s, double t, int c) {
        return 0.5 + 0.25 * std::sin(9 * u + 7 * s + c) + 0.2 * std::cos(11 * v - 5 * t + 2 * c);
    };
    if (name == "waves")
        return waves;
    if (name == "sparse") // zero except in one corner
        return [waves](double u, double v, double s, double t, int c) {
            return u < 0.3 && v < 0.4 ? waves(u, v, s, t, c) : 0.0;
        };
    // "coloured": opaque noise along one colour direction, which gives rotated blocks
    std::array<double, 3> last{};
    return [engine, last](double, double, double, double, int c) mutable {
        if (c == 3)
            return 1.0;
        if (c == 0) {
            const double x = random_unit(*engine) - 0.5;
            last = {0.5, 0.5 + 0.6 * x, 0.5 + 0.6 * x};
        }
        return last[static_cast<std::size_t>(c)];
    };
}

inline CodeTexture make_texture(const std::string& name, Extent4 size, int channels,
                                SampleType type = SampleType::unorm8) {
    return {{size, type, static_cast<std::uint8_t>(channels)}, pattern(name)};
}

// An 8-bit RGB texture with an alpha that falls along v.
class WithAlpha : public TexelSource {
public:
    explicit WithAlpha(TexelSource& rgb) : rgb_(rgb), desc_(rgb.desc()) { desc_.channels = 4; }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        Bytes rgb(rgb_.desc().box_bytes(box));
        const Status status = rgb_.read(box, rgb);
        const std::size_t rows = box.end[1] - box.begin[1];
        const std::size_t row = box.texels() / rows;
        for (std::size_t i = 0; i < box.texels(); ++i) {
            std::memcpy(&out[4 * i], &rgb[3 * i], 3);
            out[4 * i + 3] = static_cast<std::byte>(255 - 2 * (box.begin[1] + i / row));
        }
        return status;
    }

private:
    TexelSource& rgb_;
    TextureDesc desc_;
};

inline Bytes encode(TexelSource& source, RateTarget rate, Extent4 tile_extent,
                    Metadata metadata = {}, std::optional<int> effort = {}) {
    EncodeOptions options;
    options.rate = rate;
    options.tile_extent = tile_extent;
    options.threads = 1;
    options.effort =
        effort.value_or(texel_count(source.desc().size) < 5000 ? test::copies_effort : 0);
    options.verify = false; // this test verifies the file
    options.metadata = std::move(metadata);
    Bytes file;
    const Result<EncodeReport> report = encode_memory(source, file, options);
    EXPECT_TRUE(report) << report.status().message();
    return file;
}

struct Outcome {
    bool accepted = false;
    std::string error;
    Bytes texels;
    std::map<std::string, std::string> metadata;
};

inline Outcome by_library(const Bytes& file) {
    Outcome outcome;
    const auto source = wrap_memory(file);
    const Result<Decoder> decoder = Decoder::open(*source);
    if (!decoder) {
        outcome.error = decoder.status().message();
        return outcome;
    }
    const Box4 box = Box4::whole(decoder->desc().size);
    outcome.texels.resize(decoder->desc().box_bytes(box));
    const Status status = decoder->decode_box(box, outcome.texels);
    if (!status) {
        outcome.error = status.message();
        return outcome;
    }
    outcome.accepted = true;
    for (const auto& [key, value] : decoder->container().metadata())
        outcome.metadata[key] = value;
    return outcome;
}

inline Outcome by_reference(const Bytes& file) {
    Outcome outcome;
    std::optional<reference::Decoded> decoded = reference::decode(file, outcome.error);
    if (decoded) {
        outcome.accepted = true;
        outcome.texels = std::move(decoded->texels);
        outcome.metadata = decoded->metadata;
    }
    return outcome;
}

// Expects that both decoders refuse the file, or that both accept it and agree. Returns the outcome
// of the second decoder.
inline Outcome expect_agreement(const Bytes& file, const std::string& what) {
    const Outcome library = by_library(file), specification = by_reference(file);
    EXPECT_EQ(library.accepted, specification.accepted)
        << what << "; library: '" << library.error << "', reference: '" << specification.error
        << "'";
    if (library.accepted && specification.accepted) {
        EXPECT_TRUE(library.texels == specification.texels) << what;
        EXPECT_EQ(library.metadata, specification.metadata) << what;
    }
    return specification;
}

inline void expect_decodes(const Bytes& file, const std::string& what) {
    const Outcome outcome = expect_agreement(file, what);
    EXPECT_TRUE(outcome.accepted) << what << ": " << outcome.error;
}

} // namespace tessera::test
