#include "format/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera {
namespace {

constexpr double least_cosine = 0.02;     // between a normal and the direction to the observer
constexpr double least_peak = 1.0 / 51.0; // five steps of 8 bits
constexpr double least_roughness = 0.03;
constexpr double first_lobe = 0.05;   // roughness of the first lobe of the environment
constexpr double little_light = 1e-6; // where no light is mirrored, the environment is not blocked
// Up to the first roughness, the environment replaces lights with a spread, and from the second on it
// does not: there its round lobes are further from the truth than the highlights of lights are.
constexpr double sharp_roughness = 0.1, rough_roughness = 0.4;
// A microfacet turns half as far as the light that it reflects. A larger share is closer to the truth,
// because lights are patches with sharp edges (FlightHelmet: 31.4 and 31.6 dB at 0.5, 31.6 at 0.75).
constexpr double spread_share = 0.75;
constexpr double least_squeeze = 0.01;
constexpr double least_sine2 = 1e-12; // of the angle between two directions

// The share of a uniform surrounding that the surface reflects is, by the split sum of Karis ("Real
// shading in Unreal Engine 4", 2013), a scale times its reflectance plus a bias. Both are polynomials
// of the view's cosine (columns, ascending powers) and the roughness (rows), fitted to the integrals
// with an error of 0.017 and 0.010 (root mean square). Karis's own fit for mobile GPUs, made for
// another shadowing term, has 0.128 and 0.020.
using ShareFit = std::array<std::array<double, 4>, 4>;
constexpr ShareFit scale_fit{{{0.005, 4.342, -6.276, 2.906},
                              {1.07, -7.577, 16.225, -9.22},
                              {1.467, -4.067, -5.616, 6.752},
                              {-1.745, 6.274, -3.532, -0.735}}};
constexpr ShareFit bias_fit{{{1.048, -4.432, 6.109, -2.742},
                             {-2.27, 12.147, -19.452, 9.669},
                             {1.162, -10.616, 20.845, -11.548},
                             {0.126, 2.675, -7.248, 4.528}}};

double reflected_share(const ShareFit& fit, double cosine, double rough) {
    double sum = 0;
    for (auto row = fit.rbegin(); row != fit.rend(); ++row)
        sum = sum * rough +
              ((*row)[0] + cosine * ((*row)[1] + cosine * ((*row)[2] + cosine * (*row)[3])));
    return std::clamp(sum, 0.0, 1.0);
}

// Smooth surfaces mirror the layer of the environment, and lights say how much of it is blocked. Round
// highlights say that better (balls of roughness 0.1, 0.15 and 0.2: 30.3, 28.9 and 28.4 dB instead of
// 30.0, 27.9 and 28.0).
double stretched_share(double roughness) {
    return std::clamp(10.0 * roughness - 1.5, 0.0, 1.0);
}

double fifth_power(double x) {
    return x * x * x * x * x;
}

// The part of a light that is above the horizon of a surface.
struct PartAbove {
    glm::dvec3 toward; // its middle, of unit length
    double cosine;     // of the angle between that and the normal
    double share;      // of the light that it gives
};

// Part of a light may be above the horizon although its middle is below. The middle of that part is
// about as high as it would be for a disc that the horizon cuts. Renderers clip spherical lamps at
// the horizon, too (Lagarde and de Rousiers, "Moving Frostbite to physically based rendering", 2014).
PartAbove part_above(const glm::dvec3& light, const glm::dvec3& normal, double spread) {
    constexpr double share_at_horizon = 0.6, full_share = 3.0, least = 1e-6;
    const double z = glm::dot(normal, light);
    const double raised = 0.5 * (z + std::sqrt(z * z + 4.0 * spread * spread));
    const glm::dvec3 middle = light + (raised - z) * normal;
    const double length = glm::length(middle);
    return {middle / length, raised / length,
            std::clamp(share_at_horizon + z / std::max(full_share * spread, least), 0.0, 1.0)};
}

} // namespace

glm::dvec3 blended(const glm::dvec3& light, double opacity, const glm::dvec3& behind) {
    return glm::clamp(opacity * light + (1.0 - opacity) * behind, 0.0, 1.0);
}

glm::dvec3 bumped_normal(const SurfaceFrame& frame, const glm::dvec2& xy) {
    const double square = glm::dot(xy, xy);
    const glm::dvec2 flat = square > 1.0 ? xy / std::sqrt(square) : xy;
    return glm::normalize(frame.ex * flat.x + frame.ey * flat.y +
                          frame.ez * std::sqrt(std::max(0.0, 1.0 - square)));
}

