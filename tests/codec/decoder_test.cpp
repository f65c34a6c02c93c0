// The decoder's ownership of its input, its progress reports and its cancellation.
// decoder_access_test.cpp tests what it decodes.
#include "codec/decoder.h"
#include "codec/encoder.h"

#include "tests/support/memory_texture.h"
#include "tests/support/random.h"
#include "tests/support/test_folder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace tessera {
namespace {

const TextureDesc desc{{24, 24, 4, 4}, SampleType::unorm8, 1};

test::MemoryTexture texture() {
    return {desc, [](int u, int v, int s, int t, int) { return (u + v + s + t) / 60.0; }};
}

// The resulting file has 36 tiles.
EncodeOptions lossless() {
    EncodeOptions options;
    options.rate = {RateTarget::Kind::max_error, 0};
    options.effort = 1;
    options.tile_extent = {4, 4, 4, 4};
    return options;
}

test::Bytes encoded() {
    test::MemoryTexture source = texture();
    test::Bytes file;
    EXPECT_TRUE(encode_memory(source, file, lossless()));
    return file;
}

void expect_texels(const Decoder& decoder, const ReadOptions& options = {}) {
    test::Bytes texels(desc.box_bytes(Box4::whole(desc.size)));
    const Status status = decoder.decode_box(Box4::whole(desc.size), texels, options);
    EXPECT_TRUE(status) << status.message();
    EXPECT_EQ(texels, texture().texels);
}

// Clears `is_alive` when it is destroyed.
class WatchedBytes : public ByteSource {
public:
    WatchedBytes(test::Bytes bytes, bool& is_alive)
        : bytes_(std::move(bytes)), inner_(wrap_memory(bytes_)), is_alive_(is_alive) {
        is_alive_ = true;
    }
    ~WatchedBytes() override { is_alive_ = false; }
    std::uint64_t size() const override { return inner_->size(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        return inner_->read(offset, out);
    }
    std::string name() const override { return "watched"; }

private:
    const test::Bytes bytes_;
    const std::unique_ptr<ByteSource> inner_;
    bool& is_alive_;
};

TEST(Decoder, OwnsTheFileThatItOpens) {
    const std::filesystem::path folder = test::make_test_folder("decoder");
    const test::Bytes file = encoded();
    test::spit(folder / "x.tess", {reinterpret_cast<const char*>(file.data()), file.size()});
    {
        Result<Decoder> opened = Decoder::open_file((folder / "x.tess").string());
        ASSERT_TRUE(opened) << opened.status().message();
        const Decoder moved = std::move(*opened);
        expect_texels(moved);
    } // Windows does not remove the folder of an open file
    std::filesystem::remove_all(folder);
}

TEST(Decoder, OpenOfAMissingFileIsAnError) {
    const Result<Decoder> opened = Decoder::open_file("/nonexistent/none.tess");
    EXPECT_EQ(opened.status().code(), ErrorCode::io);
    EXPECT_NE(opened.status().message().find("none.tess"), std::string::npos);
}

TEST(Decoder, OwnsTheBytesThatItIsGiven) {
    bool is_alive = false;
    {
        Result<Decoder> opened = Decoder::open(std::make_unique<WatchedBytes>(encoded(), is_alive));
        ASSERT_TRUE(opened) << opened.status().message();
        const Decoder moved = std::move(*opened);
        EXPECT_TRUE(is_alive);
        expect_texels(moved);
    }
    EXPECT_FALSE(is_alive);
    test::Bytes cut = encoded();
    cut.resize(100);
    const auto failed = Decoder::open(std::make_unique<WatchedBytes>(cut, is_alive));
    EXPECT_EQ(failed.status().code(), ErrorCode::invalid_file);
    EXPECT_FALSE(is_alive);
    EXPECT_EQ(Decoder::open(std::unique_ptr<ByteSource>()).status().code(),
              ErrorCode::bad_argument);
}

TEST(Decoder, ReportsProgress) {
    bool is_alive = false;
    const auto decoder = Decoder::open(std::make_unique<WatchedBytes>(encoded(), is_alive));
    ASSERT_TRUE(decoder);
    for (const Integrity integrity : {Integrity::page, Integrity::tile}) {
        double last = -1, total = 0;
        int calls = 0;
        ReadOptions options;
        options.threads = 1;
        options.integrity = integrity;
        options.progress = [&](const char* stage, double done, double of) {
            EXPECT_STREQ(stage, "decode");
            EXPECT_GT(done, last);
            last = done;
            total = of;
            ++calls;
        };
        expect_texels(*decoder, options);
        EXPECT_EQ(total, 36);
        EXPECT_EQ(last, 36);
        EXPECT_EQ(calls, 37);
    }
}

TEST(Decoder, StopsWhenCancelled) {
    bool is_alive = false;
    const auto decoder = Decoder::open(std::make_unique<WatchedBytes>(encoded(), is_alive));
    ASSERT_TRUE(decoder);
    test::Bytes texels(desc.box_bytes(Box4::whole(desc.size)));
    for (const unsigned threads : {1u, 3u})
        for (const Integrity integrity : {Integrity::page, Integrity::tile}) {
            std::atomic<int> asked{0};
            ReadOptions options;
            options.threads = threads;
            options.integrity = integrity;
            options.cancelled = [&asked] { return ++asked > 5; };
            const Status status = decoder->decode_box(Box4::whole(desc.size), texels, options);
            EXPECT_EQ(status.code(), ErrorCode::runtime);
            EXPECT_NE(status.message().find("interrupted"), std::string::npos);
            EXPECT_LE(asked, 5 + static_cast<int>(threads));
        }
    expect_texels(*decoder);
}

TEST(EncodeStream, WritesTheFileInOrder) {
    test::MemoryTexture source = texture();
    test::Bytes got;
    const auto caller = std::this_thread::get_id();
    const auto report = encode_stream(
        source,
        [&](std::span<const std::byte> piece) -> Status {
            EXPECT_EQ(std::this_thread::get_id(), caller);
            got.insert(got.end(), piece.begin(), piece.end());
            return {};
        },
        lossless());
    ASSERT_TRUE(report) << report.status().message();
    EXPECT_EQ(report->file_bytes, got.size());
    EXPECT_EQ(got, encoded());
}

TEST(EncodeStream, FailsWithTheErrorOfItsSink) {
    test::MemoryTexture source = texture();
    const auto report = encode_stream(
        source, [](std::span<const std::byte>) { return Status(ErrorCode::io, "no room"); },
        lossless());
    EXPECT_EQ(report.status().code(), ErrorCode::io);
    EXPECT_EQ(report.status().message(), "no room");
}

} // namespace
} // namespace tessera
