// Compares the mips of an atlas with the second decoder's and checks their sizes and selection.
#include "tests/reference/spec_mesh_sampling.h"
#include "tests/support/meshes.h"
#include "tests/support/random_rays.h"

#include <gtest/gtest.h>
#include <map>

namespace tessera {
namespace {

using namespace test;
namespace reference = tessera_reference;

reference::Charts charts_of(const SurfaceMesh& mesh, const Extent4& size) {
    std::vector<reference::AtlasTriangle> triangles;
    for (const auto& triangle : mesh.triangles) {
        reference::AtlasTriangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
            t.vertices[k] = triangle[k];
            t.uv[k][0] = static_cast<double>(mesh.uv[triangle[k]].x);
            t.uv[k][1] = static_cast<double>(mesh.uv[triangle[k]].y);
        }
        triangles.push_back(t);
    }
    return {triangles, size[axis_u], size[axis_v]};
}

void expect_as_specified(const SurfaceMesh& mesh, const TileGrid& grid) {
    auto random = generator(3);
    const Extent4& size = grid.size();
    const AtlasMips mips(mesh, grid);
    const reference::Charts charts = charts_of(mesh, size);
    ASSERT_GT(mips.count(), 0u);
    // The second decoder numbers a chart by its first triangle, and no chart is 0 in both.
    std::map<std::uint32_t, std::uint32_t> theirs{{0, 0}}, ours{{0, 0}};
    for (unsigned mip = 0; mip <= mips.count(); ++mip) {
        const auto sides = mips.size(mip);
        ASSERT_EQ(sides, charts.size(mip));
        for (std::uint32_t y = 0; y < sides[1]; ++y)
            for (std::uint32_t x = 0; x < sides[0]; ++x) {
                const std::uint32_t own = mips.charts(mip)[std::size_t{y} * sides[0] + x];
                const auto other = static_cast<std::uint32_t>(charts.shown_by(mip, x, y) + 1);
                ASSERT_EQ(theirs.emplace(own, other).first->second, other)
                    << mip << ": " << x << ", " << y;
                ASSERT_EQ(ours.emplace(other, own).first->second, own)
                    << mip << ": " << x << ", " << y;
            }
    }
    for (int i = 0; i < 60; ++i) {
        const AngularMap map =
            i % 2 ? AngularMap::octahedral_hemisphere : AngularMap::octahedral_mirrored;
        const SurfaceFrame frame = surface_frame(unit_vector(random));
        const glm::dvec3 d = unit_vector(random);
        const glm::dvec2 uv{uniform(random, 0, 1), uniform(random, 0, 1)};
        const unsigned mip = static_cast<unsigned>(i) % (mips.count() + 1);
        const auto vector = [](const glm::dvec3& x) { return reference::Vector{x.x, x.y, x.z}; };
        const auto expected = reference::mip_taps(
            charts, size.data(), static_cast<int>(map),
            {vector(frame.ex), vector(frame.ey), vector(frame.ez)}, uv.x, uv.y, vector(d), mip);
        std::map<std::array<std::uint32_t, 4>, double> difference;
        for (const WeightedTexel& w :
             mips.footprint(map, uv, octahedral_place(map, frame, d), mip)) {
            EXPECT_LT(w.u, mips.kept_size()[axis_u]);
            EXPECT_LT(w.v, mips.kept_size()[axis_v]);
            difference[{w.u, w.v, w.s, w.t}] += w.weight;
        }
        const auto begin = mips.begin(expected.mip);
        for (const reference::Tap& tap : expected.taps)
            difference[{tap.texel[0] + begin[0], tap.texel[1] + begin[1], tap.texel[2],
                        tap.texel[3]}] -= tap.weight;
        for (const auto& [texel, weight] : difference)
            EXPECT_NEAR(weight, 0.0, 1e-9);
    }
}

TEST(AtlasMips, MatchTheSpecification) {
    const Extent4 size{48, 32, 5, 4}, tile{16, 16, 4, 4};
    expect_as_specified(six_charts(2, false), {size, tile}); // charts one texel apart
    expect_as_specified(triangle_soup(9, 4), {size, tile});  // overlapping charts
    expect_as_specified(six_charts(1, true), {{45, 29, 5, 4}, {64, 64, 4, 4}}); // one tile
    expect_as_specified(six_charts(1, true), {{1, 1, 1, 1}, {1, 1, 1, 1}});
}

TEST(AtlasMips, CountFollowsTheBeginningsOfTiles) {
    const SurfaceMesh mesh = six_charts(1, false);
    for (const auto& [extent, tile] : {std::pair{96u, 32u},
                                       {96u, 24u},
                                       {100u, 32u},
                                       {60u, 64u},
                                       {90u, 30u},
                                       {64u, 8u},
                                       {33u, 11u}}) {
        const TileGrid grid({extent, 32, 2, 2}, {tile, 32, 2, 2});
        std::vector<std::uint32_t> begins;
        for (std::uint32_t i = 0; i < grid.count()[axis_u]; ++i)
            begins.push_back(grid.box(Extent4{i, 0, 0, 0}).begin[axis_u]);
        const AtlasMips mips(mesh, grid);
        EXPECT_EQ(mips.count(), reference::mips_of(begins)) << extent << " in " << tile;
        EXPECT_EQ(mips.kept_size(), AtlasMips::kept_size(grid));
        for (unsigned mip = 1; mip <= mips.count(); ++mip)
            for (std::size_t a = 0; a < 2; ++a)
                EXPECT_LE(mips.begin(mip)[a] + mips.size(mip)[a], mips.kept_size()[a]);
        if (mips.count() == 0)
            EXPECT_EQ(mips.kept_size(), grid.size());
    }
    EXPECT_EQ(AtlasMips().count(), 0u);
}

TEST(AtlasMips, AreSelectedByTheFootprintOfAPixel) {
    const AtlasMips mips(six_charts(1, false), {{96, 64, 2, 2}, {32, 32, 2, 2}});
    ASSERT_EQ(mips.count(), 4u);
    for (const double a : {0.0, 0.7, 1.0, 1.42, 3.0, 5.6, 17.0, 1e9})
        for (const double b : {0.0, 1.2, 2.9, 4.1, 1e12})
            EXPECT_NEAR(mips.mip_for({a, b}), reference::mip_of_pixel(a, b, 4), 1e-12);
    EXPECT_EQ(mips.mip_for({std::nan(""), 3.0}), 0.0);
    EXPECT_EQ(mips.mip_for({INFINITY, INFINITY}), 4.0);
}

// Large sizes and many triangles cost a file few bytes, so mips are not built for them.
TEST(AtlasMips, AreNotBuiltForSmallFilesThatClaimLargeSizes) {
    SurfaceMesh mesh = six_charts(1, false);
    const Extent4 tile{32, 32, 2, 2};
    EXPECT_EQ(AtlasMips(mesh, {{1u << 20, 1u << 20, 2, 2}, tile}).count(), 0u);
    const TileGrid grid({1024, 1024, 2, 2}, tile);
    EXPECT_EQ(AtlasMips(mesh, grid).count(), 4u);
    for (glm::vec2& uv : mesh.uv)
        uv = {uv.x < 0.3f ? 0.0f : 1.0f, uv.y < 0.3f ? 0.0f : 1.0f};
    for (int i = 0; i < 8; ++i)
        mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    EXPECT_EQ(AtlasMips(mesh, grid).count(), 0u);
    // Triangles without area cost time along their edges, too.
    mesh.uv = {{0.5f, 0.0f}, {0.5f, 0.5f}, {0.5f, 1.0f}};
    mesh.positions.resize(3);
    mesh.triangles.assign(10000, {0, 1, 2});
    EXPECT_EQ(AtlasMips(mesh, grid).count(), 0u);
}

} // namespace
} // namespace tessera
