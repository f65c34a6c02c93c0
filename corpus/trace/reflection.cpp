#include "corpus/trace/reflection.h"

#include "corpus/trace/sheen.h"

namespace tessera::corpus {
namespace {

constexpr double clear_facing = 0.04; // of an index of 1.5
constexpr double uniform_density = 0.5 / std::numbers::pi;

double largest_part(const glm::dvec3& x) {
    return std::max({x.x, x.y, x.z});
}

double clear_fresnel(double cosine) {
    return clear_facing + (1.0 - clear_facing) * fifth(1.0 - cosine);
}

// The mean over the directions of diffuse light, by its lobe.
double mean_clear_fresnel() {
    constexpr int steps = 4096;
    double sum = 0, weights = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        sum += cosine * clear_fresnel(cosine);
        weights += cosine;
    }
    return sum / weights;
}

// What the sheen takes from other lobes.
double sheen_share(const Coats& coats, double cosine) {
    const double most = largest_part(coats.sheen);
    return most > 0.0 ? most * sheen_albedo(coats.sheen_alpha, cosine) : 0.0;
}

// The microfacets of the base: GGX that may be longer along one direction.
struct Microfacets {
    glm::dvec2 alpha;
    glm::dvec3 normal, x, y;
    explicit Microfacets(const LitPoint& p) : alpha(p.lobes.alpha), normal(p.normal) {
        const Coats& coats = p.lobes.coats;
        glm::dvec3 along = coats.along - normal * glm::dot(coats.along, normal);
        const double length = glm::length(along);
        if (coats.along_alpha > 0.0 && length > 1e-6) {
            alpha.x = coats.along_alpha;
            along /= length;
        } else {
            along = any_tangent(normal);
        }
        x = along;
        y = glm::cross(normal, along);
    }
    glm::dvec3 local(const glm::dvec3& d) const {
        return {glm::dot(d, x), glm::dot(d, y), glm::dot(d, normal)};
    }
    double root(const glm::dvec3& d) const {
        const glm::dvec3 v = local(d);
        return glm::length(glm::dvec3(alpha.x * v.x, alpha.y * v.y, v.z));
    }
    // The density of microfacets per steradian.
    double density(const glm::dvec3& half) const {
        const glm::dvec3 h = local(half);
        const double s =
            h.x * h.x / (alpha.x * alpha.x) + h.y * h.y / (alpha.y * alpha.y) + h.z * h.z;
        return 1.0 / (std::numbers::pi * alpha.x * alpha.y * s * s);
    }
};

struct Shares {
    double base = 1.0, clear = 0.0, sheen = 0.0;
};

// How often each lobe is sampled.
Shares shares_of(const LitPoint& p, const glm::dvec3& view) {
    constexpr double least = 0.1; // of the base
    const Coats& coats = p.lobes.coats;
    const double nv = std::clamp(glm::dot(p.normal, view), 0.0, 1.0);
    Shares s;
    s.base = std::max(largest_part(fresnel(p.lobes, nv)), least);
    if (coats.clear > 0.0)
        s.clear = coats.clear * clear_fresnel(glm::dot(coats.clear_normal, view));
    s.sheen = sheen_share(coats, nv);
    const double sum = s.base + s.clear + s.sheen;
    return {s.base / sum, s.clear / sum, s.sheen / sum};
}

Thrown with_coats(const LitPoint& p, const glm::dvec3& view, const glm::dvec3& l, double nl,
                  double nv) {
    const Coats& coats = p.lobes.coats;
    const Shares shares = shares_of(p, view);
    const glm::dvec3 h = glm::normalize(l + view);
    const double vh = glm::dot(view, h), nh = std::min(glm::dot(p.normal, h), 1.0);
    const Microfacets facets(p);
    const double root_v = facets.root(view), root_l = facets.root(l), facet = facets.density(h);
    const double below_clear = coats.clear > 0.0 ? 1.0 - coats.clear * clear_fresnel(vh) : 1.0;
    const double below_sheen = 1.0 - std::max(sheen_share(coats, nl), sheen_share(coats, nv));
    Thrown thrown;
    thrown.share = fresnel(p.lobes, vh) *
                   (facet * 0.5 / (nl * root_v + nv * root_l) * nl * below_clear * below_sheen);
    thrown.density = shares.base * facet * 0.5 / (nv + root_v);
    if (shares.sheen > 0.0) {
        thrown.share +=
            coats.sheen * (sheen_lobe(coats.sheen_alpha, nh, nl, nv) * nl * below_clear);
        thrown.density += shares.sheen * uniform_density;
    }
    const double cl = glm::dot(coats.clear_normal, l), cv = glm::dot(coats.clear_normal, view);
    if (coats.clear > 0.0 && cl > 0.0 && cv > 0.0) {
        const double ch = std::min(glm::dot(coats.clear_normal, h), 1.0);
        thrown.share += coats.clear * clear_fresnel(vh) * ggx(coats.clear_alpha, ch) *
                        smith_visibility(coats.clear_alpha, cl, cv) * cl;
        thrown.density += shares.clear * ggx_density(coats.clear_alpha, ch, cv);
    }
    return thrown;
}

glm::dvec3 sample_hemisphere(const glm::dvec3& normal, const glm::dvec2& random) {
    const glm::dvec3 x = any_tangent(normal), y = glm::cross(normal, x);
    const double up = random.x, flat = std::sqrt(std::max(0.0, 1.0 - up * up));
    const double angle = 2.0 * std::numbers::pi * random.y;
    return x * (flat * std::cos(angle)) + y * (flat * std::sin(angle)) + normal * up;
}

} // namespace

