// Tests the scenes and compares their texels with corpus/manifest.json.
#include "corpus/intersect.h"
#include "corpus/sampling.h"
#include "format/samples.h"
#include "tests/support/corpus_support.h"
#include "tests/support/fnv1a.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace tessera::corpus {
namespace {

using namespace support;

using Bytes = std::vector<std::byte>;

TEST(Scenes, CanBeFoundByName) {
    EXPECT_EQ(scenes().size(), 8u);
    for (const SceneInfo& info : scenes()) {
        const Result<SceneInfo> found = find_scene(info.name);
        ASSERT_TRUE(found.ok());
        EXPECT_EQ(found->type, info.type);
        EXPECT_FALSE(found->description.empty());
        EXPECT_TRUE(check_desc({info.default_size, info.type, 3}).ok());
    }
    const Status status = find_scene("Composed").status();
    EXPECT_EQ(status.code(), ErrorCode::bad_argument);
    EXPECT_NE(status.message().find("composed, aliasing-near"), std::string::npos);
}

TEST(Scenes, LambertHasNoAngularVariation) {
    const Extent4 size{16, 8, 5, 4};
    const Bytes bytes = bake_all("lambert", size, 6, 3);
    for (std::size_t place = 0; place < 16 * 8; ++place)
        for (std::size_t i = 3; i < 5 * 4 * 3; ++i)
            ASSERT_EQ(bytes[place * 60 + i], bytes[place * 60 + i - 3]);
}

TEST(Scenes, GalleryHasNoEmptyTexel) {
    const Scene scene = *make_scene("gallery");
    auto random = generator(8);
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 normal = unit_vector(random);
        glm::dvec3 inwards = unit_vector(random);
        if (glm::dot(inwards, normal) > 0.0)
            inwards = -inwards;
        const Ray ray{normal * window_radius, inwards};
        const ObjectMask all = (ObjectMask{1} << scene.objects.size()) - 1;
        ASSERT_NE(nearest_hit(scene, ray, all).object, nullptr);
    }
}

struct Statistics {
    double least = infinite, most = -infinite, mean = 0.0;
};

Statistics statistics_of(const std::vector<double>& values) {
    Statistics result;
    for (const double x : values) {
        result.least = std::min(result.least, x);
        result.most = std::max(result.most, x);
        result.mean += x / static_cast<double>(values.size());
    }
    return result;
}

TEST(Scenes, LampsSpanSevenDecades) {
    const auto values = values_of(bake_all("lamps", {48, 24, 16, 16}, 1, 1), SampleType::half16);
    const Statistics range = statistics_of(values);
    EXPECT_LE(range.least, 1.1e-3);
    EXPECT_GT(range.least, 5e-4);
    EXPECT_GE(range.most, 0.99e4);
    EXPECT_LT(range.most, 4e4);
}

// The value of "key" in a line of the manifest, without quotes if it is a text.
std::string field(const std::string& line, const std::string& key) {
    const std::size_t at = line.find("\"" + key + "\": ");
    if (at == std::string::npos)
        return {};
    const std::size_t begin = at + key.size() + 4;
    return line[begin] == '"' ? line.substr(begin + 1, line.find('"', begin + 1) - begin - 1)
                              : line.substr(begin, line.find_first_of(",}", begin) - begin);
}

// The size in the manifest, repeated here so that it cannot change unnoticed.
constexpr Extent4 manifest_size{32, 16, 8, 8};

std::string manifest_line(const SceneInfo& info, const Bytes& bytes) {
    const Statistics is = statistics_of(values_of(bytes, info.type));
    char text[400];
    std::snprintf(text, sizeof text,
                  "{\"name\": \"%s\", \"sample_type\": \"%s\", \"size\": \"32x16x8x8\", "
                  "\"samples_per_texel\": 4, \"seed\": 1, \"mean\": %.6g, \"min\": %.6g, "
                  "\"max\": %.6g, \"fnv1a64\": \"%016llx\"}",
                  info.name.c_str(), info.type == SampleType::unorm8 ? "unorm8" : "half16", is.mean,
                  is.least, is.most, static_cast<unsigned long long>(test::fnv1a_64(bytes)));
    return text;
}

// The last bits of libm differ between machines and may move a ray across an edge. The test
// therefore compares statistics of the texels, and only reports a different checksum.
TEST(Scenes, MatchTheManifest) {
    std::ifstream file(std::filesystem::path(__FILE__).parent_path() /
                       "../../corpus/manifest.json");
    std::string manifest((std::istreambuf_iterator<char>(file)), {});
    for (const SceneInfo& info : scenes()) {
        const Bytes bytes = bake_all(info.name, manifest_size, 4, 1);
        const std::string actual = manifest_line(info, bytes);
        const std::size_t at = manifest.find("{\"name\": \"" + info.name + "\"");
        if (at == std::string::npos) {
            ADD_FAILURE() << "not in manifest.json:\n" << actual;
            continue;
        }
        const std::string line = manifest.substr(at, manifest.find('}', at) + 1 - at);
        const Statistics is = statistics_of(values_of(bytes, info.type));
        EXPECT_LT(is.least, is.most) << info.name << " is constant";
        EXPECT_NEAR(is.mean / std::stod(field(line, "mean")), 1.0, 0.002) << actual;
        EXPECT_NEAR(is.least, std::stod(field(line, "min")), 0.01 * is.most) << actual;
        EXPECT_NEAR(is.most / std::stod(field(line, "max")), 1.0, 0.1) << actual;
        EXPECT_EQ(field(line, "sample_type"), field(actual, "sample_type"));
        EXPECT_EQ(field(line, "size"), to_string(manifest_size));
        if (line != actual)
            std::printf("differs from the manifest, which is fine on another machine:\n%s\n",
                        actual.c_str());
    }
}

} // namespace
} // namespace tessera::corpus
