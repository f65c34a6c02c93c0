// The surfaces of fits without a mesh: what rays show of them, and where they are estimated to lie.
#include "corpus/fit/texture_field.h"
#include "corpus/fit/view_surfaces.h"
#include "format/sampler.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <random>

namespace {

using namespace tessera;
using namespace tessera::corpus;

// A camera of 100x80 pixels at `eye` that looks at `target`.
PosedPhotograph looking_at(const glm::dvec3& eye, const glm::dvec3& target) {
    PosedPhotograph photograph;
    photograph.name = "p";
    PhotoCamera& camera = photograph.camera;
    camera.width = 100;
    camera.height = 80;
    camera.fx = camera.fy = 120;
    camera.cx = 50;
    camera.cy = 40;
    camera.eye = eye;
    const glm::dvec3 forward = glm::normalize(target - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    camera.axes = glm::dmat3(right, glm::cross(forward, right), forward);
    return photograph;
}

glm::dvec3 random_unit(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

// The dense weights of a sample's taps.
std::vector<double> weights_of(const TextureField& field, const PhotoSample& sample) {
    std::vector<double> weights(field.places() * field.texels_per_place());
    const FieldTaps seen = taps(field, sample);
    for (unsigned k = 0; k < seen.count; ++k)
        weights[seen.first[k] / 3] += static_cast<double>(seen.weight[k]);
    return weights;
}

TEST(SeenSphere, ShowsTheTexelsOfTheSampler) {
    const glm::dvec3 centre(1, 2, 3);
    const SeenSphere sphere(centre, 2);
    std::mt19937 random(1);
    for (const std::array<std::uint32_t, 2>& sides :
         {std::array<std::uint32_t, 2>{8, 6}, {6, 1}, {1, 4}}) {
        const TextureField field =
            make_sphere_field(2 * sides[0], sides[0], {sides[1], sides[1]}, 1.0);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 eye = centre + 5.0 * random_unit(random);
            const glm::dvec3 d = glm::normalize(centre + 1.9 * random_unit(random) - eye);
            const auto sample = sphere.seen(eye, d);
            ASSERT_TRUE(sample.has_value());
            const glm::dvec3 from = eye - centre;
            const double b = glm::dot(from, d);
            const double distance = -b - std::sqrt(b * b - glm::dot(from, from) + 4);
            std::vector<double> expected(field.places() * field.texels_per_place());
            for (const WeightedTexel& t : sample_footprint(
                     {2 * sides[0], sides[0], sides[1], sides[1]}, from + distance * d, -d))
                expected[((t.v * 2 * sides[0] + t.u) * sides[1] + t.t) * sides[1] + t.s] +=
                    t.weight;
            const std::vector<double> found = weights_of(field, *sample);
            for (std::size_t k = 0; k < found.size(); ++k)
                ASSERT_NEAR(found[k], expected[k], 2e-3) << k;
        }
    }
    EXPECT_FALSE(sphere.seen({1, 2, 9}, {0, 0, 1}).has_value());
    EXPECT_FALSE(sphere.seen(centre, {0, 0, 1}).has_value()); // from inside
}

TEST(SeenWindow, ShowsTheCamerasAroundTheRay) {
    PhotoWindow window;
    window.centre = {10, 0, 0};
    // Right is -z and the cameras stand towards +x.
    window.axes = glm::dmat3(glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0));
    window.width = 4;
    window.height = 2;
    window.distance = 5;
    window.spacing_x = 0.5;
    window.spacing_y = 0.25;
    window.cameras = {3, 2};
    const SeenWindow seen(window);
    const TextureField field = make_window_field(8, 4, {3, 2});
    // From camera (2, 0) to the centre of pixel (1, 3): FORMAT.md 5.3.
    const glm::dvec3 eye(15, 0.125, -0.5), place(10, -0.75, 1.25);
    const auto sample = seen.seen(eye, glm::normalize(place - eye));
    ASSERT_TRUE(sample.has_value());
    const std::vector<double> weights = weights_of(field, *sample);
    EXPECT_NEAR(weights[((3 * 8 + 1) * 2 + 0) * 3 + 2], 1.0, 1e-5);
    // Further out than the last camera, its view continues.
    const glm::dvec3 beside(15, 0.125, -3);
    EXPECT_NEAR(
        weights_of(field, *seen.seen(beside, glm::normalize(
                                                 place - beside)))[((3 * 8 + 1) * 2 + 0) * 3 + 2],
        1.0, 1e-5);
    EXPECT_FALSE(seen.seen(eye, {1, 0, 0}).has_value());
    EXPECT_FALSE(seen.seen(eye, glm::normalize(glm::dvec3(-5, 2, 0))).has_value());
}

TEST(ViewField, SeesOneTexelAtItsCentre) {
    for (const TextureField& field :
         {make_sphere_field(8, 4, {5, 5}, 0.7), make_window_field(6, 3, {3, 2})})
        for (std::size_t texel = 0; texel < field.places() * field.texels_per_place(); ++texel)
            ASSERT_NEAR(weights_of(field, centre_of_texel(field, texel))[texel], 1.0, 2e-3)
                << texel;
}

TEST(ViewField, KeepsNeighboursOfASphereAlikeAroundIt) {
    TextureField field = make_sphere_field(4, 2, {3, 3}, 1.0);
    field.smooth_places = 1;
    std::vector<float> values(field.values.size(), 0.0f), out = values;
    // The first and the last place of a row are neighbours.
    const std::size_t per_place = 3 * field.texels_per_place();
    values[0] = 1.0f;
    add_smoothness(field, values, out);
    EXPECT_EQ(out[3 * per_place], -1.0f);
    EXPECT_EQ(out[per_place], -1.0f);
    EXPECT_EQ(out[4 * per_place], -1.0f);
    EXPECT_EQ(out[0], 3.0f);
}

TEST(ViewField, LinksDirectionsThatShowTheSamePlaceOfTheFocus) {
    constexpr double focus = 0.6;
    const TextureField field = make_sphere_field(64, 32, {12, 12}, focus);
    // The point of the sphere of the focus that the centre of a texel shows.
    const auto point_of = [&](std::size_t texel) {
        const PhotoSample centre = centre_of_texel(field, texel);
        const glm::dvec3 n =
            sphere_normal(static_cast<double>(centre.u), static_cast<double>(centre.v));
        const glm::dvec3 d(direction_at(centre.s, centre.t));
        const double c = glm::dot(n, d);
        return n - (c - std::sqrt(std::max(c * c - 1 + focus * focus, 0.0))) * d;
    };
    const std::size_t place = 14 * 64 + 20;
    for (const std::size_t direction : {6 * 12 + 6, 5 * 12 + 5, 6 * 12 + 5}) {
        const std::size_t texel = place * 144 + direction;
        for (const std::uint32_t next : field.next_directions[texel]) {
            EXPECT_NE(next / 144, place);
            EXPECT_LT(glm::length(point_of(next) - point_of(texel)), 0.12);
        }
    }
    // On the sphere itself, the place stays.
    const TextureField on = make_sphere_field(64, 32, {12, 12}, 1.0);
    EXPECT_EQ(on.next_directions[place * 144 + 78],
              (std::array<std::uint32_t, 2>{static_cast<std::uint32_t>(place * 144 + 79),
                                            static_cast<std::uint32_t>(place * 144 + 90)}));
}

TEST(SphereOf, FindsWhatAllCamerasLookAt) {
    const glm::dvec3 centre(4, 5, 6);
    std::vector<PosedPhotograph> photographs;
    std::mt19937 random(3);
    for (int i = 0; i < 9; ++i)
        photographs.push_back(looking_at(centre + 10.0 * random_unit(random), centre));
    auto sphere = sphere_of(photographs, {}, std::nullopt);
    ASSERT_TRUE(sphere.ok()) << sphere.status().message();
    EXPECT_LT(glm::length(sphere->centre - centre), 1e-9);
    // The lower edge is 40 of 120 pixels from the middle.
    EXPECT_NEAR(sphere->radius, 10 * std::sin(std::atan(40.0 / 120.0)), 1e-6);
    sphere = sphere_of(photographs, {.centre = glm::dvec3(4, 5, 7), .radius = 2.0}, std::nullopt);
    ASSERT_TRUE(sphere.ok());
    EXPECT_EQ(sphere->centre.z, 7);
    EXPECT_EQ(sphere->radius, 2);
}

TEST(SphereOf, NamesCamerasThatDoNotFit) {
    const auto message = [](const std::vector<PosedPhotograph>& photographs,
                            const SphereWish& wish) {
        return sphere_of(photographs, wish, std::nullopt).status().message();
    };
    const PosedPhotograph front = looking_at({0, 0, 9}, {}), side = looking_at({9, 0, 0}, {});
    EXPECT_NE(message({front, front}, {}).find("same direction"), std::string::npos);
    EXPECT_NE(message({front, side}, {.centre = {}, .radius = 9.5}).find("frame 'p'"),
              std::string::npos);
    EXPECT_NE(message({looking_at({0, 0, 1}, {0, 0, 2}), looking_at({1, 0, 0}, {2, 0, 0})}, {})
                  .find("outwards"),
              std::string::npos);
}

TEST(WindowOf, ShowsWhatAllPhotographsShow) {
    std::vector<PosedPhotograph> photographs;
    for (int i = 0; i < 12; ++i) {
        const double x = 0.5 * (i % 4), y = 0.5 * (i / 4);
        photographs.push_back(looking_at({x, y, 7}, {x, y, 0}));
    }
    const auto sized = window_of(photographs, 6, 0, 1e9);
    ASSERT_TRUE(sized.ok()) << sized.status().message();
    const PhotoWindow& window = sized->window;
    EXPECT_LT(glm::length(window.centre - glm::dvec3(0.75, 0.5, 1)), 1e-9);
    EXPECT_LT(glm::length(window.axes[2] - glm::dvec3(0, 0, 1)), 1e-9);
    EXPECT_EQ(window.cameras, (std::array<std::uint32_t, 2>{4, 3}));
    EXPECT_NEAR(window.spacing_x, 0.5, 1e-9);
    // 6 * 50 / 120 to each side of the outermost cameras, in pixels of 6 / 120.
    EXPECT_NEAR(window.width, 2 * (2.5 + 0.75), 1e-9);
    EXPECT_EQ(sized->pixels, (std::array<std::uint32_t, 2>{130, 100}));
    EXPECT_NEAR(window.height, window.width * 100 / 130, 1e-9);
    // As FORMAT.md 5.3 has it, the cameras stand around the middle of the window.
    const auto sample = SeenWindow(window).seen({0, 0, 7}, {0, 0, -1});
    ASSERT_TRUE(sample.has_value());
    EXPECT_NEAR(sample->s, 0.5f / 4, 1e-6f);
    EXPECT_NEAR(sample->t, 2.5f / 3, 1e-6f);

    EXPECT_NE(window_of(std::vector{photographs[0], photographs[0]}, 6, 0, 1e9)
                  .status()
                  .message()
                  .find("one place"),
              std::string::npos);
    photographs.push_back(looking_at({0, 0, 0.5}, {0, 0, 0}));
    EXPECT_NE(window_of(photographs, 4, 0, 1e9).status().message().find("behind the window"),
              std::string::npos);
}

} // namespace
