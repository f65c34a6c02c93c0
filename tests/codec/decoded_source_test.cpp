// Sources that read the decoded levels of a file.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "corpus/bake.h"
#include "format/container/syntax.h"
#include "tests/reference/spec_decoder.h"
#include "tests/support/random_box.h"

#include <atomic>
#include <gtest/gtest.h>
#include <thread>

namespace tessera {
namespace {

using namespace test;
namespace reference = tessera_reference;

Bytes layered_file(const Extent4& size, const Extent4& tile) {
    const auto source = corpus::make_baked_source("composed", size, 1, 1);
    EXPECT_TRUE(source.ok());
    EncodeOptions options;
    options.layers = true;
    options.tile_extent = tile;
    options.effort = 1;
    options.rate = {RateTarget::Kind::quality, 90};
    Bytes file;
    EXPECT_TRUE(encode_memory(**source, file, options).ok());
    return file;
}

// The source reads every coarse level in pieces and in few requests. The texels are those of the
// second decoder.
TEST(DecodedLevel, AgreesWithTheSecondDecoder) {
    const Bytes file = layered_file({64, 32, 16, 16}, {16, 16, 8, 8});
    std::string error;
    const auto expected = reference::decode(file, error);
    ASSERT_TRUE(expected) << error;
    const auto memory = wrap_memory(file);
    for (const bool remote : {false, true}) {
        CountingByteSource counted(*memory, remote);
        const auto decoder = Decoder::open(counted);
        ASSERT_TRUE(decoder.ok()) << decoder.status().message();
        const auto levels = decoder->container().levels();
        ASSERT_GE(levels.size(), 2u);
        for (std::size_t level = 0; level < levels.size(); ++level) {
            const auto source = decoded_level(*decoder, level);
            TextureDesc desc = decoder->desc();
            desc.size = levels[level].size;
            ASSERT_EQ(source->desc(), desc);
            const Bytes& whole = level == 0 ? expected->texels : expected->coarse[level - 1];
            counted.reset();
            Bytes texels(desc.box_bytes(Box4::whole(desc.size)));
            ASSERT_TRUE(source->read(Box4::whole(desc.size), texels).ok());
            EXPECT_TRUE(texels == whole) << level;
            if (remote && level > 0) {
                EXPECT_LE(counted.reads().size(), 2u) << "reads of the index and of all pages";
                counted.reset();
            }
            // Several threads read random boxes.
            std::vector<std::thread> threads;
            std::atomic<int> wrong{0};
            for (unsigned seed = 0; seed < 4; ++seed)
                threads.emplace_back([&, seed] {
                    Random random(seed);
                    for (int i = 0; i < 20; ++i) {
                        const Box4 box = random_box(random, desc.size);
                        Bytes got(desc.box_bytes(box)), want(got.size());
                        wrong += !source->read(box, got).ok();
                        copy_box(box, Box4::whole(desc.size), whole, box, want, desc.texel_bytes());
                        wrong += got != want;
                    }
                });
            for (std::thread& thread : threads)
                thread.join();
            EXPECT_EQ(wrong, 0) << level;
            if (remote && level > 0)
                EXPECT_TRUE(counted.reads().empty()) << "decoded tiles are kept";
        }
    }
}

// With allow_damaged, damaged tiles of a level are filled from the next coarser level or with the
// background. Without it, reading them fails.
TEST(DecodedLevel, FallsBackOnlyIfAllowed) {
    Bytes file = layered_file({64, 32, 16, 16}, {16, 16, 8, 8});
    std::uint64_t at = 0;
    std::size_t last = 0;
    {
        const auto memory = wrap_memory(file);
        const auto decoder = Decoder::open(*memory);
        ASSERT_TRUE(decoder.ok());
        last = decoder->container().levels().size() - 1;
        const std::uint64_t first = decoder->container().levels()[last].first_tile;
        for (std::uint64_t tile = first; at == 0; ++tile)
            if (const auto place = decoder->container().locate(tile); place->length > 0)
                at = place->offset;
    }
    file[at] ^= std::byte{1};
    const auto memory = wrap_memory(file);
    for (const bool allowed : {false, true}) {
        DecodeOptions options;
        options.allow_damaged = allowed;
        const auto decoder = Decoder::open(*memory, options);
        ASSERT_TRUE(decoder.ok());
        const auto source = decoded_level(*decoder, last);
        Bytes texels(source->desc().box_bytes(Box4::whole(source->desc().size)));
        const Status status = source->read(Box4::whole(source->desc().size), texels);
        EXPECT_EQ(status.ok(), allowed) << status.message();
        if (!allowed)
            EXPECT_EQ(status.code(), ErrorCode::invalid_file);
        EXPECT_EQ(decoder->fill_report().texels, 0u) << "the report counts level 0 only";
        Bytes few(3);
        const Box4 outside{source->desc().size, {9999, 9999, 9999, 9999}};
        EXPECT_EQ(source->read(outside, few).code(), ErrorCode::bad_argument);
        for (const std::size_t level : {std::size_t{0}, last + 1, last + 2}) {
            const Status refused =
                decoder->decode_coarse_box(level, {{0, 0, 0, 0}, {1, 1, 1, 1}}, few);
            EXPECT_EQ(refused.code(), ErrorCode::bad_argument);
            EXPECT_NE(refused.message().find("no coarse level"), std::string::npos) << level;
        }
    }
}

} // namespace
} // namespace tessera
