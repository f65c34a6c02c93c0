// Tests encoding and decoding of meshes, and damaged streams.
#include "format/surface/mesh_check.h"
#include "format/surface_mesh.h"
#include "tests/support/damaged_meshes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <limits>

namespace tessera {
namespace {

using namespace test;

SurfaceMesh there_and_back(const SurfaceMesh& mesh, const MeshQuantisation& bits) {
    const Result<Bytes> stream = encode_mesh(mesh, bits);
    EXPECT_TRUE(stream) << stream.status().message();
    if (!stream)
        return {};
    const Result<SurfaceMesh> back = decode_mesh(*stream, no_memory_limit);
    EXPECT_TRUE(back) << back.status().message();
    return back ? *back : SurfaceMesh{};
}

// The corners of each triangle in grid units, beginning with the least corner. The orientation is
// kept.
using Corner = std::array<long, 5>;
using Triangle = std::array<Corner, 3>;

std::vector<Triangle> grid_triangles(const SurfaceMesh& mesh, double steps_xyz, double steps_uv) {
    std::vector<Triangle> all;
    for (const auto& corners : mesh.triangles) {
        Triangle t;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::vec3& p = mesh.positions[corners[i]];
            const glm::vec2& uv = mesh.uv[corners[i]];
            t[i] = {std::lround(p.x * steps_xyz), std::lround(p.y * steps_xyz),
                    std::lround(p.z * steps_xyz), std::lround(uv.x * steps_uv),
                    std::lround(uv.y * steps_uv)};
        }
        std::ranges::rotate(t, std::ranges::min_element(t));
        all.push_back(t);
    }
    std::ranges::sort(all);
    return all;
}

// Snaps a mesh to the grid of 8 bits over a cube of side 2, so that quantising rounds nothing.
SurfaceMesh on_grid(SurfaceMesh mesh) {
    for (glm::vec3& p : mesh.positions)
        p = glm::round((p + 1.0f) * 127.5f);
    for (glm::vec2& uv : mesh.uv)
        uv = glm::round(uv * 1023.0f) / 1023.0f;
    return mesh;
}

TEST(MeshStream, TrianglesSurviveInAnyOrder) {
    for (const bool round : {false, true})
        for (const unsigned normal_bits : {0u, 8u}) {
            const SurfaceMesh mesh = on_grid(six_charts(6, round));
            const SurfaceMesh back = there_and_back(mesh, {8, 10, normal_bits});
            EXPECT_EQ(grid_triangles(back, 1, 1023), grid_triangles(mesh, 1, 1023));
            EXPECT_EQ(back.positions.size(), mesh.positions.size());
        }
    const SurfaceMesh soup = on_grid(triangle_soup(50, 1));
    const SurfaceMesh back = there_and_back(soup, {8, 10, 0});
    EXPECT_EQ(back.triangles.size(), soup.triangles.size());
}

// On a sphere every position has a unique nearest decoded vertex, whose normal and uv are compared.
TEST(MeshStream, ErrorsAreAtMostHalfAStep) {
    const SurfaceMesh mesh = six_charts(5, true);
    for (const unsigned bits : {8u, 11u, 14u}) {
        const SurfaceMesh back = there_and_back(mesh, {bits, bits, 8});
        ASSERT_EQ(back.positions.size(), mesh.positions.size());
        const float steps = static_cast<float>((1u << bits) - 1);
        const float place_error = 2.0f / steps / 2 + 1e-6f, uv_error = 1 / steps / 2 + 1e-6f;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            bool found = false;
            for (std::size_t k = 0; k < back.positions.size() && !found; ++k) {
                const glm::vec3 off = glm::abs(back.positions[k] - mesh.positions[i]);
                const glm::vec2 uv = glm::abs(back.uv[k] - mesh.uv[i]);
                found = std::max({off.x, off.y, off.z}) <= place_error &&
                        std::max(uv.x, uv.y) <= uv_error &&
                        glm::dot(back.normals[k], mesh.normals[i]) > 0.9995f;
            }
            EXPECT_TRUE(found) << i;
        }
    }
}

TEST(MeshStream, BytesAreTheSameEveryTime) {
    const SurfaceMesh mesh = six_charts(4, true);
    EXPECT_EQ(*encode_mesh(mesh, {}), *encode_mesh(mesh, {}));
    SurfaceMesh without = mesh;
    without.normals.clear(); // the encoder ignores them
    EXPECT_EQ(*encode_mesh(mesh, {}), *encode_mesh(without, {}));
    EXPECT_LT(encode_mesh(mesh, {})->size(), encode_mesh(mesh, {12, 12, 8})->size());
}

void refuses(const char* what, const MeshQuantisation& bits,
             const std::function<void(SurfaceMesh&)>& spoil) {
    SurfaceMesh mesh = six_charts(1, false);
    spoil(mesh);
    const Status status = encode_mesh(mesh, bits).status();
    EXPECT_EQ(status.code(), ErrorCode::bad_argument) << status.message();
    EXPECT_NE(status.message().find(what), std::string::npos) << status.message();
}

