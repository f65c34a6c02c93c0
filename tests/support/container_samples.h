// Containers for the tests of reader, writer and validation.
#pragma once

#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/vector_sink.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tessera::test {

// A texture with one texel per tile. The payloads are random bytes.
struct Sample {
    std::vector<Bytes> tiles;
    Bytes code;
    ContainerContents contents;

    explicit Sample(std::vector<Bytes> tile_bytes) : tiles(std::move(tile_bytes)) {
        code = Random(1).bytes(40);
        contents.desc.size = {static_cast<std::uint32_t>(tiles.size()), 1, 1, 1};
        contents.tile_extent = {1, 1, 1, 1};
        contents.codec_parameters = code;
        contents.tile = [this](std::uint64_t tile) {
            return std::span(std::as_const(tiles)[tile]);
        };
    }
    Sample(const Sample&) = delete;
    Sample& operator=(const Sample&) = delete;

    Bytes write() const {
        Bytes out;
        VectorSink sink(out);
        const Result<std::uint64_t> size = write_container(contents, sink);
        EXPECT_TRUE(size) << size.status().message();
        EXPECT_EQ(size ? *size : 0, out.size());
        const Result<std::uint64_t> planned = container_bytes(contents);
        EXPECT_EQ(planned ? *planned : 0, out.size());
        return out;
    }
};

inline std::vector<Bytes> random_tiles(std::size_t count, std::uint32_t seed,
                                       bool with_large = false) {
    Random random(seed);
    std::vector<Bytes> tiles(count);
    for (Bytes& tile : tiles)
        if (random() % 4 != 0)
            tile = random.bytes(1 + random() % 300);
    if (with_large)
        for (const std::size_t length : {65535u, 65536u, 65537u, 131072u, 200000u})
            tiles[random() % count] = random.bytes(length);
    return tiles;
}

// A small file that uses every feature: metadata, mesh, an optional section, two groups, empty
// tiles.
inline std::unique_ptr<Sample> rich_sample() {
    std::vector<Bytes> tiles = random_tiles(12, 3);
    tiles.resize(258);
    tiles[257] = Random(4).bytes(30);
    auto sample = std::make_unique<Sample>(std::move(tiles));
    static const Bytes mesh = *encode_mesh(six_charts(1, false), {}), extra = Random(6).bytes(10);
    sample->contents.description.proxy = Proxy::mesh;
    sample->contents.metadata = {{"Author", "someone"}, {"Software", "test"}};
    sample->contents.proxy_mesh = mesh;
    sample->contents.extra = {{"xtra", extra}};
    sample->contents.page_bytes = 256;
    return sample;
}

inline Status open_status(const Bytes& file) {
    return ContainerReader::open(*wrap_memory(file)).status();
}

inline bool any_fatal(const std::vector<Finding>& findings) {
    return std::ranges::any_of(findings, &Finding::fatal);
}

// True if opening the file or reading a tile with its checksum fails.
inline bool found_by_reading(const Bytes& file) {
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source);
    if (!reader)
        return true;
    Bytes tile;
    for (std::uint64_t i = 0; i < reader->tile_count(); ++i)
        if (!reader->read_tile_checked(i, tile))
            return true;
    return false;
}

using u64 = std::uint64_t;

// Reports a huge size and records the largest read, so that a test can check that no code allocates
// by the reported size.
class SparseSource : public ByteSource {
public:
    SparseSource(Bytes front, u64 size) : front_(std::move(front)), size_(size) {}
    u64 size() const override { return size_; }
    std::string name() const override { return "sparse"; }
    Status read(u64 offset, std::span<std::byte> out) override {
        largest_ = std::max<u64>(largest_, out.size());
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = offset + i < front_.size() ? front_[offset + i] : std::byte{0};
        return {};
    }
    u64 largest_ = 0;

private:
    Bytes front_;
    u64 size_;
};

} // namespace tessera::test
