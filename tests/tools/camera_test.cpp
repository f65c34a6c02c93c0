#include "tests/support/rendering.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

TEST(Camera, LooksAtItsTargetUpright) {
    const Lens lens{90, 200, 100};
    const Camera c = camera_at({{0, 0, 10}, {0, 0, 0}}, lens);
    expect_near(c.direction(100, 50), {0, 0, -1});
    expect_near(c.direction(100, 0), glm::normalize(glm::dvec3{0, 1, -1}));   // top: 45 degrees
    expect_near(c.direction(200, 50), glm::normalize(glm::dvec3{2, 0, -1}));  // twice as wide
    expect_near(c.direction(0, 100), glm::normalize(glm::dvec3{-2, -1, -1})); // bottom left
    expect_near(glm::normalize(camera_at({{10, 0, 0}, {0, 0, 0}}, lens).right), {0, 0, -1});
    expect_near(glm::normalize(camera_at({{0, 10, 0}, {0, 0, 0}}, lens).up), {0, 0, -1});
    expect_near(glm::normalize(camera_at({{0, 10, 0}, {0, 0, 0}}, lens).right), {1, 0, 0});
    expect_near(glm::normalize(camera_at({{0, -10, 0}, {0, 0, 0}}, lens).up), {0, 0, 1});
    expect_near(glm::normalize(camera_at({{0, -10, 0}, {0, 0, 0}}, lens).right), {1, 0, 0});
}

TEST(Camera, KnowsThePapersViews) {
    const auto views = paper_views();
    ASSERT_EQ(views.size(), 5u);
    for (const std::size_t i : {0u, 1u, 2u})
        expect_near(camera_at(views[i].pose, {}).forward, {-1, 0, 0});
    expect_near(camera_at(views[3].pose, {}).forward, {0, 0, -1});
    expect_near(camera_at(views[4].pose, {}).forward, {0, -1, 0});
}

TEST(Camera, RefusesInvalidLensesAndPoses) {
    const CameraPose pose;
    for (const Lens& lens :
         {Lens{0, 8, 8}, {180, 8, 8}, {-3, 8, 8}, {std::nan(""), 8, 8}, {45, 0, 8}, {45, 8, 16385}})
        EXPECT_EQ(make_camera(pose, lens).status().code(), ErrorCode::bad_argument);
    EXPECT_FALSE(make_camera({{1, 2, 3}, {1, 2, 3}}, {}).ok());
    EXPECT_FALSE(make_camera({{1, 2, INFINITY}, {0, 0, 0}}, {}).ok());
}

TEST(Camera, Orbits) {
    const auto poses = orbit({{10, 2, 0}, {0, 1, 0}}, 4);
    ASSERT_TRUE(poses.ok());
    expect_near((*poses)[0].eye, {10, 2, 0});
    expect_near((*poses)[1].eye, {0, 2, -10});
    expect_near((*poses)[2].eye, {-10, 2, 0});
    expect_near((*poses)[3].eye, {0, 2, 10});
    EXPECT_FALSE(orbit({{0, 10, 0}, {0, 0, 0}}, 4).ok());
}

} // namespace
} // namespace tessera