TEST(MeshStream, RefusesToEncodeInvalidMeshes) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const MeshQuantisation all{12, 12, 8};
    refuses("no triangles", {}, [](SurfaceMesh& m) { m.triangles.clear(); });
    refuses("triangle 3", {}, [](SurfaceMesh& m) { m.triangles[3][1] = 24; });
    refuses("position 5", {}, [&](SurfaceMesh& m) { m.positions[5].y = nan; });
    refuses("position 5", {}, [&](SurfaceMesh& m) { m.positions[5].y = -infinity; });
    refuses("position 0", {}, [&](SurfaceMesh& m) { m.positions[0].x = 2e30f; });
    refuses("uv 23", {}, [&](SurfaceMesh& m) { m.uv[23].x = nan; });
    refuses("uv 1", {}, [&](SurfaceMesh& m) { m.uv[1].y = 1.01f; });
    refuses("uv 1", {}, [&](SurfaceMesh& m) { m.uv[1].y = -0.01f; });
    refuses("normal 2", all, [&](SurfaceMesh& m) { m.normals[2] = {}; });
    refuses("normal 2", all, [&](SurfaceMesh& m) { m.normals[2].z = nan; });
    refuses("normals", all, [&](SurfaceMesh& m) { m.normals.pop_back(); });
    refuses("uv", {}, [&](SurfaceMesh& m) { m.uv.pop_back(); });
    refuses("three different corners", {}, [&](SurfaceMesh& m) {
        for (auto& triangle : m.triangles)
            triangle[1] = triangle[0];
    });
    refuses("position bits", {3, 12, 8}, [](SurfaceMesh&) {});
    refuses("uv bits", {12, 25, 8}, [](SurfaceMesh&) {});
    refuses("normal bits", {12, 12, 2}, [](SurfaceMesh&) {});
}

TEST(MeshStream, AcceptsNumbersUpToTheirBounds) {
    SurfaceMesh mesh = six_charts(1, false);
    mesh.positions[0].x = max_mesh_coordinate;
    mesh.positions[1].y = -max_mesh_coordinate;
    mesh.uv[0].x = -uv_tolerance;
    mesh.uv[1].y = 1 + uv_tolerance;
    EXPECT_TRUE(check_mesh(mesh, true, false, ErrorCode::bad_argument));
    refuses("uv 0", {}, [](SurfaceMesh& m) { m.uv[0].x = std::nextafter(-uv_tolerance, -1.0f); });
    refuses("uv 1", {}, [](SurfaceMesh& m) { m.uv[1].y = std::nextafter(1 + uv_tolerance, 2.0f); });
}

TEST(MeshStream, DropsTrianglesWithTwoEqualCorners) {
    SurfaceMesh mesh = six_charts(1, false);
    const std::size_t count = mesh.triangles.size();
    for (std::uint32_t i = 0; i < 100000; ++i) {
        std::array<std::uint32_t, 3> corners{i % 24, i % 24, i % 7};
        std::ranges::rotate(corners, corners.begin() + i % 3);
        mesh.triangles.push_back(corners);
    }
    EXPECT_EQ(there_and_back(mesh, {}).triangles.size(), count);
}

// Quantising merges vertices, which leaves triangles without area.
TEST(MeshStream, KeepsTrianglesThatLoseTheirAreaInQuantising) {
    SurfaceMesh mesh = triangle_soup(20, 3);
    for (std::size_t i = 3; i < mesh.positions.size(); ++i)
        mesh.positions[i] = mesh.positions[i - i % 3] + 1e-6f * static_cast<float>(i % 3);
    const SurfaceMesh back = there_and_back(mesh, {8, 8, 0});
    EXPECT_EQ(back.triangles.size(), mesh.triangles.size());
    for (const glm::vec3& normal : back.normals)
        EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f);
}

// An edge with five triangles, a vertex shared by two cones, and a strip with one twist.
TEST(MeshStream, AcceptsMeshesThatAreNotManifold) {
    SurfaceMesh mesh;
    const auto vertex = [&](float x, float y, float z) {
        mesh.positions.emplace_back(x, y, z);
        mesh.uv.emplace_back(std::abs(x) / 8, std::abs(y) / 8);
        return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    };
    const std::uint32_t a = vertex(0, 0, 0), b = vertex(0, 0, 1);
    for (int i = 0; i < 5; ++i)
        mesh.triangles.push_back({a, b, vertex(1, static_cast<float>(i), 0)});
    for (int i = 0; i < 4; ++i) // neighbours with reversed orientation
        mesh.triangles.push_back({b, static_cast<std::uint32_t>(2 + i), a});
    for (const float z : {-1.0f, 1.0f})
        mesh.triangles.push_back({a, vertex(3, 3, z), vertex(4, 3, z)});
    EXPECT_EQ(there_and_back(mesh, {}).triangles.size(), mesh.triangles.size());
}

