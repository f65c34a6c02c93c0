// Bakes and compares boxes of texels, for the tests of the corpus.
#pragma once

#include "corpus/bake.h"
#include "format/samples.h"
#include "tests/support/random_rays.h"

#include <gtest/gtest.h>

namespace tessera::corpus::support {

using namespace tessera::test;

using Bytes = std::vector<std::byte>;

inline std::unique_ptr<TexelSource> baker(const std::string& name, const Extent4& size,
                                          unsigned samples, std::uint64_t seed) {
    auto source = make_baked_source(name, size, samples, seed);
    EXPECT_TRUE(source.ok()) << source.status().message();
    return std::move(*source);
}

inline Bytes read_box(TexelSource& source, const Box4& box) {
    Bytes bytes(source.desc().box_bytes(box));
    const Status status = source.read(box, bytes);
    EXPECT_TRUE(status.ok()) << status.message();
    return bytes;
}

inline Bytes bake_all(const std::string& name, const Extent4& size, unsigned samples,
                      std::uint64_t seed) {
    return read_box(*baker(name, size, samples, seed), Box4::whole(size));
}

inline std::vector<double> values_of(const Bytes& bytes, SampleType type) {
    std::vector<double> values;
    for (std::size_t i = 0; i < bytes.size(); i += sample_bytes(type)) {
        if (type == SampleType::unorm8) {
            values.push_back(std::to_integer<int>(bytes[i]) / 255.0);
            continue;
        }
        const unsigned low = std::to_integer<unsigned>(bytes[i]);
        const unsigned high = std::to_integer<unsigned>(bytes[i + 1]);
        values.push_back(half_to_float(static_cast<std::uint16_t>(low | high << 8)));
    }
    return values;
}

// Copies the texels of `box` from `whole`, which holds the texels of the whole texture.
inline Bytes cut_out(const Bytes& whole, const TextureDesc& desc, const Box4& box) {
    Bytes part;
    const Extent4& n = desc.size;
    const std::size_t texel = desc.texel_bytes();
    for (std::size_t v = box.begin[1]; v < box.end[1]; ++v)
        for (std::size_t u = box.begin[0]; u < box.end[0]; ++u)
            for (std::size_t t = box.begin[3]; t < box.end[3]; ++t)
                for (std::size_t s = box.begin[2]; s < box.end[2]; ++s) {
                    const std::size_t at = (((v * n[0] + u) * n[3] + t) * n[2] + s) * texel;
                    for (std::size_t i = 0; i < texel; ++i)
                        part.push_back(whole[at + i]);
                }
    return part;
}

inline constexpr double infinite = std::numeric_limits<double>::infinity();

} // namespace tessera::corpus::support
