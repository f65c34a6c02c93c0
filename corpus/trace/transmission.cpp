// Light that passes surfaces: KHR_materials_transmission, KHR_materials_volume and blending.
#include "corpus/trace/rough_wall.h"
#include "corpus/trace/tracer.h"

#include <cmath>

namespace tessera::corpus {
namespace {

constexpr int most_clear_walls = 64;   // on the way of a shadow ray
constexpr int most_inner_bounces = 32; // within a volume
constexpr int sure_inner_bounces = 4;  // later ones are subject to Russian roulette

double largest_share(const glm::dvec3& x) {
    return std::max({x.x, x.y, x.z});
}

// What a microfacet lobe leaves of a sampled direction: G2 / G1 of Smith.
double shadowing(double alpha, double nl, double nv) {
    return 2.0 * nl * (nv + smith_root(alpha, nv)) * smith_visibility(alpha, nl, nv);
}

// The share of light that goes straight through a clear wall.
glm::dvec3 clear_share(const LitPoint& p, const glm::dvec3& view) {
    return p.lobes.coats.through * (glm::dvec3(1.0) - fresnel(p.lobes, glm::dot(p.normal, view))) *
           below_coats(p, view);
}

// The direction that a facet bends `view` to; nothing if it reflects all light. `ratio`: the index
// of refraction on the view's side by that on the other.
std::optional<glm::dvec3> refracted(const glm::dvec3& view, const glm::dvec3& facet, double ratio) {
    const double cosine = glm::dot(view, facet);
    const double rest = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if (rest <= 0.0)
        return std::nullopt;
    return (ratio * cosine - std::sqrt(rest)) * facet - ratio * view;
}

} // namespace

double Tracer::passing_chance(const LitPoint& point, const glm::dvec3& view) {
    if (!passes_light(point))
        return 0.0;
    const double through = largest_share(clear_share(point, view));
    const double rest = SpecularLobe{point, view}.strength() + largest_share(point.lobes.diffuse);
    return rest > 0.0 ? std::clamp(through / (through + rest), 0.1, 0.95) : 1.0;
}

glm::dvec3 Tracer::passing_share(const glm::dvec3& start, const glm::dvec3& direction,
                                 double reach) const {
    if (!model_->lets_light_pass())
        return glm::dvec3(model_->is_blocked(start, direction, reach) ? 0.0 : 1.0);
    glm::dvec3 share(1.0), from = start;
    for (int i = 0; i < most_clear_walls; ++i) {
        const double gone = glm::dot(from - start, direction);
        if (!model_->is_blocked(from, direction, reach - gone))
            return share;
        const Hit hit = model_->first_hit(from, direction);
        if (!hit)
            return share;
        const LitPoint p = facing(model_->point(*hit), -direction);
        glm::dvec3 left(1.0 - p.opacity);
        if (is_clear_wall(p))
            left += p.opacity * clear_share(p, -direction);
        share *= left;
        if (!(largest_share(share) > 0.0))
            break;
        from = p.position + direction * off;
    }
    return glm::dvec3(0.0);
}

Tracer::PassedRay Tracer::pass(const LitPoint& point, const glm::dvec3& view,
                               PathRandom& random) const {
    const Coats& coats = point.lobes.coats;
    if (is_clear_wall(point))
        return {.origin = point.position - view * off,
                .direction = -view,
                .share = clear_share(point, view),
                .is_straight = true};
    PassedRay ray{.origin = point.position - point.face * off};
    if (is_rough_wall(point)) {
        const RoughWallLobe lobe{point, view};
        ray.direction = lobe.sample(random);
        if (const Thrown thrown = lobe(ray.direction); thrown.density > 0.0) {
            ray.share = thrown.share / thrown.density;
            ray.density = thrown.density;
        }
        return ray;
    }
    const double alpha = coats.through_alpha, nv = glm::dot(point.normal, view);
    const glm::dvec3 facet = sample_facet(glm::dvec2(alpha), point.normal,
                                          any_tangent(point.normal), view, random.next2());
    const glm::dvec3 left = (glm::dvec3(1.0) - fresnel(point.lobes, glm::dot(view, facet))) *
                            coats.through * below_coats(point, view);
    const auto inwards = refracted(view, facet, 1.0 / coats.ior);
    if (!inwards)
        return ray;
    const double nl = -glm::dot(point.normal, *inwards);
    if (nl <= 0.0 || glm::dot(*inwards, point.face) >= 0.0)
        return ray;
    ray.direction = *inwards;
    ray.share = left * shadowing(alpha, nl, nv);
    return leave_volume(ray, point, random);
}

// The light of a ray grows by the square of the index where it enters a volume and shrinks again
// where it leaves it. Neither is computed.
Tracer::PassedRay Tracer::leave_volume(PassedRay ray, const LitPoint& entry,
                                       PathRandom& random) const {
    const glm::dvec3 absorption = entry.lobes.coats.absorption;
    for (int bounce = 0; bounce < most_inner_bounces; ++bounce) {
        const auto side = model_->first_side(ray.origin, ray.direction);
        if (!side)
            return ray; // the volume is open
        ray.share *= glm::exp(-absorption * side->distance);
        if (!side->is_back)
            return ray; // meets what is within the volume
        LitPoint p = model_->point(side->place);
        const glm::dvec3 view = -ray.direction;
        p.normal = -p.normal; // seen from within
        p.face = -p.face;
        p = facing(p, view);
        const Coats& coats = p.lobes.coats;
        const double alpha = coats.through_alpha, nv = glm::dot(p.normal, view);
        const glm::dvec3 facet =
            sample_facet(glm::dvec2(alpha), p.normal, any_tangent(p.normal), view, random.next2());
        const auto outwards = refracted(view, facet, coats.ior);
        const glm::dvec3 mirrored =
            outwards ? fresnel(p.lobes, -glm::dot(*outwards, facet)) : glm::dvec3(1.0);
        const double chance = outwards ? std::clamp(largest_share(mirrored), 0.05, 0.95) : 1.0;
        const bool stays = random.next() < chance;
        ray.direction = stays ? 2.0 * glm::dot(view, facet) * facet - view : *outwards;
        const double nl = glm::dot(p.normal, ray.direction) * (stays ? 1.0 : -1.0);
        if (nl <= 0.0 || glm::dot(p.face, ray.direction) * (stays ? 1.0 : -1.0) <= 0.0) {
            ray.share = glm::dvec3(0.0);
            return ray;
        }
        ray.share *= shadowing(alpha, nl, nv) *
                     (stays ? mirrored / chance
                            : (glm::dvec3(1.0) - mirrored) * coats.through / (1.0 - chance));
        ray.origin = p.position + p.face * (stays ? off : -off);
        if (!stays)
            return ray;
        if (bounce >= sure_inner_bounces) {
            const double goes_on = std::min(0.95, largest_share(ray.share));
            if (random.next() >= goes_on)
                break;
            ray.share /= goes_on;
        }
    }
    ray.share = glm::dvec3(0.0);
    return ray;
}

glm::dvec3 Tracer::transmitted(const LitPoint& point, const glm::dvec3& view,
                               PathRandom& random) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    glm::dvec3 sum(0.0);
    if (point.opacity < 1.0) {
        const glm::dvec3 start = point.position - view * off;
        sum += (1.0 - point.opacity) * arriving(start, -view, next_hit(start, -view, random),
                                                infinite, 0.0, random, light_.backdrop);
    }
    if (!passes_light(point))
        return sum;
    sum += point.opacity * direct_from_behind(point, view, random);
    const PassedRay ray = pass(point, view, random);
    if (!(largest_share(ray.share) > 0.0))
        return sum;
    return sum + point.opacity * ray.share *
                     arriving(ray.origin, ray.direction,
                              next_hit(ray.origin, ray.direction, random), ray.density,
                              ray.is_straight ? 0.0 : point.lobes.coats.through_alpha, random,
                              ray.is_straight ? light_.backdrop : std::nullopt);
}

} // namespace tessera::corpus