glm::dvec3 facing_normal(const glm::dvec3& normal, const glm::dvec3& view) {
    const double cosine = glm::dot(normal, view);
    return cosine < least_cosine ? glm::normalize(normal + (least_cosine - cosine) * view) : normal;
}

std::vector<double> visibility_peaks(std::span<const DistantLight> lights) {
    std::vector<double> peaks;
    double most = 0;
    for (const DistantLight& light : lights) {
        const glm::vec3& x = light.irradiance;
        peaks.push_back(static_cast<double>(std::max({x.x, x.y, x.z})));
        most = std::max(most, peaks.back());
    }
    for (double& peak : peaks)
        peak = most > 0.0 ? std::max(std::sqrt(peak / most), least_peak) : 1.0;
    return peaks;
}

void LightSum::add(const DistantLight& light, const glm::dvec3& specular, double seen) {
    if (light.spread > 0.0f) {
        patches += specular * seen;
        unblocked += specular;
    } else {
        points += specular * seen;
    }
}

glm::dvec3 LightSum::share_seen() const {
    return (patches + little_light) / (unblocked + little_light);
}

glm::dvec3 LightSum::with_environment(const glm::dvec3& environment, double roughness) const {
    const double share =
        std::clamp((roughness - sharp_roughness) / (rough_roughness - sharp_roughness), 0.0, 1.0);
    return points + share * patches + (1.0 - share) * share_seen() * environment;
}

// A microfacet that turns across the plane of the view turns the mirrored light less, by the view's
// cosine: aslant, highlights are narrow. A round lobe that is as narrow is closer to that than one as
// wide as the highlight is long.
double environment_lobe(const Reflectance& reflectance, std::uint32_t lobes) {
    const double cosine = std::clamp(glm::dot(reflectance.normal, reflectance.view), 0.0, 1.0);
    const double roughness = reflectance.roughness * std::sqrt(cosine);
    return std::clamp(std::log2(std::max(roughness, first_lobe) / first_lobe), 0.0,
                      static_cast<double>(lobes) - 1.0);
}

glm::dvec3 Reflectance::of(const DistantLight& light) const {
    const double stretched = stretched_share(roughness), nv = glm::dot(normal, view);
    const auto [l, nl, above] = part_above(glm::dvec3(light.direction), normal,
                                           stretched * static_cast<double>(light.spread));
    if (above <= 0.0 || nv <= 0.0)
        return glm::dvec3(0.0);
    const glm::dvec3 h = glm::normalize(l + view);
    const double nh = std::min(glm::dot(normal, h), 1.0);
    const double r = std::max(roughness, least_roughness), alpha = r * r;
    const double s2 = alpha * alpha, half_cosine = std::clamp(glm::dot(view, h), 0.0, 1.0);
    // Light that moves across the plane of l and the view turns the microfacet by more than light
    // that moves along it: aslant, a patch of light is mirrored as if it were wide.
    const double along = spread_share * static_cast<double>(light.spread);
    const double squeeze = 1.0 - stretched * (1.0 - half_cosine);
    const double across = along / std::max(squeeze, least_squeeze);
    const double along2 = std::min(s2 + along * along, 1.0),
                 across2 = std::min(s2 + across * across, 1.0);
    const glm::dvec3 axis = glm::cross(l, view), sine = glm::cross(normal, h);
    const double out_of_plane = glm::dot(normal, axis);
    const double x2 = out_of_plane * out_of_plane / std::max(glm::dot(axis, axis), least_sine2);
    const double root = nh * nh + std::max(glm::dot(sine, sine) - x2, 0.0) / along2 + x2 / across2;
    const double density = 1.0 / (std::numbers::pi * std::sqrt(along2 * across2) * root * root);
    const double visibility = 0.5 / (nl * std::sqrt(s2 + (1.0 - s2) * nv * nv) +
                                     nv * std::sqrt(s2 + (1.0 - s2) * nl * nl));
    const glm::dvec3 fresnel =
        specular + (glm::dvec3(1.0) - specular) * fifth_power(1.0 - half_cosine);
    return fresnel * (above * density * visibility * nl) * glm::dvec3(light.irradiance);
}

glm::dvec3 Reflectance::of_reflection() const {
    const double r = std::max(roughness, least_roughness);
    const double c = std::clamp(glm::dot(normal, view), 0.0, 1.0);
    return specular * reflected_share(scale_fit, c, r) +
           glm::dvec3(reflected_share(bias_fit, c, r));
}

} // namespace tessera
