#include "corpus/layers/light_filter.h"

namespace tessera::corpus {
namespace {

constexpr std::uint32_t reach = 6; // of the window whose light is averaged
constexpr std::size_t window = std::size_t{2 * reach + 1} * (2 * reach + 1);
constexpr std::uint32_t guide_reach = 2; // of the window from which guides are blurred
constexpr float facing_alike = 0.8f;     // cosine between normals

float mean_square(const glm::vec3& x) {
    return glm::dot(x, x) / 3.0f;
}

} // namespace

Result<LightFilter> LightFilter::make(const Texels2& size, std::span<const NoisyLight> light,
                                      std::span<const std::uint32_t> charts,
                                      std::span<const glm::vec3> normals, const BakeRun& run,
                                      Beside beside) {
    LightFilter filter;
    filter.size_ = size;
    filter.light_ = light;
    filter.charts_ = charts;
    filter.normals_ = normals;
    filter.beside_ = std::move(beside);
    filter.guides_.resize(light.size());
    TESSERA_TRY(for_rows("filtering light", size[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < size[0]; ++u) {
            const std::size_t p = filter.index(u, v);
            if (light[p].paths == 0)
                continue;
            Guide& guide = filter.guides_[p];
            float paths = 0, texels = 0, variance = 0; // variance: of one path
            filter.visit(u, v, guide_reach, [&](std::size_t q, int, int) {
                if (glm::dot(normals[p], normals[q]) < facing_alike)
                    return;
                const auto count = static_cast<float>(light[q].paths);
                const auto& [a, b] = light[q].halves;
                guide.halves[0] += a;
                guide.halves[1] += b;
                variance += mean_square((a - b) / count) * count / 2.0f;
                paths += count;
                ++texels;
            });
            for (glm::vec3& half : guide.halves)
                half /= paths;
            guide.variance = variance / (texels * paths);
        }
    }));
    return filter;
}

std::array<glm::vec3, 2> LightFilter::filtered(std::uint32_t u, std::uint32_t v,
                                               std::vector<Share>* shares) const {
    constexpr float most_deviations = 3.0f, never_differs = 0.004f;
    constexpr float narrow = 0.25f; // square texels; narrower sums have no slope
    constexpr float wide = (reach + 1.0f) * (reach + 1.0f);
    const std::size_t p = index(u, v);
    struct Weighted {
        std::size_t texel;
        float x, y;
        std::array<float, 2> weights;
    };
    std::array<Weighted, window> all;
    std::size_t count = 0;
    struct Moments {
        float one = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    };
    std::array<Moments, 2> moments;
    const Guide& guide = guides_[p];
    const std::array<float, 2> floors{never_differs * never_differs * mean_square(guide.halves[0]),
                                      never_differs * never_differs * mean_square(guide.halves[1])};
    visit(u, v, reach, [&](std::size_t q, int dx, int dy) {
        const float cosine = glm::dot(normals_[p], normals_[q]);
        const auto x = static_cast<float>(dx), y = static_cast<float>(dy);
        const float near = 1.0f - (x * x + y * y) / wide;
        if (cosine <= 0.0f || near <= 0.0f)
            return;
        const Guide& other = guides_[q];
        const float noise = most_deviations * most_deviations * (guide.variance + other.variance);
        Weighted w{q, x, y, {0.0f, 0.0f}};
        for (std::size_t h = 0; h < 2; ++h) {
            const std::size_t judge = 1 - h;
            const float far = mean_square(guide.halves[judge] - other.halves[judge]);
            const float alike = 1.0f - far / (noise + floors[judge] + 1e-20f);
            if (alike <= 0.0f)
                continue;
            w.weights[h] = alike * alike * near * cosine * cosine;
            const float mass = w.weights[h] * static_cast<float>(light_[q].paths);
            Moments& m = moments[h];
            m.one += mass;
            m.x += mass * x;
            m.y += mass * y;
            m.xx += mass * x * x;
            m.xy += mass * x * y;
            m.yy += mass * y * y;
        }
        all[count++] = w;
    });
    std::array<glm::vec3, 2> sums{glm::vec3(0.0f), glm::vec3(0.0f)};
    std::array<glm::vec3, 2>
        plane; // the share of a place is weight * (plane.x + x * plane.y + ...)
    for (std::size_t h = 0; h < 2; ++h) {
        const Moments& m = moments[h];
        const float xx = m.xx + narrow * m.one, yy = m.yy + narrow * m.one;
        const glm::vec3 row{xx * yy - m.xy * m.xy, m.xy * m.y - m.x * yy, m.x * m.xy - xx * m.y};
        plane[h] = row / (m.one * row.x + m.x * row.y + m.y * row.z);
    }
    if (shares)
        shares->clear();
    for (std::size_t i = 0; i < count; ++i) {
        const Weighted& w = all[i];
        float both = 0;
        for (std::size_t h = 0; h < 2; ++h) {
            const float share = w.weights[h] * (plane[h].x + plane[h].y * w.x + plane[h].z * w.y);
            sums[h] += share * light_[w.texel].halves[h];
            both += share;
        }
        if (shares)
            shares->push_back({w.texel, both / 4.0f});
    }
    for (glm::vec3& sum : sums)
        sum = glm::max(sum, 0.0f);
    return sums;
}

} // namespace tessera::corpus
