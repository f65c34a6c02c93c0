// Tests sparse files above 4 GiB: offsets must not wrap, and only requested bytes are read.
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "format/texture.h"
#include "tests/support/rewritten_file.h"
#include "tests/support/test_folder.h"
#include "tools/texture_io/raw_io.h"

#include <algorithm>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t four_gib = 1ull << 32;

// Writes a file with holes in place of zeros.
class SparseSink : public ByteSink {
public:
    explicit SparseSink(const std::string& path)
        : descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666)) {}
    ~SparseSink() override { ::close(descriptor_); }
    Status append(std::span<const std::byte> bytes) override {
        constexpr std::size_t block = 1u << 16;
        for (; !bytes.empty(); bytes = bytes.subspan(std::min(block, bytes.size()))) {
            const auto part = bytes.first(std::min(block, bytes.size()));
            const bool zeros = part[0] == std::byte{0} &&
                               std::memcmp(part.data(), part.data() + 1, part.size() - 1) == 0;
            if (!zeros && ::pwrite(descriptor_, part.data(), part.size(),
                                   static_cast<off_t>(size_)) != static_cast<ssize_t>(part.size()))
                return {ErrorCode::io, "cannot write the sparse file"};
            size_ += part.size();
        }
        return ::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0
                   ? Status()
                   : Status(ErrorCode::io, "cannot extend the sparse file");
    }

private:
    int descriptor_;
    std::uint64_t size_ = 0;
};

class LargeFiles : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("large");
        const int file = ::open(at("probe").c_str(), O_WRONLY | O_CREAT, 0666);
        struct stat info = {};
        const bool sparse = ::ftruncate(file, static_cast<off_t>(four_gib + 4096)) == 0 &&
                            ::fstat(file, &info) == 0 && info.st_blocks * 512 < 1 << 20;
        ::close(file);
        fs::remove(at("probe"));
        if (!sparse)
            GTEST_SKIP() << folder_ << ": this file system has no sparse files";
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string at(const std::string& name) const { return (folder_ / name).string(); }
    fs::path folder_;
};

std::vector<std::byte> pattern(std::size_t count) {
    std::vector<std::byte> bytes(count);
    for (std::size_t i = 0; i < count; ++i)
        bytes[i] = static_cast<std::byte>(i * 7 + i / 251);
    return bytes;
}

// 3,834 tiles in a row. 3,300 of them are junk: 1.3 MB of zeros each, the largest size of such a
// tile. Before and after them are the tiles of a small texture of 534 tiles.
TEST_F(LargeFiles, TilesBeyondFourGiB) {
    constexpr std::uint32_t junk = 3300, real = 534;
    constexpr std::uint32_t side = 4;
    const TextureDesc small{{real * side, side, side, side}, SampleType::unorm8, 1};
    const auto texels = pattern(small.box_bytes(Box4::whole(small.size)));
    MemorySource source(small, texels);
    EncodeOptions options;
    options.tile_extent = {side, side, side, side};
    options.effort = 0;
    std::vector<std::byte> coded;
    ASSERT_TRUE(encode_memory(source, coded, options));
    const auto coded_source = wrap_memory(coded);
    const auto coded_file = Decoder::open(*coded_source);
    ASSERT_TRUE(coded_file);
    const ContainerReader& from = coded_file->container();

    ContainerContents contents = test::contents_of(from);
    contents.desc.size[axis_u] = (junk + real) * side;
    contents.tile_extent = {side, 64, 32, 8};
    const std::vector<std::byte> zeros((1u << 18) + (1u << 20));
    std::vector<std::byte> tile_bytes;
    // Tiles 10 to 3309 are junk.
    contents.tile = [&](std::uint64_t tile) -> Result<std::span<const std::byte>> {
        if (tile >= 10 && tile < 10 + junk)
            return std::span<const std::byte>(zeros);
        TESSERA_TRY(from.read_tile(tile < 10 ? tile : tile - junk, tile_bytes));
        return std::span<const std::byte>(tile_bytes);
    };
    {
        SparseSink sink(at("x.tess"));
        const auto size = write_container(contents, sink);
        ASSERT_TRUE(size) << size.status().message();
        EXPECT_GT(*size, four_gib);
    }

    const auto file = open_file(at("x.tess"));
    ASSERT_TRUE(file);
    CountingByteSource counting(**file);
    const auto decoder = Decoder::open(counting);
    ASSERT_TRUE(decoder) << decoder.status().message();
    const auto far = decoder->container().locate(junk + 34);
    ASSERT_TRUE(far);
    EXPECT_GT(far->offset, four_gib);
    for (const std::uint32_t tile :
         {0u, 9u, junk + 14, junk + 27, junk + 28, junk + 283, junk + 284, junk + real - 1}) {
        const std::uint32_t u = tile * side, small_u = (tile < 10 ? tile : tile - junk) * side;
        const Box4 box{{u, 0, 0, 0}, {u + side, side, side, side}};
        const Box4 same{{small_u, 0, 0, 0}, {small_u + side, side, side, side}};
        std::vector<std::byte> got(small.box_bytes(box)), expected(got.size());
        const Status status = decoder->decode_box(box, got);
        ASSERT_TRUE(status) << tile << " " << status.message();
        ASSERT_TRUE(coded_file->decode_box(same, expected));
        EXPECT_EQ(got, expected) << tile;
        const auto loaded = decoder->container().load_tile(tile);
        ASSERT_TRUE(loaded);
        ASSERT_TRUE(from.read_tile(same.begin[0] / side, tile_bytes));
        EXPECT_TRUE(std::ranges::equal(loaded->bytes, tile_bytes));
    }
    std::uint64_t read = 0;
    for (const auto& one : counting.reads())
        read += one.length;
    EXPECT_LT(read, 1u << 20); // the junk is not read

    // A flipped bit beyond 4 GiB is located, and everything else is intact.
    const auto last = decoder->container().locate(junk + 484);
    ASSERT_TRUE(last);
    const int raw = ::open(at("x.tess").c_str(), O_RDWR);
    std::byte one{};
    EXPECT_EQ(::pread(raw, &one, 1, static_cast<off_t>(last->offset)), 1);
    one ^= std::byte{1};
    EXPECT_EQ(::pwrite(raw, &one, 1, static_cast<off_t>(last->offset)), 1);
    ::close(raw);
    const auto fresh = ContainerReader::open(**file);
    ASSERT_TRUE(fresh);
    EXPECT_EQ(fresh->load_tile(junk + 484).status().code(), ErrorCode::invalid_file);
    EXPECT_TRUE(fresh->load_tile(junk + 34));
    const auto findings = fresh->validate();
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_LE(findings[0].first_tile, junk + 484);
    EXPECT_GT(findings[0].first_tile + findings[0].tile_count, junk + 484);
}

