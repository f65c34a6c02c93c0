// The baker: intersections against slow twins, the geometry it bakes by, its determinism and its
// scenes.
#include "corpus/bake.h"
#include "corpus/intersect.h"
#include "corpus/sampling.h"
#include "corpus/shade.h"
#include "format/geometry.h"
#include "format/samples.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <thread>

namespace tessera::corpus {
namespace {

using Bytes = std::vector<std::byte>;

std::mt19937_64 generator(std::uint64_t seed) {
    return std::mt19937_64{seed};
}

double uniform(std::mt19937_64& random, double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

glm::dvec3 unit_vector(std::mt19937_64& random) {
    for (;;) {
        const glm::dvec3 x{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
        const double length = glm::length(x);
        if (length > 0.1 && length <= 1.0)
            return x / length;
    }
}

// Whether a point of the object's frame is inside.
bool contains(const Object& object, const glm::dvec3& p) {
    const glm::dvec3& h = object.half;
    switch (object.shape) {
    case Shape::sphere:
        return glm::length(p) <= h.x;
    case Shape::cylinder:
        return std::hypot(p.x, p.z) <= h.x && std::abs(p.y) <= h.y;
    case Shape::box:
        return std::abs(p.x) <= h.x && std::abs(p.y) <= h.y && std::abs(p.z) <= h.z;
    case Shape::plane:
        break;
    }
    return false;
}

bool contains_along(const Object& object, const Ray& ray, double distance) {
    return contains(object,
                    object.to_local * (ray.origin + distance * ray.direction - object.centre));
}

// Marches until inside/outside flips, then bisects. Infinity if it never does within `reach`.
double marched_distance(const Object& object, const Ray& ray, double reach, double step) {
    const bool start = contains_along(object, ray, 0.0);
    for (double at = step; at < reach; at += step) {
        if (contains_along(object, ray, at) == start)
            continue;
        double low = at - step;
        double high = at;
        for (int i = 0; i < 60; ++i) {
            const double middle = (low + high) / 2.0;
            (contains_along(object, ray, middle) == start ? low : high) = middle;
        }
        return high;
    }
    return std::numeric_limits<double>::infinity();
}

std::vector<Object> sample_solids() {
    const Material material;
    const glm::dvec3 axis = glm::normalize(glm::dvec3{1, 2, 3});
    return {sphere({0.1, -0.2, 0.3}, 0.8, material), cylinder({0.2, 0.1, 0}, 0.5, 1.4, material),
            turned(cylinder({0, 0, 0}, 0.4, 2, material), axis, 50),
            box({0, 0.2, 0.1}, {1, 0.6, 1.4}, material),
            turned(box({-0.1, 0, 0}, {1, 1, 1}, material), axis, 77)};
}

std::unique_ptr<TexelSource> baker(const std::string& name, const Extent4& size, unsigned samples,
                                   std::uint64_t seed) {
    auto source = make_baked_source(name, size, samples, seed);
    EXPECT_TRUE(source.ok()) << source.status().message();
    return std::move(*source);
}

Bytes read_box(TexelSource& source, const Box4& box) {
    Bytes bytes(source.desc().box_bytes(box));
    const Status status = source.read(box, bytes);
    EXPECT_TRUE(status.ok()) << status.message();
    return bytes;
}

Bytes bake_all(const std::string& name, const Extent4& size, unsigned samples, std::uint64_t seed) {
    return read_box(*baker(name, size, samples, seed), Box4::whole(size));
}

std::vector<double> values_of(const Bytes& bytes, SampleType type) {
    std::vector<double> values;
    for (std::size_t i = 0; i < bytes.size(); i += sample_bytes(type)) {
        if (type == SampleType::unorm8) {
            values.push_back(std::to_integer<int>(bytes[i]) / 255.0);
            continue;
        }
        const unsigned low = std::to_integer<unsigned>(bytes[i]);
        const unsigned high = std::to_integer<unsigned>(bytes[i + 1]);
        values.push_back(half_to_float(static_cast<std::uint16_t>(low | high << 8)));
    }
    return values;
}

// Copies the texels of `box` out of those of the whole texture.
Bytes cut_out(const Bytes& whole, const TextureDesc& desc, const Box4& box) {
    Bytes part;
    const Extent4& n = desc.size;
    const std::size_t texel = desc.texel_bytes();
    for (std::size_t v = box.begin[1]; v < box.end[1]; ++v)
        for (std::size_t u = box.begin[0]; u < box.end[0]; ++u)
            for (std::size_t t = box.begin[3]; t < box.end[3]; ++t)
                for (std::size_t s = box.begin[2]; s < box.end[2]; ++s) {
                    const std::size_t at = (((v * n[0] + u) * n[3] + t) * n[2] + s) * texel;
                    for (std::size_t i = 0; i < texel; ++i)
                        part.push_back(whole[at + i]);
                }
    return part;
}

constexpr double infinite = std::numeric_limits<double>::infinity();

TEST(Intersect, AgreesWithMarchingFromOutsideAndInside) {
    auto random = generator(1);
    for (const Object& object : sample_solids()) {
        int hits = 0;
        for (int i = 0; i < 400; ++i) {
            const double away = i % 4 == 0 ? 0.2 : 2.5;
            const Ray ray{unit_vector(random) * away,
                          glm::normalize(unit_vector(random) * 0.9 - unit_vector(random) * 0.2)};
            const double expected = marched_distance(object, ray, 6.0, 0.002);
            const double actual = hit_distance(object, ray, 0.0);
            const Chord chord = object_chord(object, ray);
            if (!chord.empty() && chord.leave - chord.enter < 0.004)
                continue; // the march may step over a corner this thin
            ASSERT_EQ(std::isinf(expected), std::isinf(actual)) << i;
            if (std::isinf(actual))
                continue;
            ASSERT_NEAR(expected, actual, 1e-9) << i;
            ++hits;
        }
        EXPECT_GT(hits, 90);
    }
}

TEST(Intersect, NormalsPointOutOfTheSolid) {
    auto random = generator(2);
    for (const Object& object : sample_solids())
        for (int i = 0; i < 200; ++i) {
            const Ray ray{unit_vector(random) * 2.5, unit_vector(random)};
            const double distance = hit_distance(object, ray, 0.0);
            if (std::isinf(distance))
                continue;
            const glm::dvec3 local =
                object.to_local * (ray.origin + distance * ray.direction - object.centre);
            const glm::dvec3 normal = local_normal(object, local);
            EXPECT_NEAR(glm::length(normal), 1.0, 1e-12);
            EXPECT_FALSE(contains(object, local + 1e-6 * normal));
            EXPECT_TRUE(contains(object, local - 1e-6 * normal));
        }
}

TEST(Intersect, BoundingSpheresHoldTheObjects) {
    auto random = generator(3);
    for (const SceneInfo& info : scenes()) {
        const Scene scene = *make_scene(info.name);
        EXPECT_LE(scene.objects.size(), max_objects);
        for (const Object& object : scene.objects)
            for (int i = 0; i < 200; ++i) {
                const Ray ray{unit_vector(random) * 40.0 + object.centre, glm::dvec3{0.0}};
                const glm::dvec3 aim = object.centre + unit_vector(random) * object.bound * 0.7;
                const glm::dvec3 direction = glm::normalize(aim - ray.origin);
                const double distance = hit_distance(object, {ray.origin, direction}, 0.0);
                if (std::isinf(distance))
                    continue;
                const glm::dvec3 point = ray.origin + distance * direction;
                EXPECT_LE(glm::distance(point, object.centre), object.bound * (1 + 1e-9));
            }
    }
}

TEST(Intersect, ParallelAndGrazingRays) {
    const Material material;
    const Object cube = box({0, 0, 0}, {2, 2, 2}, material);
    EXPECT_EQ(hit_distance(cube, {{-3, 0.5, 0.5}, {1, 0, 0}}, 0.0), 2.0);
    EXPECT_EQ(hit_distance(cube, {{-3, 1.0, 0.0}, {1, 0, 0}}, 0.0), 2.0); // along a face
    EXPECT_EQ(hit_distance(cube, {{-3, 1.0000001, 0.0}, {1, 0, 0}}, 0.0), infinite);
    EXPECT_EQ(hit_distance(cube, {{3, 0, 0}, {1, 0, 0}}, 0.0), infinite); // behind
    EXPECT_EQ(hit_distance(cube, {{0, 0, 0}, {0, 0, -1}}, 0.0), 1.0);     // from inside

    const Object can = cylinder({0, 0, 0}, 0.5, 2, material);
    EXPECT_EQ(hit_distance(can, {{0.2, 5, 0}, {0, -1, 0}}, 0.0), 4.0); // along the axis
    EXPECT_EQ(hit_distance(can, {{0.6, 5, 0}, {0, -1, 0}}, 0.0), infinite);
    EXPECT_EQ(hit_distance(can, {{-3, 1, 0}, {1, 0, 0}}, 0.0), 2.5); // in the plane of a cap

    const Object ball = sphere({0, 0, 0}, 1e-3, material); // grazed from far away
    EXPECT_LT(hit_distance(ball, {{-1000, 0.999e-3, 0}, {1, 0, 0}}, 0.0), 1000.0);
    EXPECT_EQ(hit_distance(ball, {{-1000, 1.001e-3, 0}, {1, 0, 0}}, 0.0), infinite);

    const Object floor = plane({0, 1, 0}, 4, 2, material);
    EXPECT_EQ(hit_distance(floor, {{0, 1, 0.5}, {1, 0, 0}}, 0.0), infinite); // in the plane
    EXPECT_EQ(hit_distance(floor, {{1.9, 3, 0.9}, {0, -1, 0}}, 0.0), 2.0);
    EXPECT_EQ(hit_distance(floor, {{1.9, 3, 1.1}, {0, -1, 0}}, 0.0), infinite);
    EXPECT_EQ(hit_distance(floor, {{0, -3, 0}, {0, 1, 0}}, 0.0), 4.0); // from below
}

TEST(Geometry, PlacesRoundTrip) {
    auto random = generator(4);
    for (int i = 0; i < 2000; ++i) {
        const double u = uniform(random, 0, 1);
        const double v = uniform(random, 0.001, 0.999);
        const glm::dvec2 back = sphere_place(sphere_normal(u, v) * window_radius);
        EXPECT_NEAR(back.x, u, 1e-12);
        EXPECT_NEAR(back.y, v, 1e-12);
    }
    EXPECT_EQ(sphere_place({0, 0, -1}).x, 0.0); // the seam, once and not twice
    EXPECT_EQ(sphere_place({0, 0, 1}), (glm::dvec2{0.5, 0.5}));
    EXPECT_EQ(sphere_place({1, 0, 0}), (glm::dvec2{0.75, 0.5}));
}

TEST(Geometry, DirectionsRoundTrip) {
    auto random = generator(5);
    for (int i = 0; i < 2000; ++i) {
        const SurfaceFrame frame = surface_frame(unit_vector(random));
        const double s = uniform(random, 0.01, 0.99);
        const double t = uniform(random, 0.01, 0.99);
        const glm::dvec3 d = outgoing_direction(frame, s, t);
        EXPECT_NEAR(glm::length(d), 1.0, 1e-12);
        EXPECT_GT(glm::dot(d, frame.ez), 0.0);
        const glm::dvec2 back = direction_angles(frame, d);
        EXPECT_NEAR(back.x, s, 1e-9);
        EXPECT_NEAR(back.y, t, 1e-9);
    }
}

TEST(Geometry, PolesOfTheSphere) {
    for (const double y : {1.0, -1.0}) {
        const SurfaceFrame frame = surface_frame({0, y, 0});
        EXPECT_EQ(frame.ex, (glm::dvec3{1, 0, 0}));
        EXPECT_EQ(frame.ey, (glm::dvec3{0, 0, -y}));
        EXPECT_EQ(sphere_place({0, y * window_radius, 0}), (glm::dvec2{0.5, y > 0 ? 1.0 : 0.0}));
    }
}

TEST(Geometry, PolesOfTheDirections) {
    const SurfaceFrame frame = surface_frame(sphere_normal(0.3, 0.6));
    EXPECT_EQ(direction_angles(frame, frame.ey).x, 0.5);
    EXPECT_NEAR(direction_angles(frame, frame.ey).y, 1.0, 1e-7);
    EXPECT_EQ(direction_angles(frame, -frame.ey).x, 0.5);
    EXPECT_NEAR(direction_angles(frame, -frame.ey).y, 0.0, 1e-7);
}

TEST(Geometry, ArcSinePastOneIsNoNaN) {
    const double past = 1.0 + 1e-15;
    const SurfaceFrame frame = surface_frame({0, 0, 1});
    EXPECT_EQ(direction_angles(frame, {past, 0, 0}).x, 1.0);
    EXPECT_EQ(direction_angles(frame, {0, past, 0}).y, 1.0);
    EXPECT_EQ(direction_angles(frame, {0, -past, 0}).y, 0.0);
    EXPECT_EQ(direction_angles(frame, glm::normalize(glm::dvec3{0.3, 0, -1})).x, 1.0); // from below
    EXPECT_EQ(direction_angles(frame, glm::normalize(glm::dvec3{-0.3, 0, -1})).x, 0.0);
}

TEST(Sampling, OneSampleIsTheCentre) {
    const Extent4 size{7, 5, 3, 4};
    const Sampler sampler(size, 1, 9);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const Angles centre{sampler.centre(0, i), sampler.centre(1, i), sampler.centre(2, i),
                            sampler.centre(3, i)};
        const Ray ray = inward_ray(sampler.angles(centre, 0, sampler.rotation(i)));
        const glm::dvec3 normal = sphere_normal((i + 0.5) / 7, (i + 0.5) / 5);
        const glm::dvec3 d =
            outgoing_direction(surface_frame(normal), (i + 0.5) / 3, (i + 0.5) / 4);
        EXPECT_LT(glm::distance(ray.origin, normal * window_radius), 1e-14);
        EXPECT_LT(glm::distance(ray.direction, -d), 1e-14);
    }
}

TEST(Sampling, RaysStayInTheirTexelAndFillIt) {
    const Extent4 size{16, 8, 4, 6};
    const std::array<std::uint32_t, 4> texel{11, 2, 1, 4};
    const Sampler sampler(size, 256, 77);
    Angles centre;
    for (std::size_t a = 0; a < 4; ++a)
        centre[a] = sampler.centre(static_cast<int>(a), texel[a]);
    std::array<double, 4> mean{};
    std::array<double, 4> spread{};
    for (unsigned i = 0; i < sampler.count(); ++i) {
        const Ray ray = inward_ray(sampler.angles(centre, i, sampler.rotation(5)));
        const glm::dvec2 uv = sphere_place(ray.origin);
        const glm::dvec2 st =
            direction_angles(surface_frame(glm::normalize(ray.origin)), -ray.direction);
        const std::array<double, 4> at{uv.x, uv.y, st.x, st.y};
        for (std::size_t a = 0; a < 4; ++a) {
            const double inside = at[a] * size[a] - texel[a];
            EXPECT_GT(inside, 0.0);
            EXPECT_LT(inside, 1.0);
            mean[a] += inside / 256;
            spread[a] += (inside - 0.5) * (inside - 0.5) / 256;
        }
    }
    for (std::size_t a = 0; a < 4; ++a) {
        EXPECT_NEAR(mean[a], 0.5, 0.02);
        EXPECT_NEAR(spread[a], 1.0 / 12.0, 0.01);
    }
}

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

TEST(Trace, SeesTheSameAsTheTexel) {
    const Extent4 size{12, 7, 5, 6};
    const Scene scene = *make_scene("mirror");
    const Bytes texels = bake_all("mirror", size, 1, 3);
    const TextureDesc desc{size, SampleType::unorm8, 3};
    for (std::uint32_t i = 0; i < 5; ++i) {
        const glm::dvec3 n = sphere_normal((i + 5.5) / 12, (i + 1.5) / 7);
        const glm::dvec3 d = outgoing_direction(surface_frame(n), (i + 0.5) / 5, (i + 0.5) / 6);
        const glm::dvec3 seen = trace_scene(scene, {n * window_radius + d * 4.0, -d});
        const Bytes texel =
            cut_out(texels, desc, {{i + 5, i + 1, i, i}, {i + 6, i + 2, i + 1, i + 1}});
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(std::to_integer<int>(texel[static_cast<std::size_t>(c)]), 255.0 * seen[c],
                        0.51);
    }
}

// Bakes single texels with every object as a candidate.
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
                    sum += trace(scene, inward_ray(sampler.angles(centre, k, rotation)));
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
    EXPECT_EQ(bake_all("gallery", size, 1, 7), bake_all("gallery", size, 1, 8)); // centres
}

TEST(Bake, SizesOfOneAndOddSizes) {
    for (const SceneInfo& info : scenes())
        for (const Extent4& size : {Extent4{1, 1, 1, 1}, Extent4{1, 3, 5, 1}, Extent4{3, 1, 1, 7}})
            EXPECT_EQ(bake_all(info.name, size, 3, 0).size(),
                      texel_count(size) * 3 * sample_bytes(info.type));
}

TEST(Bake, SaysWhatItIs) {
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
    // As large as allowed: nothing is held, so nothing is allocated.
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

// The number after "key": in a line of the manifest, or the text if it is in quotes.
std::string field(const std::string& line, const std::string& key) {
    const std::size_t at = line.find("\"" + key + "\": ");
    if (at == std::string::npos)
        return {};
    const std::size_t begin = at + key.size() + 4;
    return line[begin] == '"' ? line.substr(begin + 1, line.find('"', begin + 1) - begin - 1)
                              : line.substr(begin, line.find_first_of(",}", begin) - begin);
}

std::uint64_t fnv1a(const Bytes& bytes) {
    std::uint64_t hash = 0xCBF29CE484222325u;
    for (const std::byte byte : bytes)
        hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001B3u;
    return hash;
}

// The manifest's size and sample count; kept here too, so that neither changes unnoticed.
constexpr Extent4 manifest_size{32, 16, 8, 8};

std::string manifest_line(const SceneInfo& info, const Bytes& bytes) {
    const Statistics is = statistics_of(values_of(bytes, info.type));
    char text[400];
    std::snprintf(text, sizeof text,
                  "{\"name\": \"%s\", \"sample_type\": \"%s\", \"size\": \"32x16x8x8\", "
                  "\"samples_per_texel\": 4, \"seed\": 1, \"mean\": %.6g, \"min\": %.6g, "
                  "\"max\": %.6g, \"fnv1a64\": \"%016llx\"}",
                  info.name.c_str(), info.type == SampleType::unorm8 ? "unorm8" : "half16", is.mean,
                  is.least, is.most, static_cast<unsigned long long>(fnv1a(bytes)));
    return text;
}

// libm's last bits differ between machines and may move a ray across an edge, so the texels are
// compared by their statistics; a checksum that differs is only told.
TEST(Scenes, MatchTheManifest) {
    std::ifstream file(std::filesystem::path(__FILE__).parent_path() / "../../corpus/manifest.json");
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
