#include "corpus/trace/thin_film.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr double film_pi = std::numbers::pi;

double film_square(double x) {
    return x * x;
}

double film_schlick(double facing, double cosine) {
    return facing + (1.0 - facing) * std::pow(std::clamp(1.0 - cosine, 0.0, 1.0), 5.0);
}

double facing_between(double ior, double incident_ior) {
    return film_square((ior - incident_ior) / (ior + incident_ior));
}

// The colour matching functions in Fourier space, as sRGB: of a path difference in nanometres, and
// phase shifts of the three channels.
glm::dvec3 sensitivity(double path, const glm::dvec3& shift) {
    const double phase = 2.0 * film_pi * path * 1e-9;
    const glm::dvec3 value{5.4856e-13, 4.4201e-13, 5.2481e-13},
        position{1.6810e+06, 1.7953e+06, 2.2084e+06}, variance{4.3278e+09, 9.3046e+09, 6.6121e+09};
    glm::dvec3 xyz(0.0);
    for (glm::length_t c = 0; c < 3; ++c)
        xyz[c] = value[c] * std::sqrt(2.0 * film_pi * variance[c]) *
                 std::cos(position[c] * phase + shift[c]) *
                 std::exp(-film_square(phase) * variance[c]);
    xyz.x += 9.7470e-14 * std::sqrt(2.0 * film_pi * 4.5282e+09) *
             std::cos(2.2399e+06 * phase + shift.x) * std::exp(-4.5282e+09 * film_square(phase));
    const glm::dmat3 to_srgb(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259,
                             -0.4985314, 0.0415560, 1.0572252);
    return to_srgb * (xyz / 1.0685e-7);
}

} // namespace

glm::dvec3 film_reflectance(double cosine, double film_ior, double nanometres,
                            const glm::dvec3& base) {
    // Without thickness the film is air.
    const double ior = glm::mix(1.0, film_ior, glm::smoothstep(0.0, 0.03, nanometres));
    const double squared_cosine =
        1.0 - (1.0 - film_square(cosine)) / film_square(ior); // in the film
    if (squared_cosine < 0.0)
        return glm::dvec3(1.0);
    const double inside = std::sqrt(squared_cosine);
    const double first = film_schlick(facing_between(ior, 1.0), cosine);
    const double passed = 1.0 - first; // into the film and out of it: squared
    const double phase_within = ior < 1.0 ? 0.0 : film_pi;
    glm::dvec3 second(0.0), phase(0.0);
    for (glm::length_t c = 0; c < 3; ++c) {
        const double root = std::sqrt(std::clamp(base[c], 0.0, 0.9999));
        const double base_ior = (1.0 + root) / (1.0 - root);
        second[c] = film_schlick(facing_between(base_ior, ior), inside);
        phase[c] = phase_within + (base_ior < ior ? film_pi : 0.0);
    }
    const double path = 2.0 * ior * nanometres * inside;
    const glm::dvec3 both = glm::clamp(first * second, 1e-5, 0.9999);
    const glm::dvec3 once = film_square(passed) * second / (1.0 - both);
    glm::dvec3 sum = first + once;
    glm::dvec3 amplitude = once - passed;
    for (int order = 1; order <= 2; ++order) {
        amplitude *= glm::sqrt(both);
        const double n = order;
        sum += amplitude * 2.0 * sensitivity(n * path, n * phase);
    }
    return glm::clamp(sum, 0.0, 1.0); // some colours lie outside sRGB
}

} // namespace tessera::corpus
