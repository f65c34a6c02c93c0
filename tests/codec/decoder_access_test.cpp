// The reads that the decoder needs for a box, and its errors on damaged files.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "codec/reconstruct/tile_decoder.h"
#include "format/work.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/random_box.h"
#include "tests/support/round_trips.h"

#include <gtest/gtest.h>
#include <mutex>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

using Kind = RateTarget::Kind;

TEST(Access, OneTexelCostsThreeReadsAndItsTilesBytes) {
    const TextureDesc desc = describe({48, 48, 8, 8});
    MemoryTexture texture = named_texture(desc, "smooth");
    EncodeOptions options = options_for({Kind::quality, 90}, 1);
    options.tile_extent = {4, 4, 4, 4}; // 576 tiles in three groups of the index
    const Encoded encoded = encode(texture, options);
    const Bytes all = decode_all(encoded.file, desc);
    Random random(34);
    for (int i = 0; i < 20; ++i) {
        const auto memory = wrap_memory(encoded.file);
        CountingByteSource source(*memory);
        const Result<Decoder> decoder = Decoder::open(source);
        ASSERT_TRUE(decoder);
        Box4 box;
        for (std::size_t axis = 0; axis < 4; ++axis) {
            box.begin[axis] =
                static_cast<std::uint32_t>(random.range(0, static_cast<int>(desc.size[axis]) - 1));
            box.end[axis] = box.begin[axis] + 1;
        }
        Bytes texel(desc.texel_bytes());
        ASSERT_TRUE(decoder->decode_box(box, texel, {.threads = 1, .integrity = Integrity::tile}));
        EXPECT_EQ(texel, crop(texture, all, box));
        const auto reads = source.reads();
        ASSERT_LE(reads.size(), 3u);
        ASSERT_GT(encoded.file.size(), 2 * first_read_bytes);
        const TileGrid& grid = decoder->container().grid();
        const Result<TileLocation> place =
            decoder->container().locate(grid.number(grid.touched(box).begin));
        ASSERT_TRUE(place);
        if (place->length > 0 && place->offset + place->length > first_read_bytes) {
            EXPECT_EQ(reads.back().offset, place->offset);
            EXPECT_EQ(reads.back().length, place->length);
        }
    }
}

TEST(Access, ThreadsShareADecoder) {
    const TextureDesc desc = describe({40, 33, 9, 9});
    MemoryTexture texture = named_texture(desc, "smooth");
    const Encoded encoded = encode(texture, options_for({Kind::quality, 60}, 1));
    const Bytes all = decode_all(encoded.file, desc);
    const auto source = wrap_memory(encoded.file);
    const Result<Decoder> decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder);
    std::atomic<int> wrong{0};
    {
        JoinedThreads threads;
        for (std::uint32_t id = 0; id < 8; ++id)
            threads.start([&, id] {
                Random random(100 + id);
                for (int i = 0; i < 8; ++i) {
                    const Box4 box = random_box(random, desc.size);
                    Bytes out(desc.box_bytes(box));
                    const Status status = decoder->decode_box(
                        box, out,
                        {.threads = 1 + id % 2,
                         .integrity = id % 3 == 0 ? Integrity::tile : Integrity::page});
                    wrong += !status.ok() || out != crop(texture, all, box);
                }
            });
    }
    EXPECT_EQ(wrong, 0);
}

TEST(Access, BadBoxesAndBuffersAreRefused) {
    MemoryTexture texture = named_texture(describe({7, 5, 3, 2}), "smooth");
    const Encoded encoded = encode(texture, EncodeOptions());
    const auto source = wrap_memory(encoded.file);
    const Result<Decoder> decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder);
    Bytes out(3);
    for (const Box4& box : {Box4{{0, 0, 0, 0}, {8, 5, 3, 2}}, Box4{{0, 0, 0, 0}, {0, 1, 1, 1}},
                            Box4{{3, 0, 0, 0}, {2, 1, 1, 1}}, Box4{{7, 0, 0, 0}, {8, 1, 1, 1}},
                            Box4{{0, 0, 0, 0}, {2, 1, 1, 1}}})
        EXPECT_EQ(decoder->decode_box(box, out).code(), ErrorCode::bad_argument) << to_string(box);
}

// Collects texels and checks the order of the calls.
class CollectingSink : public TexelSink {
public:
    CollectingSink(const TextureDesc& desc, const Box4& box, Locality locality)
        : desc_(desc), box_(box), locality_(locality), texels(desc.box_bytes(box)) {}
    Locality locality() const override { return locality_; }
    Status begin_slab(const Box4& slab) override {
        slab_ = slab;
        return {};
    }
    Status write(const Box4& box, std::span<const std::byte> part) override {
        const std::lock_guard lock(mutex_);
        EXPECT_EQ(intersect(box, slab_), box);
        written += box.texels();
        copy_box(box, box, part, box_, texels, desc_.texel_bytes());
        return {};
    }
    Status finish() override {
        finished = true;
        return {};
    }

private:
    const TextureDesc desc_;
    const Box4 box_;
    const Locality locality_;
    Box4 slab_;
    std::mutex mutex_;

public:
    Bytes texels;
    std::uint64_t written = 0;
    bool finished = false;
};

