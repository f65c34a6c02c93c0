// A filter of noisy light that keeps edges.
#pragma once

#include "corpus/layers/rows.h"
#include "corpus/surface/atlas.h"

#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace tessera::corpus {

// Light of a texel from random paths, in two halves whose errors are independent.
struct NoisyLight {
    std::array<glm::vec3, 2> halves{glm::vec3(0.0f), glm::vec3(0.0f)}; // sums over the paths
    std::uint32_t paths = 0; // of each half; 0: no light is known
};

// Averages the light of a texel and of texels around it that face alike and differ by no more than
// their noise. Which texels are averaged in one half depends on the other half, so that errors do
// not select each other (Rousselle, Knaus and Zwicker, "Adaptive rendering with non-local means
// filtering", 2012), and what the halves differ by afterwards is the noise that is left. The mean is
// that of a plane of least squares, because where the surface ends all texels lie on one side.
// Immutable and thread-safe. Memory: 28 bytes per texel.
class LightFilter {
public:
    // Which texel shows the place (x, y) texels from texel (u, v), beyond its chart.
    using Beside =
        std::function<std::optional<Texels2>(std::uint32_t u, std::uint32_t v, int x, int y)>;

    // All spans are per texel and outlive the filter, and `beside`, if it is not empty, is
    // thread-safe. Errors: those of for_rows().
    static Result<LightFilter> make(const Texels2& size, std::span<const NoisyLight> light,
                                    std::span<const std::uint32_t> charts,
                                    std::span<const glm::vec3> normals, const BakeRun& run,
                                    Beside beside = {});

    // The share of a texel's paths in the mean of both halves. It may be negative.
    struct Share {
        std::size_t texel = 0;
        float share = 0;
    };
    // The mean light of each half. Those of the texels around (u, v) replace `shares`, unless it is
    // null. Precondition: light is known there.
    std::array<glm::vec3, 2> filtered(std::uint32_t u, std::uint32_t v,
                                      std::vector<Share>* shares = nullptr) const;

private:
    struct Guide {
        std::array<glm::vec3, 2> halves{glm::vec3(0.0f), glm::vec3(0.0f)}; // blurred
        float variance = 0;                                                // of each of them
    };

    LightFilter() = default;
    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }
    // Calls visit(texel, x, y) for the texels up to `far` texels away, where light is known; (x, y)
    // is the way to them. Beyond the chart they are those of the charts that continue it.
    template <class Visit>
    void visit(std::uint32_t u, std::uint32_t v, std::uint32_t far, const Visit& visit) const {
        const std::uint32_t chart = charts_[index(u, v)];
        const auto reach_of = static_cast<int>(far);
        for (int y = -reach_of; y <= reach_of; ++y)
            for (int x = -reach_of; x <= reach_of; ++x) {
                const std::int64_t qu = std::int64_t{u} + x, qv = std::int64_t{v} + y;
                if (qu >= 0 && qv >= 0 && qu < size_[0] && qv < size_[1]) {
                    const std::size_t q =
                        index(static_cast<std::uint32_t>(qu), static_cast<std::uint32_t>(qv));
                    if (light_[q].paths > 0 && charts_[q] == chart) {
                        visit(q, x, y);
                        continue;
                    }
                }
                if (!beside_)
                    continue;
                if (const auto other = beside_(u, v, x, y))
                    if (const std::size_t q = index((*other)[0], (*other)[1]); light_[q].paths > 0)
                        visit(q, x, y);
            }
    }

    Texels2 size_{0, 0};
    std::span<const NoisyLight> light_;
    std::span<const std::uint32_t> charts_;
    std::span<const glm::vec3> normals_;
    Beside beside_;
    std::vector<Guide> guides_;
};

} // namespace tessera::corpus
