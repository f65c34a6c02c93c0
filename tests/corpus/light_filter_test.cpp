// Tests the filter of noisy light, and which parts of texels are baked.
#include "corpus/layers/light_filter.h"
#include "corpus/layers/open_places.h"
#include "corpus/layers/texel_paths.h"
#include "tests/support/traced_squares.h"

#include <cmath>
#include <set>

namespace tessera::corpus {
namespace {

using namespace support;

constexpr Texels2 filtered_size{40, 24};
constexpr std::uint32_t paths_of_half = 16;

// A chart whose light is a function of the texel, with noise of a standard deviation of 0.1 in each
// half.
struct NoisyChart {
    std::vector<NoisyLight> light{std::size_t{filtered_size[0]} * filtered_size[1]};
    std::vector<std::uint32_t> charts = std::vector<std::uint32_t>(light.size(), 0);
    std::vector<glm::vec3> normals = std::vector<glm::vec3>(light.size(), glm::vec3(0, 0, 1));

    template <class Light> explicit NoisyChart(const Light& exact) {
        for (std::uint32_t v = 0; v < filtered_size[1]; ++v)
            for (std::uint32_t u = 0; u < filtered_size[0]; ++u) {
                const std::size_t at = index(u, v);
                light[at].paths = paths_of_half;
                for (std::size_t half = 0; half < 2; ++half) {
                    const auto random = static_cast<float>(mix_bits(2 * at + half) >> 40);
                    const float noise = 0.35f * (random * 0x1p-24f - 0.5f);
                    light[at].halves[half] = glm::vec3(paths_of_half * (exact(u, v) + noise));
                }
            }
    }
    static std::size_t index(std::uint32_t u, std::uint32_t v) {
        return std::size_t{v} * filtered_size[0] + u;
    }
    LightFilter filter(LightFilter::Beside beside = {}) const {
        auto made = LightFilter::make(filtered_size, light, charts, normals, {.threads = 2},
                                      std::move(beside));
        EXPECT_TRUE(made.ok());
        return std::move(*made);
    }
};

float mean_of_halves(const LightFilter& filter, std::uint32_t u, std::uint32_t v) {
    const auto [a, b] = filter.filtered(u, v);
    return (a.x + b.x) / 2.0f;
}

// Noise of 0.07 in a texel becomes a tenth, and the halves say so.
TEST(LightFilter, SmoothsConstantLight) {
    const NoisyChart chart([](auto, auto) { return 0.5f; });
    const LightFilter filter = chart.filter();
    double error = 0, estimate = 0;
    for (std::uint32_t v = 0; v < filtered_size[1]; ++v)
        for (std::uint32_t u = 0; u < filtered_size[0]; ++u) {
            error += std::pow(mean_of_halves(filter, u, v) - 0.5, 2);
            const auto [a, b] = filter.filtered(u, v);
            estimate += std::pow((a.x - b.x) / 2.0, 2);
        }
    const auto count = static_cast<double>(chart.light.size());
    EXPECT_LT(std::sqrt(error / count), 0.016);
    EXPECT_NEAR(std::sqrt(estimate / error), 1.0, 0.4);
}

// The edge of a shadow stays where it is.
TEST(LightFilter, KeepsEdges) {
    constexpr std::uint32_t edge = 17;
    const auto exact = [](std::uint32_t u, std::uint32_t) { return u < edge ? 1.0f : 0.2f; };
    const NoisyChart chart(exact);
    const LightFilter filter = chart.filter();
    for (std::uint32_t v = 0; v < filtered_size[1]; ++v)
        for (const std::uint32_t u : {edge - 4, edge - 1, edge, edge + 3})
            EXPECT_NEAR(mean_of_halves(filter, u, v), exact(u, v), 0.15) << u << ' ' << v;
}

// At the border of a chart, too, where all texels lie on one side.
TEST(LightFilter, KeepsSlopes) {
    const auto exact = [](std::uint32_t u, std::uint32_t) {
        return 0.2f + 0.015f * static_cast<float>(u);
    };
    const NoisyChart chart(exact);
    const LightFilter filter = chart.filter();
    double first = 0, last = 0;
    for (std::uint32_t v = 0; v < filtered_size[1]; ++v) {
        first += (mean_of_halves(filter, 0, v) - exact(0, v)) / filtered_size[1];
        last += (mean_of_halves(filter, filtered_size[0] - 1, v) - exact(filtered_size[0] - 1, v)) /
                filtered_size[1];
    }
    EXPECT_NEAR(first, 0.0, 0.02);
    EXPECT_NEAR(last, 0.0, 0.02);
}

// Two charts that continue each other are filtered as one.
TEST(LightFilter, ReachesTheChartsThatContinueItsOwn) {
    const NoisyChart one([](std::uint32_t u, std::uint32_t v) { return u < v ? 0.8f : 0.4f; });
    const LightFilter whole = one.filter();
    NoisyChart chart = one;
    for (std::uint32_t v = 0; v < filtered_size[1]; ++v)
        for (std::uint32_t u = 20; u < filtered_size[0]; ++u)
            chart.charts[NoisyChart::index(u, v)] = 1;
    const LightFilter parted = chart.filter();
    const LightFilter continued = chart.filter([](std::uint32_t u, std::uint32_t v, int x, int y) {
        const std::array<std::int64_t, 2> at{std::int64_t{u} + x, std::int64_t{v} + y};
        std::optional<Texels2> texel;
        if (at[0] >= 0 && at[1] >= 0 && at[0] < filtered_size[0] && at[1] < filtered_size[1])
            texel = {static_cast<std::uint32_t>(at[0]), static_cast<std::uint32_t>(at[1])};
        return texel;
    });
    double step = 0;
    for (std::uint32_t v = 0; v < filtered_size[1]; ++v)
        for (const std::uint32_t u : {14u, 19u, 20u, 25u}) {
            EXPECT_EQ(mean_of_halves(continued, u, v), mean_of_halves(whole, u, v))
                << u << ' ' << v;
            step = std::max(step, std::abs(double{mean_of_halves(parted, u, v)} -
                                           double{mean_of_halves(whole, u, v)}));
        }
    EXPECT_GT(step, 0.01);
}

// Shares of all paths add up to 1, and none is of another chart or of a side that faces away.
TEST(LightFilter, AveragesItsOwnChart) {
    NoisyChart chart([](auto, auto) { return 0.5f; });
    for (std::uint32_t v = 0; v < filtered_size[1]; ++v)
        for (std::uint32_t u = 0; u < filtered_size[0]; ++u) {
            if (u >= 20)
                chart.charts[NoisyChart::index(u, v)] = 1;
            if (v >= 12)
                chart.normals[NoisyChart::index(u, v)] = {1, 0, 0};
        }
    const LightFilter filter = chart.filter();
    std::vector<LightFilter::Share> shares;
    filter.filtered(18, 10, &shares);
    float sum = 0;
    for (const auto& [texel, share] : shares) {
        sum += share * 2 * paths_of_half;
        EXPECT_LT(texel % filtered_size[0], 20u);
        EXPECT_LT(texel / filtered_size[0], 12u);
    }
    EXPECT_NEAR(sum, 1.0f, 1e-4f);
}

// Four neighbouring texels have the paths that one texel of four times as many has.
TEST(TexelPaths, NeighboursShareASequence) {
    std::set<std::pair<double, double>> alone, together;
    const TexelPaths all(3, 64, 5, 6);
    for (unsigned i = 0; i < 64; ++i) {
        PathRandom random = all[i];
        const glm::dvec2 x = random.next2();
        alone.insert({x.x, x.y});
    }
    for (std::uint32_t v = 12; v < 14; ++v)
        for (std::uint32_t u = 10; u < 12; ++u)
            for (unsigned i = 0; i < 16; ++i) {
                PathRandom random = TexelPaths(3, 16, u, v)[i];
                const glm::dvec2 x = random.next2();
                together.insert({x.x, x.y});
            }
    EXPECT_EQ(alone.size(), 64u);
    EXPECT_TRUE(alone == together);
}

// A floor that passes a closed body is baked outside it only.
TEST(OpenPlaces, LieOutsideBodies) {
    Model model = cube_model();
    model.materials.resize(1);
    add_square(model, 3, 0.25, false, 0);
    auto atlas = make_model_atlas(model, {.texels = 20000});
    ASSERT_TRUE(atlas.ok()) << atlas.status().message();
    const auto places = ModelPlaces::make(std::move(*atlas));
    ASSERT_TRUE(places.ok()) << places.status().message();
    const auto open = OpenPlaces::make(*places, {.threads = 2});
    ASSERT_TRUE(open.ok());
    std::size_t floor = 0, cut = 0, within = 0;
    const Texels2 size = places->texel_places().size();
    for (std::uint32_t v = 0; v < size[1]; ++v)
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            if (!places->texel_places().matters(u, v) || !open->matters(u, v) ||
                std::abs(places->place(u, v, {0, 0}).point.position.y - 0.25) > 1e-3)
                continue;
            ++floor;
            std::array<bool, 2> seen{}; // by whether the place lies in the cube, off its sides
            for (unsigned i = 0; i < 16; ++i) {
                PathRandom random(1, i);
                const glm::dvec2 offset = open->offset(u, v, random.next2());
                EXPECT_LE(std::max(std::abs(offset.x), std::abs(offset.y)), 0.5);
                const glm::dvec3 p = places->place(u, v, offset).point.position;
                seen[std::max(std::abs(p.x), std::abs(p.z)) < 1.98] = true;
            }
            within += seen[1] && !seen[0];
            cut += seen[1] && seen[0];
        }
    EXPECT_GT(floor, 1000u);
    EXPECT_EQ(cut, 0u);
    EXPECT_LT(within, floor / 5); // around the hidden ones, for taps beside the cube
}

} // namespace
} // namespace tessera::corpus
