#include "tools/lab/rd/view_poses.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(ViewPoses, SpreadsCamerasOverDirectionsAndDistances) {
    const auto cameras = spread_cameras(32, 6, 30);
    ASSERT_TRUE(cameras.ok()) << cameras.status().message();
    ASSERT_EQ(cameras->size(), 32u);
    glm::dvec3 sum{0.0};
    unsigned near = 0;
    for (const Camera& camera : *cameras) {
        const double distance = glm::length(camera.eye);
        EXPECT_GE(distance, 6);
        EXPECT_LE(distance, 30);
        near += distance < 13.4; // the geometric mean of 6 and 30
        EXPECT_LT(glm::length(camera.eye / distance + camera.forward), 1e-9)
            << "looks at the origin";
        sum += camera.eye / distance;
    }
    EXPECT_LT(glm::length(sum) / 32, 0.05);
    EXPECT_NEAR(near, 16, 2);
    for (std::size_t i = 0; i < 32; ++i)
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_GT(
                glm::length(glm::normalize((*cameras)[i].eye) - glm::normalize((*cameras)[j].eye)),
                0.3);
    EXPECT_EQ(paper_cameras()->size(), 5u);
}

} // namespace
} // namespace tessera
