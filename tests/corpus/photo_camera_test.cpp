#include "corpus/photographs/photo_camera.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

PhotoCamera plain_camera() {
    PhotoCamera camera;
    camera.width = 200;
    camera.height = 100;
    camera.fx = 100;
    camera.fy = 50;
    camera.cx = 90;
    camera.cy = 55;
    return camera;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double precision) {
    for (glm::length_t i = 0; i < 3; ++i)
        EXPECT_NEAR(a[i], b[i], precision) << i;
}

TEST(PhotoCamera, RaysAndPlacesAreEachOthersInverse) {
    PhotoCamera camera = plain_camera();
    camera.eye = {1, 2, 3};
    expect_near(camera.direction(90, 55), {0, 0, 1}, 0);
    expect_near(camera.direction(190, 5), glm::normalize(glm::dvec3(1, -1, 1)), 1e-15);
    const auto pixel = camera.project({1 + 2, 2 - 2, 3 + 2});
    ASSERT_TRUE(pixel);
    EXPECT_DOUBLE_EQ(pixel->x, 190);
    EXPECT_DOUBLE_EQ(pixel->y, 5);
    EXPECT_FALSE(camera.project({1, 2, 3}));
    EXPECT_FALSE(camera.project({1, 2, 2.5})) << "behind the camera";
}

// The formulas of OpenCV's page on camera calibration.
TEST(PhotoCamera, DistortsAsOpenCvDoes) {
    PhotoCamera camera = plain_camera();
    camera.distortion = {.k1 = -0.2, .k2 = 0.05, .k3 = 0.01, .k4 = 0, .p1 = 0.003, .p2 = -0.004};
    const double x = 0.35, y = -0.35, r2 = x * x + y * y;
    const double radial = 1 - 0.2 * r2 + 0.05 * r2 * r2 + 0.01 * r2 * r2 * r2;
    const auto pixel = camera.project({0.7, -0.7, 2});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 90 + 100 * (x * radial + 2 * 0.003 * x * y - 0.004 * (r2 + 2 * x * x)),
                1e-12);
    EXPECT_NEAR(pixel->y, 55 + 50 * (y * radial + 0.003 * (r2 + 2 * y * y) - 2 * 0.004 * x * y),
                1e-12);
}

TEST(PhotoCamera, UndoesDistortion) {
    PhotoCamera camera = plain_camera();
    camera.distortion = {.k1 = -0.2, .k2 = 0.05, .k3 = 0.01, .k4 = -1e-3, .p1 = 3e-3, .p2 = -4e-3};
    for (const double x : {0.0, 13.5, 90.0, 200.0})
        for (const double y : {0.0, 54.0, 100.0}) {
            const auto pixel = camera.project(2.0 * camera.direction(x, y));
            ASSERT_TRUE(pixel) << x << "," << y;
            EXPECT_NEAR(pixel->x, x, 1e-9);
            EXPECT_NEAR(pixel->y, y, 1e-9);
        }
}

// r (1 - 0.3 r^2) grows up to r = 1.054; what is further out would fall into the picture again.
TEST(PhotoCamera, DrawsNothingBeyondTheFold) {
    PhotoCamera camera = plain_camera();
    camera.distortion = {.k1 = -0.3};
    EXPECT_TRUE(camera.project({1.0, 0, 1}));
    EXPECT_FALSE(camera.project({1.2, 0, 1}));
    EXPECT_FALSE(camera.project({2.5, 0, 1})) << "mirrored";
}

TEST(PhotoCamera, TurnsAreTheChangePerPixel) {
    PhotoCamera camera = plain_camera();
    camera.axes = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}; // right, down, forward
    for (const double k1 : {0.0, -0.1}) {
        camera.distortion = {.k1 = k1, .p1 = k1 / 100};
        const double x = 150.5, y = 20.5, step = 1e-4;
        const auto at = [&](double to_x, double to_y) {
            const glm::dvec3 direction = camera.direction(to_x, to_y);
            return direction / glm::dot(direction, camera.axes[2]);
        };
        const auto turns = camera.turns(camera.direction(x, y));
        expect_near(turns[0], (at(x + step, y) - at(x - step, y)) / (2 * step), 1e-9);
        expect_near(turns[1], (at(x, y + step) - at(x, y - step)) / (2 * step), 1e-9);
    }
}

TEST(PhotoCamera, ResizedCamerasSeeTheSame) {
    const PhotoCamera camera = plain_camera(), half = camera.resized(100, 50);
    EXPECT_EQ(half.width, 100u);
    EXPECT_EQ(half.height, 50u);
    expect_near(half.direction(30, 20), camera.direction(60, 40), 1e-15);
}

} // namespace
} // namespace tessera::corpus