TEST(Access, StreamingGivesTheSameTexels) {
    const TextureDesc desc = describe({40, 33, 9, 9}, SampleType::half16, 2);
    MemoryTexture texture = named_texture(desc, "smooth");
    const Encoded encoded = encode(texture, options_for({Kind::quality, 60}, 1));
    const Bytes all = decode_all(encoded.file, desc);
    const auto source = wrap_memory(encoded.file);
    const Result<Decoder> decoder = Decoder::open(*source);
    ASSERT_TRUE(decoder);
    for (const Locality locality :
         {Locality::any, Locality::spatial_rows, Locality::angular_cells, Locality::places})
        for (const Box4& box : {Box4::whole(desc.size), Box4{{3, 20, 2, 7}, {39, 33, 9, 9}}}) {
            CollectingSink sink(desc, box, locality);
            ASSERT_TRUE(decoder->decode(box, sink, 3));
            EXPECT_TRUE(sink.finished);
            EXPECT_EQ(sink.written, box.texels());
            EXPECT_EQ(sink.texels, crop(texture, all, box));
        }
    // A decoded file can be encoded again.
    const auto decoded = decoded_source(*decoder);
    const Encoded again = encode(*decoded, options_for({Kind::max_error, 0}, 1));
    EXPECT_EQ(decode_all(again.file, desc), all);
}

// Whether the whole file decodes. An error must blame the file: invalid_file or unsupported.
bool reads(const Bytes& file, Integrity integrity) {
    const auto source = wrap_memory(file);
    const Result<Decoder> decoder = Decoder::open(*source);
    const auto fair = [](const Status& status) {
        EXPECT_TRUE(status.code() == ErrorCode::invalid_file ||
                    status.code() == ErrorCode::unsupported)
            << static_cast<int>(status.code()) << " " << status.message();
        EXPECT_NE(status.message(), "");
        return false;
    };
    if (!decoder)
        return fair(decoder.status());
    const Box4 whole = Box4::whole(decoder->desc().size);
    if (whole.texels() > 1 << 20) {
        ADD_FAILURE() << "damaged size " << to_string(whole) << " was accepted";
        return false;
    }
    Bytes texels(decoder->desc().box_bytes(whole));
    const Status status =
        decoder->decode_box(whole, texels, {.threads = 1, .integrity = integrity});
    return status.ok() || fair(status);
}

Bytes small_file(bool corrections) {
    const TextureDesc desc = describe({13, 9, 5, 4});
    MemoryTexture texture(desc, [](int u, int v, int s, int t, int c) {
        return 0.5 + 0.5 * std::sin(u * (1 + c) + 0.7 * v * s + t);
    });
    EncodeOptions options =
        options_for(corrections ? RateTarget{Kind::max_error, 8} : RateTarget{Kind::quality, 25});
    options.tile_extent = {7, 5, 3, 2};
    return encode(texture, options).file;
}

TEST(Damage, EveryTruncationIsRefused) {
    for (const bool corrections : {false, true}) {
        Bytes file = small_file(corrections);
        ASSERT_TRUE(reads(file, Integrity::page));
        while (!file.empty()) {
            file.pop_back();
            ASSERT_FALSE(reads(file, Integrity::page)) << file.size();
            ASSERT_FALSE(reads(file, Integrity::tile)) << file.size();
        }
        file = small_file(corrections);
        file.push_back(std::byte{0});
        EXPECT_FALSE(reads(file, Integrity::page));
    }
}

TEST(Damage, EveryFlippedBitIsRefused) {
    const Bytes file = small_file(false);
    int unnoticed = 0;
    for (std::size_t bit = 0; bit < file.size() * 8; ++bit) {
        Bytes flipped = file;
        flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
        ASSERT_FALSE(reads(flipped, Integrity::page)) << "byte " << bit / 8 << " bit " << bit % 8;
        if (bit % 3 == 0)
            unnoticed += reads(flipped, Integrity::tile); // allowed, and must not crash
    }
    // The payloads are a tenth of this file. Up to a third of the flips in them leave a valid
    // stream.
    EXPECT_LT(unnoticed, static_cast<int>(file.size() * 8 / 3 / 30));
}

TEST(Damage, RandomBytesInPlaceOfAFileAreRefused) {
    Random random(36);
    const Bytes file = small_file(false);
    for (int round = 0; round < 500; ++round) {
        Bytes damaged =
            round % 2 ? random.bytes(static_cast<std::size_t>(random.range(0, 600))) : file;
        for (int i = 0; round % 2 == 0 && i < 1 + round % 20; ++i)
            damaged[random() % damaged.size()] = static_cast<std::byte>(random() & 255);
        ASSERT_TRUE(damaged == file || !reads(damaged, Integrity::page));
    }
}

} // namespace
} // namespace tessera::test
