// Compares coarse texels, computed from a level of the file, with their definition texel by texel.
#include "decoder_glsl/cache/coarse_cells.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/samples.h"
#include "format/tile/colour_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

namespace tessera {
namespace {

using namespace layout;

// A level whose texels are a hash of their position.
class HashedLevel final : public TexelSource {
public:
    HashedLevel(const Extent4& size, SampleType type, std::uint8_t channels)
        : desc_{size, type, channels} {}
    const TextureDesc& desc() const override { return desc_; }
    std::uint16_t sample(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t,
                         std::uint32_t c) const {
        const std::uint32_t hash = (((u * 31 + v) * 37 + s) * 41 + t * 43 + c) * 2654435761u;
        return desc_.type == SampleType::unorm8
                   ? static_cast<std::uint16_t>(hash >> 24)
                   : float_to_half(static_cast<float>(hash >> 20) / 512 - 2);
    }
    Status read(const Box4& box, std::span<std::byte> out) override {
        EXPECT_TRUE(is_inside(box, desc_.size)) << to_string(box);
        EXPECT_EQ(out.size(), desc_.box_bytes(box));
        ++reads;
        texels_read += box.texels();
        largest = std::max<std::uint64_t>(largest, out.size());
        if (reads > fail_after)
            return {ErrorCode::io, "broken"};
        std::byte* to = out.data();
        for (std::uint32_t v = box.begin[1]; v < box.end[1]; ++v)
            for (std::uint32_t u = box.begin[0]; u < box.end[0]; ++u)
                for (std::uint32_t t = box.begin[3]; t < box.end[3]; ++t)
                    for (std::uint32_t s = box.begin[2]; s < box.end[2]; ++s)
                        for (std::uint32_t c = 0; c < desc_.channels; ++c) {
                            store_sample(to, sample(u, v, s, t, c), desc_.type);
                            to += sample_bytes(desc_.type);
                        }
        return {};
    }

