#include "corpus/trace/tracer.h"
#include "corpus/trace/rough_wall.h"

#include <cmath>
#include <limits>

namespace tessera::corpus {
namespace {

constexpr int most_bounces = 8;       // after the first
constexpr int sure_bounces = 2;       // later ones are subject to Russian roulette
constexpr double wide_alpha = 0.09;   // behind wider lobes, mirrors need not be sharper
constexpr std::size_t most_lamps = 8; // of which each path asks for the light
constexpr int most_panes = 64;        // that a ray passes
constexpr glm::dvec3 no_light(0.0);
constexpr double infinite = std::numeric_limits<double>::infinity();

double largest_channel(const glm::dvec3& x) {
    return std::max({x.x, x.y, x.z});
}

glm::dvec3 start_of(const LitPoint& p) {
    return p.position + Tracer::off * p.face;
}

bool is_above(const LitPoint& p, const glm::dvec3& direction) {
    return glm::dot(direction, p.normal) > 0.0 && glm::dot(direction, p.face) > 0.0;
}

// Makes the mirrors of a place rougher that a path meets after lobes whose widest GGX has this
// alpha (Jendersie and Grosch, "Microfacet model regularization for robust light transport", 2019).
void blur(Lobes& lobes, double widest) {
    const double least_alpha = std::min(widest, wide_alpha);
    lobes.alpha = std::max(lobes.alpha, least_alpha);
    if (!lobes.has_coats)
        return;
    Coats& coats = lobes.coats;
    coats.clear_alpha = std::max(coats.clear_alpha, least_alpha);
    if (coats.along_alpha > 0.0)
        coats.along_alpha = std::max(coats.along_alpha, least_alpha);
}

} // namespace

Tracer::Tracer(std::shared_ptr<const RayModel> model, ModelLight light)
    : model_(std::move(model)), light_(std::move(light)), emitters_(model_) {
    if (!emitters_.empty())
        shared_ = {1.0 / 3.0, 1.0 / 3.0};
}

// As the extension KHR_lights_punctual defines it.
LampLight lamp_light(const ModelLamp& lamp, const glm::dvec3& place) {
    if (lamp.kind == ModelLamp::Kind::directional)
        return {-lamp.direction, infinite, lamp.strength};
    const glm::dvec3 way = lamp.position - place;
    const double distance = glm::length(way);
    if (!(distance > Tracer::off))
        return {};
    LampLight light{way / distance, distance, lamp.strength / (distance * distance)};
    if (lamp.range > 0.0)
        light.irradiance *= std::clamp(1.0 - std::pow(distance / lamp.range, 4.0), 0.0, 1.0);
    if (lamp.kind == ModelLamp::Kind::spot) {
        const double cosine = -glm::dot(light.direction, lamp.direction);
        const double share = std::clamp((cosine - lamp.outer_cosine) /
                                            std::max(1e-3, lamp.inner_cosine - lamp.outer_cosine),
                                        0.0, 1.0);
        light.irradiance *= share * share;
    }
    return light;
}

template <class Lobe>
glm::dvec3 Tracer::lamps(const glm::dvec3& start, const Lobe& lobe, PathRandom& random) const {
    const std::size_t count = light_.lamps.size();
    glm::dvec3 sum(0.0);
    const auto add = [&](const ModelLamp& lamp, double weight) {
        const LampLight light = lamp_light(lamp, start);
        const glm::dvec3 share = lobe(light.direction).share * light.irradiance * weight;
        if (largest_channel(share) > 0.0)
            sum +=
                share * passing_share(start, light.direction, std::max(light.distance - off, 0.0));
    };
    if (count <= most_lamps) {
        for (const ModelLamp& lamp : light_.lamps)
            add(lamp, 1.0);
        return sum;
    }
    for (std::size_t i = 0; i < most_lamps; ++i) {
        const auto chosen = static_cast<std::size_t>(random.next() * static_cast<double>(count));
        add(light_.lamps[std::min(chosen, count - 1)],
            static_cast<double>(count) / static_cast<double>(most_lamps));
    }
    return sum;
}

LitPoint Tracer::facing(LitPoint point, const glm::dvec3& view) {
    constexpr double least = 0.02;
    const auto turn = [&](glm::dvec3& normal) {
        if (const double cosine = glm::dot(normal, view); cosine < least)
            normal = glm::normalize(normal + (least - cosine) * view);
    };
    turn(point.normal);
    if (point.lobes.has_coats)
        turn(point.lobes.coats.clear_normal);
    return point;
}

template <class Lobe>
glm::dvec3 Tracer::from_emitters(const LitPoint& point, const Lobe& lobe,
                                 PathRandom& random) const {
    if (emitters_.empty())
        return glm::dvec3(0.0);
    const glm::dvec3 start = start_of(point);
    const EmitterSample near = emitters_.sample(start, random.next2());
    const Thrown thrown = lobe(near.direction);
    const glm::dvec3 light = thrown.share * near.light;
    if (largest_channel(light) <= 0.0)
        return glm::dvec3(0.0);
    return light / (near.density + thrown.density) *
           passing_share(start, near.direction, std::max(near.distance - off, 0.0));
}

// Light from the sun and lamps, from a sampled direction of the environment and from a sampled
// place of an emitting triangle. The directions of the lobe meet the latter two, too, in
// arriving(); the balance heuristic weights both.
template <class Lobe>
glm::dvec3 Tracer::direct(const LitPoint& point, const Lobe& lobe, PathRandom& random) const {
    const glm::dvec3 start = start_of(point);
    glm::dvec3 sum(0.0);
    const auto add = [&](const glm::dvec3& light, const glm::dvec3& direction,
                         const glm::dvec3& share) {
        if (largest_channel(share * light) > 0.0)
            sum += share * light * passing_share(start, direction, infinite);
    };
    const LightSample far = light_.environment->sample(random.next2());
    const Thrown thrown = lobe(far.direction);
    add(far.light, far.direction, thrown.share / (far.density + thrown.density));
    sum += from_emitters(point, lobe, random);
    if (light_.sun)
        add(light_.sun->irradiance, light_.sun->direction, lobe(light_.sun->direction).share);
    return sum + lamps(start, lobe, random);
}

glm::dvec3 Tracer::direct_from_behind(const LitPoint& point, const glm::dvec3& view,
                                      PathRandom& random) const {
    if (!is_rough_wall(point))
        return glm::dvec3(0.0);
    return direct(other_side(point), RoughWallLobe{point, view}, random);
}

template <class Lobe>
glm::dvec3 Tracer::reflected(const LitPoint& point, const Lobe& lobe, const glm::dvec3& sampled,
                             PathRandom& random) const {
    const Thrown thrown = lobe(sampled);
    if (!(thrown.density > 0.0))
        return glm::dvec3(0.0);
    const glm::dvec3 start = start_of(point);
    return thrown.share / thrown.density *
           arriving(start, sampled, next_hit(start, sampled, random), thrown.density, lobe.width(),
                    random);
}

glm::dvec3 Tracer::diffuse(const LitPoint& point, PathRandom& random) const {
    if (largest_channel(point.lobes.diffuse) <= 0.0)
        return glm::dvec3(0.0);
    const DiffuseLobe lobe{point};
    const glm::dvec3 lit = direct(point, lobe, random);
    return lit + reflected(point, lobe, sample_cosine(point.normal, random.next2()), random);
}

glm::dvec3 Tracer::specular(const LitPoint& point, const glm::dvec3& view,
                            PathRandom& random) const {
    const SpecularLobe lobe{point, view};
    const glm::dvec3 lit = direct(point, lobe, random);
    const glm::dvec3 l = lobe.sample(random);
    return lit + reflected(point, lobe, l, random) + transmitted(point, view, random);
}

glm::dvec3 Tracer::specular_of_model(const LitPoint& point, const glm::dvec3& view,
                                     PathRandom& random) const {
    const SpecularLobe lobe{point, view};
    const glm::dvec3 lit = from_emitters(point, lobe, random);
    const glm::dvec3 start = start_of(point), l = lobe.sample(random);
    const Thrown thrown = lobe(l);
    if (!(thrown.density > 0.0))
        return lit;
    const Hit hit = next_hit(start, l, random);
    if (!hit)
        return lit;
    return lit + thrown.share / thrown.density *
                     arriving(start, l, hit, thrown.density, lobe.width(), random, no_light);
}

double Tracer::emitter_density(const glm::dvec3& origin, const glm::dvec3& direction,
                               const Hit& hit) const {
    return hit ? emitters_.density(hit->triangle, origin, direction) : 0.0;
}

// Directions towards emitters count only if their ray meets the sampled triangle first.
double Tracer::shared_density(const LitPoint& point, const glm::dvec3& direction,
                              const Hit& hit) const {
    return shared_.environment * light_.environment->density(direction) +
           shared_.emitters * emitter_density(start_of(point), direction, hit) +
           (1.0 - shared_.environment - shared_.emitters) *
               cosine_density(glm::dot(point.normal, direction));
}

Tracer::Incoming Tracer::incoming(const LitPoint& point, PathRandom& random) const {
    const double choice = random.next();
    const glm::dvec2 x = random.next2();
    const glm::dvec3 start = start_of(point);
    Incoming found{sample_cosine(point.normal, x), glm::dvec3(0.0), 1.0};
    std::optional<std::uint32_t> emitter;
    if (choice < shared_.environment) {
        found.direction = light_.environment->sample(x).direction;
    } else if (choice < shared_.environment + shared_.emitters) {
        const EmitterSample near = emitters_.sample(start, x);
        if (largest_channel(near.light) <= 0.0)
            return found;
        found.direction = near.direction;
        emitter = near.triangle;
    }
    if (!is_above(point, found.direction))
        return found;
    const Hit hit = next_hit(start, found.direction, random);
    if (emitter && !(hit && hit->triangle == *emitter))
        return found;
    found.light = arriving(start, found.direction, hit, infinite, 1.0, random);
    found.density = shared_density(point, found.direction, hit);
    return found;
}

Tracer::Incoming Tracer::incoming_of_model(const LitPoint& point, double toward_emitters,
                                           PathRandom& random) const {
    const glm::dvec3 start = start_of(point);
    Incoming found{sample_cosine(point.normal, random.next2()), glm::dvec3(0.0), 1.0};
    if (!is_above(point, found.direction))
        return found;
    const Hit hit = next_hit(start, found.direction, random);
    if (!hit) {
        found.leaves_model = true;
        return found;
    }
    found.density = cosine_density(glm::dot(point.normal, found.direction));
    found.light = arriving(start, found.direction, hit,
                           emitters_.empty() ? infinite : found.density / toward_emitters, 1.0,
                           random, no_light);
    return found;
}

Tracer::Incoming Tracer::incoming_of_emitters(const LitPoint& point, double toward_emitters,
                                              PathRandom& random) const {
    const glm::dvec3 start = start_of(point);
    const EmitterSample near = emitters_.sample(start, random.next2());
    Incoming found{near.direction, glm::dvec3(0.0), 1.0};
    if (largest_channel(near.light) <= 0.0 || !is_above(point, near.direction))
        return found;
    found.light =
        near.light * passing_share(start, near.direction, std::max(near.distance - off, 0.0));
    found.density =
        near.density + cosine_density(glm::dot(point.normal, near.direction)) / toward_emitters;
    return found;
}

// Veach's balance heuristic weights shared and own paths.
glm::dvec3 Tracer::specular_of(const Incoming& incoming, const LitPoint& point,
                               const glm::dvec3& view, double shared, double own) const {
    const LitPoint faced = facing(point, view);
    const Thrown thrown = SpecularLobe{faced, view}(incoming.direction);
    return thrown.share * incoming.light / (shared * incoming.density + own * thrown.density);
}

glm::dvec3 Tracer::specular_own(const LitPoint& point, const glm::dvec3& view, double shared,
                                double own, PathRandom& random) const {
    // shared_density() needs `point` itself, which is the same for all views.
    const LitPoint faced = facing(point, view);
    const SpecularLobe lobe{faced, view};
    const glm::dvec3 start = start_of(point);
    glm::dvec3 sum(0.0);
    if (light_.sun) {
        const glm::dvec3 share = lobe(light_.sun->direction).share;
        if (largest_channel(share) > 0.0)
            sum += share * light_.sun->irradiance *
                   passing_share(start, light_.sun->direction, infinite) / own;
    }
    sum += lamps(start, lobe, random) / own;
    sum += transmitted(faced, view, random) / own;
    const glm::dvec3 l = lobe.sample(random);
    if (const Thrown thrown = lobe(l); thrown.density > 0.0) {
        const Hit hit = next_hit(start, l, random);
        sum += thrown.share * arriving(start, l, hit, infinite, lobe.width(), random) /
               (shared * shared_density(point, l, hit) + own * thrown.density);
    }
    return sum;
}

Tracer::Hit Tracer::next_hit(const glm::dvec3& origin, const glm::dvec3& direction,
                             PathRandom& random) const {
    Hit hit = model_->first_hit(origin, direction);
    if (!model_->has_blending())
        return hit;
    for (int i = 0; hit && i < most_panes; ++i) {
        const double opacity = model_->opacity(*hit);
        if (opacity >= 1.0 || random.next() < opacity)
            break;
        hit = model_->first_hit(model_->point(*hit).position + direction * off, direction);
    }
    return hit;
}

glm::dvec3 Tracer::unblocked(const LitPoint& point, const glm::dvec3& direction,
                             double reach) const {
    if (glm::dot(point.face, direction) <= 0.0)
        return glm::dvec3(0.0);
    return passing_share(start_of(point), direction, std::max(reach - off, 0.0));
}

bool Tracer::is_shadowed(const LitPoint& point, const glm::dvec3& direction, double reach) const {
    constexpr double half = 0.5; // of the light; less is a shadow
    return largest_channel(unblocked(point, direction, reach)) < half;
}

glm::dvec3 Tracer::from_model(const LitPoint& point, const glm::dvec3& direction,
                              PathRandom& random) const {
    const glm::dvec3 start = start_of(point);
    const Hit hit = next_hit(start, direction, random);
    if (!hit)
        return glm::dvec3(0.0);
    return arriving(start, direction, hit, infinite, 1.0, random, no_light);
}

glm::dvec3 Tracer::leaving(const LitPoint& point, const glm::dvec3& view,
                           PathRandom& random) const {
    return point.opacity * point.emission + diffuse(point, random) * below_coats(point, view) +
           specular(point, view, random);
}

glm::dvec3 Tracer::arriving(glm::dvec3 origin, glm::dvec3 direction, Hit hit, double density,
                            double widest, PathRandom& random,
                            std::optional<glm::dvec3> beyond) const {
    glm::dvec3 sum(0.0), share(1.0);
    bool is_straight = true; // so far
    // Divides light by it: the weight of the balance heuristic. direct() adds the rest.
    const auto divisor = [&](double light_density) {
        return std::isinf(density) ? 1.0 : 1.0 + light_density / density;
    };
    for (int bounce = 0;;) {
        if (!hit) {
            if (beyond && is_straight)
                return sum + share * *beyond;
            return sum + share * light_.environment->light(direction) /
                             divisor(light_.environment->density(direction));
        }
        const glm::dvec3 view = -direction;
        LitPoint p = facing(model_->point(*hit), view);
        p.opacity = 1.0; // as next_hit() has chosen
        blur(p.lobes, widest);
        if (largest_channel(p.emission) > 0.0)
            sum += share * p.emission / divisor(emitter_density(origin, direction, hit));
        const BothLobes lobes(p, view);
        sum += share * (direct(p, lobes, random) + direct_from_behind(p, view, random));
        const double passes = passing_chance(p, view);
        glm::dvec3 start = start_of(p);
        if (passes > 0.0 && random.next() < passes) {
            const PassedRay passed = pass(p, view, random);
            if (!(largest_channel(passed.share) > 0.0))
                return sum;
            share *= passed.share / passes;
            start = passed.origin;
            if (!passed.is_straight) {
                is_straight = false;
                widest = std::max(
                    widest,
                    p.lobes.coats
                        .through_alpha); // otherwise direct() saw the same light through the wall
                origin = start;
                density = passed.density;
            }
            direction = passed.direction;
        } else {
            const glm::dvec3 l = lobes.sample(random);
            const Thrown thrown = lobes(l);
            if (!(thrown.density > 0.0))
                return sum;
            share *= thrown.share / (thrown.density * (1.0 - passes));
            is_straight = false;
            origin = start;
            direction = l;
            density = thrown.density;
            widest = std::max(widest, lobes.width());
        }
        if (bounce >= sure_bounces) {
            const double chance = std::min(0.95, largest_channel(share));
            if (random.next() >= chance)
                return sum;
            share /= chance;
        }
        if (++bounce == most_bounces)
            return sum;
        hit = next_hit(start, direction, random);
    }
}

} // namespace tessera::corpus