TEST_F(LargeFiles, RawTexelsBeyondFourGiB) {
    const TextureDesc desc{{512, 256, 128, 128}, SampleType::half16, 1}; // exactly 4 GiB of texels
    const Box4 last{{500, 250, 100, 90}, {512, 256, 128, 128}};
    const Box4 first{{0, 0, 0, 0}, {3, 2, 9, 128}};
    const auto a = pattern(desc.box_bytes(last)), b = pattern(desc.box_bytes(first));
    TextureDesc larger = desc;
    larger.size[axis_v] = 300;
    Box4 beyond = last;
    beyond.begin[axis_v] = 294;
    beyond.end[axis_v] = 300;
    {
        auto sink = create_raw(at("x.gray16f"), larger);
        ASSERT_TRUE(sink.ok());
        ASSERT_TRUE((*sink)->write(beyond, a).ok());
        ASSERT_TRUE((*sink)->write(first, b).ok());
        // Whole angular images gathered in a slab, also above 4 GiB.
        const Box4 slab{{10, 298, 0, 0}, {12, 300, 128, 128}};
        ASSERT_TRUE((*sink)->begin_slab(slab).ok());
        ASSERT_TRUE((*sink)->write(slab, pattern(larger.box_bytes(slab))).ok());
        ASSERT_TRUE((*sink)->end_slab().ok());
        ASSERT_TRUE((*sink)->finish().ok());
    }
    EXPECT_GT(fs::file_size(at("x.gray16f")), four_gib);
    auto file = open_file(at("x.gray16f"));
    ASSERT_TRUE(file.ok()) << file.status().message();
    auto source = open_raw(std::move(*file), larger);
    ASSERT_TRUE(source.ok()) << source.status().message();
    const auto expect_box = [&](const Box4& box, const std::vector<std::byte>& expected) {
        std::vector<std::byte> got(larger.box_bytes(box));
        const Status status = (*source)->read(box, got);
        ASSERT_TRUE(status.ok()) << status.message();
        EXPECT_TRUE(got == expected) << to_string(box);
    };
    expect_box(beyond, a);
    expect_box(first, b);
    const Box4 slab{{10, 298, 0, 0}, {12, 300, 128, 128}};
    expect_box(slab, pattern(larger.box_bytes(slab)));
    // There is nothing at the positions that a wrapped 32-bit offset would give.
    const std::uint64_t wrapped_v = 294 - 256;
    Box4 wrong = beyond;
    wrong.begin[axis_v] = static_cast<std::uint32_t>(wrapped_v);
    wrong.end[axis_v] = static_cast<std::uint32_t>(wrapped_v + 6);
    expect_box(wrong, std::vector<std::byte>(larger.box_bytes(wrong)));
}

} // namespace
} // namespace tessera
