#include "corpus/surface/angular_choice.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr unsigned trials = 4096;

// Numbers 0..1, the same everywhere.
class Dice {
public:
    double next() { return static_cast<double>(mix_bits(++count_) >> 11) * 0x1p-53; }

private:
    std::uint64_t count_ = 0;
};

// Lambert's cosine: as often as a far observer who may be anywhere has the direction in a picture.
glm::dvec3 random_direction(const SurfaceFrame& frame, Dice& dice) {
    const double radius = std::sqrt(dice.next()), angle = 2.0 * std::numbers::pi * dice.next();
    return frame.ex * (radius * std::cos(angle)) + frame.ey * (radius * std::sin(angle)) +
           frame.ez * std::sqrt(std::max(0.0, 1.0 - radius * radius));
}

glm::dvec3 interpolated(const LitSurface::Place& place, AngularMap map, const Texels2& directions,
                        const glm::dvec3& d) {
    glm::dvec3 sum{0.0};
    const Extent4 size{1, 1, directions[0], directions[1]};
    const glm::dvec2 st = octahedral_place(map, place.frame, d);
    for (const WeightedTexel& texel : mesh_footprint(size, map, {0.5, 0.5}, st))
        if (texel.weight > 0.0)
            sum += texel.weight * place.light.leaving(octahedral_direction(
                                      map, place.frame, (texel.s + 0.5) / directions[0],
                                      (texel.t + 0.5) / directions[1]));
    return sum;
}

} // namespace

double angular_error(const LitSurface& surface, AngularMap map, const Texels2& directions) {
    const TexelPlaces& places = surface.places();
    Dice dice;
    double sum = 0;
    for (unsigned i = 0; i < trials; ++i) {
        const auto u = static_cast<std::uint32_t>(dice.next() * places.size()[0]);
        const auto v = static_cast<std::uint32_t>(dice.next() * places.size()[1]);
        if (!places.matters(u, v) || !shines(surface.object_of(surface.chart_at(u, v)).material))
            continue;
        const LitSurface::Place place = surface.at(u, v, {0.0, 0.0});
        const glm::dvec3 d = random_direction(place.frame, dice);
        const glm::dvec3 error = interpolated(place, map, directions, d) - place.light.leaving(d);
        sum += glm::dot(error, error);
    }
    return sum / trials;
}

AngularMap choose_angular_map(const LitSurface& surface, const Texels2& directions) {
    const double hemisphere = angular_error(surface, AngularMap::octahedral_hemisphere, directions);
    const double mirrored = angular_error(surface, AngularMap::octahedral_mirrored, directions);
    return mirrored < hemisphere ? AngularMap::octahedral_mirrored
                                 : AngularMap::octahedral_hemisphere;
}

} // namespace tessera::corpus
