// Tests the light that cameras and texels receive from a scene.
#include "corpus/intersect.h"
#include "corpus/shade.h"
#include "tests/support/angular_maps.h"
#include "tests/support/corpus_support.h"

#include <gtest/gtest.h>

namespace tessera::corpus {
namespace {

using namespace support;

using Bytes = std::vector<std::byte>;

TEST(Trace, CameraSeesThroughTheWindowOnly) {
    const Scene scene = *make_scene("composed");
    const glm::dvec3 miss = trace_scene(scene, {{10, 3.6, 0}, {-1, 0, 0}});
    EXPECT_EQ(miss, scene.background);
    EXPECT_EQ(trace_scene(scene, {{10, 0, 0}, {1, 0, 0}}), scene.background);
    EXPECT_NE(trace_scene(scene, {{10, 0, 0}, {-1, 0, 0}}), scene.background);
    // A far object shows through the window, though it lies beyond the far side.
    const Scene far = *make_scene("aliasing-far");
    EXPECT_NE(trace_scene(far, {{10, 0, 0}, {-1, 0, 0}}), far.background);
    const Scene painted = *make_scene("lambert");
    EXPECT_EQ(trace_scene(painted, {{10, 0, 0}, {-1, 0, 0}}), trace_paint(painted, {1, 0, 0}));
}

TEST(Trace, CameraAndTexelSeeTheSame) {
    const Extent4 size{12, 7, 5, 6};
    const Scene scene = *make_scene("mirror");
    const Bytes texels = bake_all("mirror", size, 1, 3);
    const TextureDesc desc{size, SampleType::unorm8, 3};
    for (std::uint32_t i = 0; i < 5; ++i) {
        const glm::dvec3 n = sphere_normal((i + 5.5) / 12, (i + 1.5) / 7);
        const glm::dvec3 d =
            test::outgoing_direction(surface_frame(n), (i + 0.5) / 5, (i + 0.5) / 6);
        const glm::dvec3 seen = trace_scene(scene, {n * window_radius + d * 4.0, -d});
        const Bytes texel =
            cut_out(texels, desc, {{i + 5, i + 1, i, i}, {i + 6, i + 2, i + 1, i + 1}});
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(std::to_integer<int>(texel[static_cast<std::size_t>(c)]), 255.0 * seen[c],
                        0.51);
    }
}

} // namespace
} // namespace tessera::corpus