    std::uint64_t reads = 0, texels_read = 0, largest = 0;
    std::uint64_t fail_after = UINT64_MAX;

private:
    const TextureDesc desc_;
};

std::array<double, 4> unpacked(const std::uint32_t* word, SampleType type) {
    std::array<double, 4> value{};
    for (unsigned c = 0; c < 4; ++c)
        value[c] = type == SampleType::unorm8
                       ? (word[0] >> (8 * c) & 255) / 255.0
                       : half_to_float(static_cast<std::uint16_t>(word[c / 2] >> (16 * (c % 2))));
    return value;
}

// The mean of the level's texels over those texels of tile `box` that sampling looks up in `cell`.
std::array<double, 4> expected(const HashedLevel& source, const LevelEntry& level, const Box4& box,
                               unsigned cell) {
    const std::uint32_t wanted[4] = {cell % 4, cell / 4 % 4, cell / 16 % 2, cell / 32};
    const std::uint32_t parts[4] = {4, 4, 2, 2};
    std::vector<std::uint32_t> places[4]; // along each axis
    for (std::size_t a = 0; a < 4; ++a) {
        const std::uint32_t n = box.end[a] - box.begin[a];
        for (std::uint32_t x = 0; x < n; ++x)
            if (x * parts[a] / n == wanted[a]) // the lookup of sample_cache.glsl
                places[a].push_back(box.begin[a] + x);
        if (places[a].empty()) // no texel uses this cell
            return {-1000, 0, 0, 0};
    }
    const TextureDesc& desc = source.desc();
    std::array<double, 4> sum{};
    double count = 0;
    for (const std::uint32_t u : places[0])
        for (const std::uint32_t v : places[1])
            for (const std::uint32_t s : places[2])
                for (const std::uint32_t t : places[3]) {
                    ++count;
                    for (std::uint32_t c = 0; c < desc.channels; ++c) {
                        const std::uint16_t value =
                            source.sample(u >> level.lod(0), v >> level.lod(1), s >> level.lod(2),
                                          t >> level.lod(3), c);
                        sum[c] += desc.type == SampleType::unorm8 ? value / 255.0
                                                                  : double{half_to_float(value)};
                    }
                }
    for (double& x : sum)
        x /= count;
    switch (desc.channels) {
    case 1:
        return {sum[0], sum[0], sum[0], 1};
    case 2:
        return {sum[0], sum[0], sum[0], sum[1]};
    case 3:
        return {sum[0], sum[1], sum[2], 1};
    default:
        return sum;
    }
}

void check(const Extent4& size, const Extent4& tile, const LevelEntry& level, SampleType type,
           std::uint8_t channels) {
    SCOPED_TRACE(to_string(size) + " lods " + std::to_string(level.spatial_lod) + "," +
                 std::to_string(level.angular_lod) + " x" + std::to_string(channels));
    const TileGrid grid(size, tile);
    HashedLevel source(level.size, type, channels);
    std::uint64_t next = 0;
    const double tolerance = type == SampleType::unorm8 ? 0.501 / 255 : 4.0 / 1024;
    ASSERT_TRUE(make_coarse_cells(
        grid, level, source, [&](std::uint64_t first, std::span<const std::uint32_t> words) {
            EXPECT_EQ(first, next);
            EXPECT_EQ(words.size() % (2 * tsr_coarse_texels), 0u);
            next = first + words.size() / (2 * tsr_coarse_texels);
            for (std::uint64_t t = first; t < next; ++t)
                for (unsigned cell = 0; cell < tsr_coarse_texels; ++cell) {
                    const auto want = expected(source, level, grid.box(t), cell);
                    if (want[0] == -1000)
                        continue;
                    const auto got =
                        unpacked(&words[((t - first) * tsr_coarse_texels + cell) * 2], type);
                    for (std::size_t c = 0; c < 4; ++c)
                        EXPECT_NEAR(got[c], want[c], tolerance) << t << " " << cell << " " << c;
                }
            return Status();
        }));
    EXPECT_EQ(next, grid.tiles());
    EXPECT_EQ(source.texels_read, texel_count(level.size)) << "some texels are read twice";
}

TEST(CoarseCells, AreMeansOfTheLevelsTexels) {
    for (const auto& [spatial, angular] :
         {std::pair{0u, 1u}, {1u, 0u}, {2u, 1u}, {2u, 3u}, {5u, 4u}})
        for (const SampleType type : {SampleType::unorm8, SampleType::half16}) {
            const Extent4 size{37, 20, 9, 12};
            check(size, {16, 16, 4, 8}, coarse_level(size, spatial, angular, 0), type, 3);
        }
    const Extent4 size{9, 3, 2, 1}; // tiles with fewer texels than cells
    for (std::uint8_t channels = 1; channels <= 4; ++channels) {
        check(size, {4, 2, 1, 1}, coarse_level(size, 1, 0, 0), SampleType::unorm8, channels);
        check(size, {4, 2, 1, 1}, coarse_level(size, 0, 1, 0), SampleType::half16, channels);
    }
}

// Large levels are read in pieces, and few texels are read twice.
TEST(CoarseCells, ReadsBoundedPieces) {
    const Extent4 size{1000, 500, 40, 40};
    const LevelEntry level = coarse_level(size, 1, 1, 0); // 50 million texels
    const TileGrid grid(size, {32, 32, 8, 8});
    HashedLevel source(level.size, SampleType::unorm8, 1);
    std::uint64_t next = 0;
    ASSERT_TRUE(make_coarse_cells(grid, level, source,
                                  [&](std::uint64_t first, std::span<const std::uint32_t> words) {
                                      EXPECT_EQ(first, next);
                                      EXPECT_LE(words.size_bytes(), 8u << 20);
                                      next = first + words.size() / (2 * tsr_coarse_texels);
                                      return Status();
                                  }));
    EXPECT_EQ(next, grid.tiles());
    EXPECT_LE(source.largest, 8u << 20);
    EXPECT_GT(source.reads, 5u);
    EXPECT_LE(source.texels_read, texel_count(level.size) * 11 / 10);
}

TEST(CoarseCells, ReturnErrors) {
    const Extent4 size{1000, 500, 40, 40};
    const LevelEntry level = coarse_level(size, 2, 1, 0);
    const TileGrid grid(size, {32, 32, 8, 8});
    const auto take = [](std::uint64_t, std::span<const std::uint32_t>) { return Status(); };
    HashedLevel broken(level.size, SampleType::unorm8, 3);
    broken.fail_after = 1;
    EXPECT_EQ(make_coarse_cells(grid, level, broken, take).code(), ErrorCode::io);
    HashedLevel small(level.size, SampleType::unorm8, 1);
    EXPECT_EQ(make_coarse_cells(grid, level, small,
                                [](std::uint64_t, std::span<const std::uint32_t>) {
                                    return Status(ErrorCode::runtime, "full");
                                })
                  .code(),
              ErrorCode::runtime);
    HashedLevel other({250, 125, 20, 21}, SampleType::unorm8, 3);
    EXPECT_EQ(make_coarse_cells(grid, level, other, take).code(), ErrorCode::bad_argument);
    LevelEntry wrong = level;
    wrong.angular_lod = 40;
    EXPECT_EQ(make_coarse_cells(grid, wrong, small, take).code(), ErrorCode::bad_argument);
    EXPECT_EQ(small.reads, 1u) << "texels were read for a wrong level";
}

} // namespace
} // namespace tessera
