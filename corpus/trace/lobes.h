// How a place of a model reflects light: the metallic-roughness material of glTF.
//
// The specular lobe is that of glTF's appendix B: GGX, Smith's height-correlated shadowing and
// Schlick's Fresnel term. The diffuse lobe is Lambert's times 1 - 0.04, the mean of the Fresnel
// factor of appendix B: over all directions of light it differs from that by 4 % (root of the mean
// square). It is the same for all views, so diffuse light is baked once per place. As in appendix
// B, light that bounces between microfacets is lost.
#pragma once

#include "corpus/trace/thin_film.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>

namespace tessera::corpus {

// What extensions of glTF add; see reflection.h and Tracer::transmitted().
struct Coats {
    double clear = 0.0, clear_alpha = 1.0; // share and GGX of the clear coat
    glm::dvec3 clear_normal{0.0};
    glm::dvec3 sheen{0.0};
    double sheen_alpha = 1.0;
    // GGX along a tangent; Lobes::alpha is that across. 0 for both without anisotropy.
    double along_alpha = 0.0;
    glm::dvec3 along{0.0};
    double film = 0.0, film_ior = 1.3, film_nanometres = 0.0; // share of the film
    glm::dvec3 through{0.0};                                  // colour of what passes
    double through_alpha = 1.0;
    bool is_volume = false;
    double ior = 1.5;
    glm::dvec3 absorption{0.0}; // per unit of length
};

// The directions of the view and of light point away from the surface.
struct Lobes {
    glm::dvec3 diffuse{0.0}; // colour; 0 for metal
    glm::dvec3 facing{0.04}; // Fresnel reflectance at normal incidence, below any film
    double alpha = 1.0;      // of GGX: the square of the roughness
    double grazing = 1.0;    // Fresnel reflectance at grazing incidence
    bool has_coats = false;
    Coats coats{};
};

inline double fifth(double x) {
    const double y = std::clamp(x, 0.0, 1.0);
    return y * y * y * y * y;
}

// The diffuse lobe.
inline glm::dvec3 diffuse_colour(const Lobes& lobes) {
    return lobes.diffuse * (0.96 / std::numbers::pi);
}

inline glm::dvec3 fresnel(const Lobes& lobes, double cosine) {
    const glm::dvec3 bare =
        lobes.facing + (glm::dvec3(lobes.grazing) - lobes.facing) * fifth(1.0 - cosine);
    const Coats& coats = lobes.coats;
    if (!(coats.film > 0.0))
        return bare;
    return glm::mix(bare,
                    film_reflectance(cosine, coats.film_ior, coats.film_nanometres, lobes.facing),
                    coats.film);
}

// The density of microfacets, per steradian, at this cosine between half vector and normal.
inline double ggx(double alpha, double cosine) {
    const double a = alpha * alpha;
    const double x = cosine * cosine * (a - 1.0) + 1.0;
    return a / (std::numbers::pi * x * x);
}

// The root in Smith's shadowing term: sqrt(a^2 + (1 - a^2) c^2).
inline double smith_root(double alpha, double cosine) {
    return std::sqrt(alpha * alpha + (1.0 - alpha * alpha) * cosine * cosine);
}

// Smith's G / (4 (n.l) (n.v)).
inline double smith_visibility(double alpha, double nl, double nv) {
    return 0.5 / (nl * smith_root(alpha, nv) + nv * smith_root(alpha, nl));
}

// The density, per steradian, of the directions of sample_ggx().
inline double ggx_density(double alpha, double nh, double nv) {
    // G1 D (v.h) / (n.v) / (4 (v.h))
    return ggx(alpha, nh) * 0.5 / (nv + smith_root(alpha, nv));
}

inline glm::dvec3 any_tangent(const glm::dvec3& n) {
    const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(axis, n));
}

// The normal of a random microfacet that the view sees (Heitz 2018): GGX with one alpha along `x`
// and one across.
inline glm::dvec3 sample_facet(const glm::dvec2& alpha, const glm::dvec3& normal,
                               const glm::dvec3& x, const glm::dvec3& view,
                               const glm::dvec2& random) {
    const glm::dvec3 y = glm::cross(normal, x);
    const glm::dvec3 stretched =
        glm::normalize(glm::dvec3(alpha.x * glm::dot(view, x), alpha.y * glm::dot(view, y),
                                  std::max(glm::dot(view, normal), 1e-6)));
    // From there the hemisphere looks like a half disk and half an ellipse that meet along t1.
    const double flat = std::hypot(stretched.x, stretched.y);
    const glm::dvec3 t1 =
        flat > 1e-9 ? glm::dvec3(-stretched.y, stretched.x, 0.0) / flat : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 t2 = glm::cross(stretched, t1);
    const double radius = std::sqrt(random.x), angle = 2.0 * std::numbers::pi * random.y;
    const double p1 = radius * std::cos(angle);
    const double share = 0.5 * (1.0 + stretched.z);
    const double p2 =
        (1.0 - share) * std::sqrt(std::max(0.0, 1.0 - p1 * p1)) + share * radius * std::sin(angle);
    const glm::dvec3 h =
        p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1.0 - p1 * p1 - p2 * p2)) * stretched;
    return glm::normalize(x * (alpha.x * h.x) + y * (alpha.y * h.y) + normal * std::max(1e-9, h.z));
}

// A direction of light: `view` mirrored at a random microfacet. It may point into the surface.
inline glm::dvec3 sample_ggx(double alpha, const glm::dvec3& normal, const glm::dvec3& view,
                             const glm::dvec2& random) {
    const glm::dvec3 facet =
        sample_facet(glm::dvec2(alpha), normal, any_tangent(normal), view, random);
    return 2.0 * glm::dot(view, facet) * facet - view;
}

// A direction above the surface whose density is proportional to the cosine.
inline glm::dvec3 sample_cosine(const glm::dvec3& normal, const glm::dvec2& random) {
    const glm::dvec3 x = any_tangent(normal), y = glm::cross(normal, x);
    const double radius = std::sqrt(random.x), angle = 2.0 * std::numbers::pi * random.y;
    return x * (radius * std::cos(angle)) + y * (radius * std::sin(angle)) +
           normal * std::sqrt(std::max(0.0, 1.0 - random.x));
}
inline double cosine_density(double cosine) {
    return std::max(cosine, 0.0) / std::numbers::pi;
}

} // namespace tessera::corpus
