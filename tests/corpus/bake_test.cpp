// Tests that baking gives the same bytes for any division into boxes.
#include "corpus/bake.h"
#include "corpus/intersect.h"
#include "corpus/sampling.h"
#include "corpus/shade.h"
#include "tests/support/corpus_support.h"

#include <gtest/gtest.h>
#include <thread>

namespace tessera::corpus {
namespace {

using namespace support;

using Bytes = std::vector<std::byte>;

// Bakes single texels with every object as a candidate, for comparison.
TEST(Bake, CullingNeverChangesATexel) {
    auto random = generator(10);
    for (const SceneInfo& info : scenes())
        for (const Extent4& size : {Extent4{24, 14, 6, 7}, Extent4{512, 256, 32, 32}}) {
            const Scene scene = *make_scene(info.name);
            if (scene.painted)
                continue;
            const auto source = baker(info.name, size, 5, 21);
            const Sampler sampler(size, 5, 21);
            for (int i = 0; i < 2000; ++i) {
                Box4 box;
                Angles centre;
                for (std::size_t a = 0; a < 4; ++a) {
                    box.begin[a] = static_cast<std::uint32_t>(random() % size[a]);
                    box.end[a] = box.begin[a] + 1;
                    centre[a] = sampler.centre(static_cast<int>(a), box.begin[a]);
                }
                const std::uint64_t place = std::uint64_t{box.begin[1]} * size[0] + box.begin[0];
                const Jitter rotation =
                    sampler.rotation((place * size[3] + box.begin[3]) * size[2] + box.begin[2]);
                glm::dvec3 sum{0.0};
                for (unsigned k = 0; k < 5; ++k)
                    sum += trace(scene, window_ray({}, sampler.angles(centre, k, rotation)));
                const std::vector<double> texel = values_of(read_box(*source, box), info.type);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double expected = sum[static_cast<glm::length_t>(c)] / 5;
                    const double scale = info.type == SampleType::unorm8 ? 1.0 : expected;
                    ASSERT_NEAR(texel[c], expected, scale / 500)
                        << info.name << ' ' << to_string(box);
                }
            }
        }
}

TEST(Bake, SameBytesForAnyBoxPartition) {
    const Extent4 size{11, 9, 6, 5};
    for (const SceneInfo& info : scenes()) {
        const auto source = baker(info.name, size, 3, 42);
        const Bytes whole = read_box(*source, Box4::whole(size));
        auto random = generator(6);
        for (int i = 0; i < 40; ++i) {
            Box4 box;
            for (std::size_t a = 0; a < 4; ++a) {
                box.begin[a] = static_cast<std::uint32_t>(random() % size[a]);
                box.end[a] = box.begin[a] + 1 +
                             static_cast<std::uint32_t>(random() % (size[a] - box.begin[a]));
            }
            ASSERT_EQ(read_box(*source, box), cut_out(whole, source->desc(), box)) << info.name;
        }
    }
}

TEST(Bake, SameBytesFromManyThreads) {
    const Extent4 size{16, 8, 6, 6};
    const auto source = baker("gallery", size, 4, 1);
    const Bytes whole = read_box(*source, Box4::whole(size));
    std::vector<Bytes> rows(size[1]);
    std::vector<std::thread> threads;
    for (std::uint32_t v = 0; v < size[1]; ++v)
        threads.emplace_back([&, v] {
            rows[v] = read_box(*source, {{0, v, 0, 0}, {size[0], v + 1, size[2], size[3]}});
        });
    for (std::thread& thread : threads)
        thread.join();
    Bytes joined;
    for (const Bytes& row : rows)
        joined.insert(joined.end(), row.begin(), row.end());
    EXPECT_EQ(joined, whole);
}

TEST(Bake, SeedDecidesTheBytes) {
    const Extent4 size{16, 8, 6, 6};
    EXPECT_EQ(bake_all("gallery", size, 4, 7), bake_all("gallery", size, 4, 7));
    EXPECT_NE(bake_all("gallery", size, 4, 7), bake_all("gallery", size, 4, 8));
    EXPECT_EQ(bake_all("gallery", size, 1, 7), bake_all("gallery", size, 1, 8)); // the centre
}

TEST(Bake, SizesOfOneAndOddSizes) {
    for (const SceneInfo& info : scenes())
        for (const Extent4& size : {Extent4{1, 1, 1, 1}, Extent4{1, 3, 5, 1}, Extent4{3, 1, 1, 7}})
            EXPECT_EQ(bake_all(info.name, size, 3, 0).size(),
                      texel_count(size) * 3 * sample_bytes(info.type));
}

TEST(Bake, DescribesItsTexture) {
    const auto source = baker("lamps", {4, 2, 3, 5}, 1, 0);
    EXPECT_EQ(source->desc(), (TextureDesc{{4, 2, 3, 5}, SampleType::half16, 3}));
    EXPECT_EQ(source->locality(), Locality::any);
    EXPECT_FALSE(source->cheap_to_reread());
}

TEST(Bake, RefusesBadArguments) {
    const auto code = [](const std::string& name, const Extent4& size, unsigned samples) {
        return make_baked_source(name, size, samples, 0).status().code();
    };
    EXPECT_EQ(code("nowhere", {4, 4, 4, 4}, 1), ErrorCode::bad_argument);
    EXPECT_EQ(code("", {4, 4, 4, 4}, 1), ErrorCode::bad_argument);
    EXPECT_EQ(code("composed", {0, 4, 4, 4}, 1), ErrorCode::bad_argument);
    EXPECT_EQ(code("composed", {4, 4, 4, max_extent + 1}, 1), ErrorCode::bad_argument);
    EXPECT_EQ(code("composed", {max_extent, max_extent, max_extent, 2}, 1),
              ErrorCode::bad_argument);
    EXPECT_EQ(code("composed", {4, 4, 4, 4}, 0), ErrorCode::bad_argument);
    EXPECT_EQ(code("composed", {4, 4, 4, 4}, max_samples_per_texel + 1), ErrorCode::bad_argument);
    EXPECT_EQ(code("composed", {4, 4, 4, 4}, max_samples_per_texel), ErrorCode::ok);
    // The largest sizes are accepted, because the source allocates nothing.
    EXPECT_EQ(code("composed", {max_extent, max_extent, 16, 16}, 1), ErrorCode::ok);
}

TEST(Bake, RefusesBadBoxes) {
    const auto source = baker("composed", {4, 4, 4, 4}, 1, 0);
    Bytes bytes(3);
    EXPECT_EQ(source->read({{4, 0, 0, 0}, {5, 1, 1, 1}}, bytes).code(), ErrorCode::bad_argument);
    EXPECT_EQ(source->read({{1, 0, 0, 0}, {1, 1, 1, 1}}, bytes).code(), ErrorCode::bad_argument);
    EXPECT_EQ(source->read({{0, 0, 0, 0}, {2, 1, 1, 1}}, bytes).code(), ErrorCode::bad_argument);
    EXPECT_TRUE(source->read({{0, 0, 0, 0}, {1, 1, 1, 1}}, bytes).ok());
}

} // namespace
} // namespace tessera::corpus
