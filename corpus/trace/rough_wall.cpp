#include "corpus/trace/rough_wall.h"

namespace tessera::corpus {
namespace {

constexpr double clear_wall_alpha = 0.0025; // a roughness of 0.05: smoother walls are clear

glm::dvec3 through_plane(const glm::dvec3& direction, const glm::dvec3& normal) {
    return direction - 2.0 * glm::dot(direction, normal) * normal;
}

} // namespace

bool passes_light(const LitPoint& p) {
    return p.lobes.has_coats && p.lobes.coats.through != glm::dvec3(0.0);
}

bool is_clear_wall(const LitPoint& p) {
    const Coats& coats = p.lobes.coats;
    return passes_light(p) && !coats.is_volume && coats.through_alpha <= clear_wall_alpha;
}

bool is_rough_wall(const LitPoint& p) {
    return passes_light(p) && !p.lobes.coats.is_volume && !is_clear_wall(p);
}

LitPoint other_side(LitPoint p) {
    p.normal = -p.normal;
    p.face = -p.face;
    return p;
}

Thrown RoughWallLobe::operator()(const glm::dvec3& l) const {
    const glm::dvec3 mirrored = through_plane(l, p.normal);
    const double nl = glm::dot(p.normal, mirrored), nv = glm::dot(p.normal, view);
    if (nl <= 0.0 || nv <= 0.0 || glm::dot(p.face, l) >= 0.0)
        return {};
    const Coats& coats = p.lobes.coats;
    const double alpha = coats.through_alpha;
    const glm::dvec3 h = glm::normalize(mirrored + view);
    const double nh = std::min(glm::dot(p.normal, h), 1.0);
    return {(glm::dvec3(1.0) - fresnel(p.lobes, glm::dot(view, h))) * coats.through *
                (below_coats(p, view) * ggx(alpha, nh) * smith_visibility(alpha, nl, nv) * nl),
            ggx_density(alpha, nh, nv)};
}

glm::dvec3 RoughWallLobe::sample(PathRandom& random) const {
    return through_plane(sample_ggx(p.lobes.coats.through_alpha, p.normal, view, random.next2()),
                         p.normal);
}

} // namespace tessera::corpus
