#include "corpus/layers/shown_visibility.h"

#include "corpus/trace/path_random.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

// Few places have strong highlights, and the quality follows their mean: 4,096 were too few.
constexpr unsigned tried_places = 1u << 16;
constexpr std::uint64_t tried_sequence = 0x73686F77;
constexpr double tried_error = 0.1; // of a stored visibility

double shown_square(const glm::dvec3& light, const glm::dvec3& other) {
    double sum = 0;
    for (glm::length_t c = 0; c < 3; ++c) {
        const double change = linear_to_srgb(other[c]) - linear_to_srgb(light[c]);
        sum += change * change / 3.0;
    }
    return sum;
}

} // namespace

double shown_error_of_visibility(const ModelPlaces& places, const PlaceLight& light,
                                 std::span<const DistantLight> lights, double exposure) {
    const Texels2 size = places.texel_places().size();
    const std::vector<double> peaks = visibility_peaks(lights);
    double squares = 0, count = 0;
    for (unsigned i = 0; i < tried_places; ++i) {
        PathRandom random(tried_sequence, i);
        const glm::dvec2 at = random.next2();
        const auto u = std::min(static_cast<std::uint32_t>(at.x * size[0]), size[0] - 1);
        const auto v = std::min(static_cast<std::uint32_t>(at.y * size[1]), size[1] - 1);
        if (!light.matters(u, v))
            continue;
        const ModelSurfacePlace place = places.place(u, v, {0.0, 0.0});
        const Lobes lobes = without_coats(place.point.lobes);
        const glm::dvec3 view = sample_cosine(place.point.normal, random.next2());
        const Reflectance reflectance{.normal = place.point.normal,
                                      .view = view,
                                      .specular = lobes.facing,
                                      .roughness = std::sqrt(lobes.alpha)};
        const auto arriving =
            light.diffuse(glm::dvec2(u + 0.5, v + 0.5), place.chart, place.point.normal);
        glm::dvec3 leaving = arriving ? lobes.diffuse * *arriving * exposure : glm::dvec3(0.0);
        std::vector<glm::dvec3> highlights;
        for (std::size_t j = 0; j < lights.size(); ++j) {
            highlights.push_back(reflectance.of(lights[j]));
            leaving += highlights.back() * (light.visibility(u, v, j) / 255.0);
        }
        for (std::size_t j = 0; j < lights.size(); ++j)
            squares += shown_square(
                leaving, glm::max(leaving - highlights[j] * (tried_error / peaks[j]), 0.0));
        ++count;
    }
    return count > 0 ? std::sqrt(squares / count) / tried_error : 0.0;
}

} // namespace tessera::corpus
