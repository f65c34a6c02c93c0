// Encoding and decoding in memory, and the difference between two textures.
#pragma once

#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/reconstruct/tile_decoder.h"
#include "tests/support/efforts.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/random_codes.h"

#include <cstdlib>
#include <gtest/gtest.h>

namespace tessera::test::round_trips {

struct Encoded {
    Bytes file;
    EncodeReport report;
};

inline EncodeOptions options_for(RateTarget rate, int effort = copies_effort) {
    EncodeOptions options;
    options.rate = rate;
    options.effort = effort;
    options.threads = 2;
    return options;
}

// Options: EncodeOptions or SwitchedOptions (tool_words.h).
template <class Options> Encoded encode(TexelSource& source, const Options& options) {
    Encoded encoded;
    const Result<EncodeReport> report = encode_memory(source, encoded.file, options);
    EXPECT_TRUE(report) << report.status().message();
    if (report)
        encoded.report = *report;
    return encoded;
}

inline Bytes decode(const Bytes& file, const Box4& box, Integrity integrity = Integrity::page) {
    const auto source = wrap_memory(file);
    const Result<Decoder> decoder = Decoder::open(*source);
    EXPECT_TRUE(decoder) << decoder.status().message();
    if (!decoder)
        return {};
    Bytes texels(decoder->desc().box_bytes(box));
    const Status status = decoder->decode_box(box, texels, {.threads = 2, .integrity = integrity});
    EXPECT_TRUE(status) << status.message();
    return texels;
}

inline Bytes decode_all(const Bytes& file, const TextureDesc& desc) {
    return decode(file, Box4::whole(desc.size));
}

using random_codes::code_at;

struct Difference {
    double psnr = 999;
    std::int32_t largest = 0;
};

inline Difference difference(const Bytes& a, const Bytes& b, SampleType type) {
    Difference d;
    double squares = 0;
    const std::size_t samples = a.size() / sample_bytes(type);
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < samples; ++i) {
        const std::int32_t error = std::abs(code_at(a, i, type) - code_at(b, i, type));
        d.largest = std::max(d.largest, error);
        squares += static_cast<double>(error) * error;
    }
    const double peak = type == SampleType::unorm8 ? 255 : 31743;
    if (squares > 0)
        d.psnr = 10 * std::log10(peak * peak * static_cast<double>(samples) / squares);
    return d;
}

inline Bytes crop(const MemoryTexture& texture, const Bytes& texels, const Box4& box) {
    Bytes out(texture.desc().box_bytes(box));
    copy_box(box, Box4::whole(texture.desc().size), texels, box, out, texture.desc().texel_bytes());
    return out;
}

inline constexpr SampleType types[] = {SampleType::unorm8, SampleType::half16};

inline TextureDesc describe(const Extent4& size, SampleType type = SampleType::unorm8,
                            int channels = 3) {
    return {size, type, static_cast<std::uint8_t>(channels)};
}

} // namespace tessera::test::round_trips
