// Files with coarse levels, and helpers that read their texels.
#pragma once

#include "codec/decoder.h"
#include "codec/encoder.h"
#include "corpus/bake.h"
#include "format/container/syntax.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>
#include <map>

namespace tessera::test::layered_files {

struct Layered {
    Bytes file;
    EncodeReport report;
};

// Bakes each scene once, because baking takes longer than encoding.
inline MemorySource& baked(const std::string& scene, const Extent4& size) {
    struct Baked {
        Bytes texels;
        std::unique_ptr<MemorySource> source;
    };
    static std::map<std::string, Baked> all;
    Baked& one = all[scene + to_string(size)];
    if (!one.source) {
        const auto scene_source = corpus::make_baked_source(scene, size, 2, 3);
        EXPECT_TRUE(scene_source.ok()) << scene_source.status().message();
        one.texels.resize((*scene_source)->desc().box_bytes(Box4::whole(size)));
        EXPECT_TRUE((*scene_source)->read(Box4::whole(size), one.texels).ok());
        one.source = std::make_unique<MemorySource>((*scene_source)->desc(), one.texels);
    }
    return *one.source;
}

inline Result<Layered> encode_scene(const char* scene, const Extent4& size, bool layers,
                                    EncodeOptions options = {}) {
    MemorySource& source = baked(scene, size);
    options.layers = layers;
    Layered result;
    auto report = encode_memory(source, result.file, options);
    if (!report.ok())
        return report.status();
    result.report = *report;
    return result;
}

inline EncodeOptions quick(double quality = 60, unsigned threads = 0) {
    EncodeOptions options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.effort = 1;
    options.threads = threads;
    options.tile_extent = {16, 16, 4, 4};
    return options;
}

inline constexpr Extent4 scene_size{96, 64, 12, 12};

// A file shared by all tests that only read it.
inline const Layered& shared_file() {
    static const Layered file = *encode_scene("composed", scene_size, true, quick());
    return file;
}

inline Bytes texels_of(const Decoder& decoder, const Box4& box, unsigned threads = 1) {
    Bytes texels(decoder.desc().box_bytes(box));
    const Status status = decoder.decode_box(box, texels, {.threads = threads});
    EXPECT_TRUE(status.ok()) << status.message();
    return texels;
}

} // namespace tessera::test::layered_files
