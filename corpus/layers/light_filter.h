// A filter of noisy light that keeps edges.
#pragma once

#include "corpus/layers/rows.h"
#include "corpus/surface/atlas.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tessera::corpus {

// Light of a texel from random paths, in two halves whose errors are independent.
struct NoisyLight {
    std::array<glm::vec3, 2> halves{glm::vec3(0.0f), glm::vec3(0.0f)}; // sums over the paths
    std::uint32_t paths = 0; // of each half; 0: no light is known
};

// Averages the light of a texel and of texels around it, on the same chart and facing alike, that
// differ by no more than their noise. Which texels are averaged in one half depends on the other
// half, so that errors do not select each other (Rousselle, Knaus and Zwicker, "Adaptive rendering
// with non-local means filtering", 2012), and what the halves differ by afterwards is the noise that
// is left. The mean is that of a plane of least squares, because at the border of a chart all texels
// lie on one side. Immutable and thread-safe. Memory: 28 bytes per texel.
class LightFilter {
public:
    static constexpr std::uint32_t reach = 6;
    static constexpr std::size_t row = 2 * reach + 1, window = row * row;

    // All spans are per texel and outlive the filter. Errors: those of for_rows().
    static Result<LightFilter> make(const Texels2& size, std::span<const NoisyLight> light,
                                    std::span<const std::uint32_t> charts,
                                    std::span<const glm::vec3> normals, const BakeRun& run);

    // The mean light of each half. `shares`, if not empty, has `window` zeros, which are replaced by
    // the shares of the paths of the texels around (u, v) in the mean of both halves; they may be
    // negative. Precondition: light is known there.
    std::array<glm::vec3, 2> filtered(std::uint32_t u, std::uint32_t v,
                                      std::span<float> shares = {}) const;
    static std::size_t slot(int x, int y) {
        return static_cast<std::size_t>((y + static_cast<int>(reach)) * static_cast<int>(row) + x +
                                        static_cast<int>(reach));
    }
    // Calls visit(texel, x, y) for the texels of the same chart up to `far` texels away, where light
    // is known; (x, y) is the way to them.
    template <class Visit>
    void visit(std::uint32_t u, std::uint32_t v, std::uint32_t far, const Visit& visit) const {
        const std::uint32_t chart = charts_[index(u, v)];
        for (std::uint32_t y = v - std::min(v, far); y <= std::min(v + far, size_[1] - 1); ++y)
            for (std::uint32_t x = u - std::min(u, far); x <= std::min(u + far, size_[0] - 1); ++x)
                if (const std::size_t q = index(x, y); light_[q].paths > 0 && charts_[q] == chart)
                    visit(q, static_cast<int>(x) - static_cast<int>(u),
                          static_cast<int>(y) - static_cast<int>(v));
    }

private:
    struct Guide {
        std::array<glm::vec3, 2> halves{glm::vec3(0.0f), glm::vec3(0.0f)}; // blurred
        float variance = 0;                                                // of each of them
    };

    LightFilter() = default;
    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }

    Texels2 size_{0, 0};
    std::span<const NoisyLight> light_;
    std::span<const std::uint32_t> charts_;
    std::span<const glm::vec3> normals_;
    std::vector<Guide> guides_;
};

} // namespace tessera::corpus