double mean_below_coats(const Coats& coats) {
    static const double clear_mean = mean_clear_fresnel();
    const double most = largest_part(coats.sheen);
    return (1.0 - coats.clear * clear_mean) *
           (most > 0.0 ? 1.0 - most * mean_sheen_albedo(coats.sheen_alpha) : 1.0);
}

double below_coats(const LitPoint& p, const glm::dvec3& direction) {
    if (!p.lobes.has_coats)
        return 1.0;
    const Coats& coats = p.lobes.coats;
    const double clear = coats.clear > 0.0
                             ? coats.clear * clear_fresnel(glm::dot(coats.clear_normal, direction))
                             : 0.0;
    return (1.0 - clear) *
           (1.0 - sheen_share(coats, std::clamp(glm::dot(p.normal, direction), 0.0, 1.0)));
}

Thrown DiffuseLobe::operator()(const glm::dvec3& l) const {
    const double nl = glm::dot(p.normal, l);
    if (nl <= 0.0 || glm::dot(p.face, l) <= 0.0)
        return {};
    Thrown thrown{diffuse_colour(p.lobes) * (nl * p.opacity), cosine_density(nl)};
    if (p.lobes.has_coats)
        thrown.share *= below_coats(p, l) / mean_below_coats(p.lobes.coats);
    return thrown;
}

Thrown SpecularLobe::operator()(const glm::dvec3& l) const {
    const double nl = glm::dot(p.normal, l), nv = glm::dot(p.normal, view);
    if (nl <= 0.0 || nv <= 0.0 || glm::dot(p.face, l) <= 0.0)
        return {};
    if (p.lobes.has_coats) {
        Thrown thrown = with_coats(p, view, l, nl, nv);
        thrown.share *= p.opacity;
        return thrown;
    }
    const glm::dvec3 h = glm::normalize(l + view);
    const double nh = std::min(glm::dot(p.normal, h), 1.0);
    const double alpha = p.lobes.alpha;
    return {fresnel(p.lobes, glm::dot(view, h)) *
                (ggx(alpha, nh) * smith_visibility(alpha, nl, nv) * nl * p.opacity),
            ggx_density(alpha, nh, nv)};
}

glm::dvec3 SpecularLobe::sample(PathRandom& random) const {
    if (!p.lobes.has_coats)
        return sample_ggx(p.lobes.alpha, p.normal, view, random.next2());
    const Shares shares = shares_of(p, view);
    const double choice = random.next();
    const glm::dvec2 x = random.next2();
    if (choice < shares.clear)
        return sample_ggx(p.lobes.coats.clear_alpha, p.lobes.coats.clear_normal, view, x);
    if (choice < shares.clear + shares.sheen)
        return sample_hemisphere(p.normal, x);
    const Microfacets facets(p);
    const glm::dvec3 facet = sample_facet(facets.alpha, facets.normal, facets.x, view, x);
    return 2.0 * glm::dot(view, facet) * facet - view;
}

double SpecularLobe::strength() const {
    const double nv = glm::dot(p.normal, view);
    double strength = largest_part(fresnel(p.lobes, nv));
    if (p.lobes.has_coats)
        strength += 1.0 - below_coats(p, view);
    return strength;
}

double SpecularLobe::width() const {
    const Coats& coats = p.lobes.coats;
    if (!p.lobes.has_coats)
        return p.lobes.alpha;
    if (largest_part(coats.sheen) > 0.0)
        return 1.0;
    return std::max(
        {p.lobes.alpha, coats.along_alpha, coats.clear > 0.0 ? coats.clear_alpha : 0.0});
}

BothLobes::BothLobes(const LitPoint& p, const glm::dvec3& view)
    : diffuse{p}, specular{p, view}, specular_share(1.0) {
    const double s = specular.strength(), d = largest_part(p.lobes.diffuse);
    if (d > 0.0)
        specular_share = std::clamp(s / (s + d), 0.1, 0.9);
}

Thrown BothLobes::operator()(const glm::dvec3& l) const {
    const Thrown d = diffuse(l), s = specular(l);
    return {d.share * below_coats(diffuse.p, specular.view) + s.share,
            d.density * (1.0 - specular_share) + s.density * specular_share};
}

glm::dvec3 BothLobes::sample(PathRandom& random) const {
    const bool is_specular = random.next() < specular_share;
    return is_specular ? specular.sample(random) : sample_cosine(diffuse.p.normal, random.next2());
}

double BothLobes::width() const {
    return largest_part(diffuse.p.lobes.diffuse) > 0.0 ? DiffuseLobe::width() : specular.width();
}

Lobes without_coats(const Lobes& lobes) {
    if (!lobes.has_coats)
        return lobes;
    const Coats& coats = lobes.coats;
    Lobes bare = lobes;
    bare.has_coats = false;
    bare.coats = {};
    const double below = mean_below_coats(coats);
    const double sheen = largest_part(coats.sheen) > 0.0 ? mean_sheen_albedo(coats.sheen_alpha) : 0;
    bare.diffuse = lobes.diffuse * below + coats.sheen * sheen;
    const glm::dvec3 base = fresnel(lobes, 1.0) * below;
    const double clear = coats.clear * clear_facing, strength = largest_part(base);
    bare.facing = glm::min(base + clear, glm::dvec3(1.0));
    bare.grazing = std::max(lobes.grazing, coats.clear);
    double alpha = lobes.alpha;
    if (coats.along_alpha > 0.0)
        alpha = std::sqrt(alpha * coats.along_alpha);
    if (clear > 0.0) {
        const double roughness =
            (std::sqrt(alpha) * strength + std::sqrt(coats.clear_alpha) * clear) /
            (strength + clear);
        alpha = roughness * roughness;
    }
    bare.alpha = alpha;
    return bare;
}

} // namespace tessera::corpus