Bytes box_stream(unsigned normal_bits) {
    return *encode_mesh(six_charts(1, false), {10, 10, normal_bits});
}

TEST(MeshStream, RefusesStreamsThatAreTooShortOrTooLong) {
    for (const unsigned normal_bits : {0u, 6u})
        refuses_other_lengths(box_stream(normal_bits));
}

TEST(MeshStream, SurvivesFlippedBits) {
    for (const unsigned normal_bits : {0u, 6u})
        survives_flipped_bits(box_stream(normal_bits));
}

// The counts follow the first twelve bytes. For a box, each is one byte.
TEST(MeshStream, RefusesCountsBeforeReservingMemory) {
    const auto claiming = [](std::initializer_list<int> counts) {
        Bytes stream = box_stream(0);
        stream.erase(stream.begin() + 12, stream.begin() + 14);
        for (auto i = std::rbegin(counts); i != std::rend(counts); ++i)
            stream.insert(stream.begin() + 12, static_cast<std::byte>(*i));
        return decode_mesh(stream, 256u << 20).status().code();
    };
    EXPECT_EQ(claiming({8, 12}), ErrorCode::ok);
    EXPECT_EQ(claiming({8, 0}), ErrorCode::invalid_file);
    EXPECT_EQ(claiming({37, 12}), ErrorCode::invalid_file);                   // too many vertices
    EXPECT_EQ(claiming({8, 0x80, 0x80, 0x80, 0x04}), ErrorCode::unsupported); // 2^23 triangles
    EXPECT_EQ(claiming({8, 0x81, 0x80, 0x80, 0x08}), ErrorCode::invalid_file);
    EXPECT_EQ(claiming({8, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F}), ErrorCode::invalid_file);
    EXPECT_EQ(claiming({8, 0xFF, 0xFF, 0xFF, 0xFF, 0x1F}), ErrorCode::invalid_file);
    EXPECT_EQ(decode_mesh(box_stream(0), 1000).status().code(), ErrorCode::unsupported);
}

TEST(MeshStream, RefusesOtherKindsOfStreams) {
    const auto with = [](std::size_t at, int value) {
        Bytes stream = box_stream(0);
        stream[at] = static_cast<std::byte>(value);
        return decode_mesh(stream, no_memory_limit).status().message();
    };
    const auto says = [&](std::size_t at, int value, const char* what) {
        EXPECT_NE(with(at, value).find(what), std::string::npos) << with(at, value);
    };
    says(0, 'd', "not a Draco stream");
    says(5, 1, "1.2");
    says(6, 1, "2.1");
    says(7, 0, "not a mesh"); // a point cloud
    says(8, 0, "Edgebreaker");
    says(10, 0x80, "metadata");
    says(11, 1, "traversal");
    says(14, 3, "seams");
}

TEST(MeshStream, ReportsACutOffHead) {
    const Bytes stream = box_stream(0);
    const auto cut_at = [&](std::size_t size) {
        return decode_mesh(std::span(stream).first(size), no_memory_limit).status();
    };
    for (std::size_t size = 0; size < 15; ++size) { // up to the number of seams
        EXPECT_EQ(cut_at(size).code(), ErrorCode::invalid_file) << size;
        EXPECT_NE(cut_at(size).message().find("is cut off"), std::string::npos) << size;
    }
    EXPECT_EQ(cut_at(15).message().find("is cut off"), std::string::npos);
}

// An attribute declares its kind, its number type, how many numbers it has, and whether they are
// normalised.
TEST(MeshStream, RefusesUnknownAttributes) {
    constexpr int positions = 0, normals = 1, colours = 2, floats = 9;
    using Said = std::array<int, 4>;
    const auto refuses = [](const Said& old, const Said& now) {
        const auto same = [](std::byte a, int b) { return std::to_integer<int>(a) == b; };
        Bytes stream = box_stream(6);
        const auto found = std::search(stream.begin(), stream.end(), old.begin(), old.end(), same);
        ASSERT_NE(found, stream.end());
        std::ranges::transform(now, found, [](int x) { return static_cast<std::byte>(x); });
        EXPECT_EQ(decode_mesh(stream, no_memory_limit).status().code(), ErrorCode::invalid_file);
    };
    for (const int kind : {normals, colours})
        refuses({positions, floats, 3, 0}, {kind, floats, 3, 0});
    for (const int kind : {positions, colours})
        refuses({normals, floats, 3, 0}, {kind, floats, 3, 0});
    refuses({normals, floats, 3, 0}, {normals, floats + 1, 3, 0});
    refuses({normals, floats, 3, 0}, {normals, floats, 2, 0});
}

} // namespace
} // namespace tessera
