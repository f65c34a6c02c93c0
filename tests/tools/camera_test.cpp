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

corpus::PhotoCamera photo_camera() {
    corpus::PhotoCamera photo;
    photo.width = 40;
    photo.height = 30;
    photo.fx = 50;
    photo.fy = 45;
    photo.cx = 20;
    photo.cy = 15;
    photo.eye = {1, 2, 3};
    photo.axes = {{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}}; // looks along -x with y upwards
    return photo;
}

// A pinhole with its axis in the centre needs no lens of its own.
TEST(Camera, SeesWhatAPhotographSees) {
    corpus::PhotoCamera photo = photo_camera();
    const Camera plain = make_camera(photo);
    EXPECT_FALSE(plain.lens);
    expect_near(plain.direction(20, 15), {-1, 0, 0});
    const auto expect_same_rays = [](const Camera& camera, const corpus::PhotoCamera& other) {
        for (const double x : {0.5, 13.0, 39.5})
            for (const double y : {0.5, 29.0})
                expect_near(camera.direction(x, y), other.direction(x, y));
    };
    expect_same_rays(plain, photo);
    photo.cx = 18;
    EXPECT_TRUE(make_camera(photo).lens);
    expect_same_rays(make_camera(photo), photo);
    photo.distortion = {.k1 = -0.2, .p2 = 0.01};
    expect_same_rays(make_camera(photo), photo);
}

// The steps on a plane are the distance between the places that neighbouring pixels see.
TEST(Camera, StepsFollowTheLens) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 0.3, 0.2));
    corpus::PhotoCamera photo = photo_camera();
    for (const bool is_distorted : {false, true}) {
        if (is_distorted) {
            photo.cx = 17;
            photo.distortion = {.k1 = -0.2, .p2 = 0.01};
        }
        const Camera camera = make_camera(photo);
        const auto place = [&](double x, double y) {
            const glm::dvec3 d = camera.direction(x, y);
            return camera.eye + d * (-4.0 / glm::dot(d, normal));
        };
        const double step = 1e-4;
        const auto steps = camera.steps(camera.direction(31, 6), place(31, 6), normal);
        expect_near(steps[0], (place(31 + step, 6) - place(31 - step, 6)) / (2 * step), 1e-7);
        expect_near(steps[1], (place(31, 6 + step) - place(31, 6 - step)) / (2 * step), 1e-7);
    }
}

} // namespace
} // namespace tessera
