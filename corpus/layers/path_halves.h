// Sums of random paths in two halves, whose difference says how noisy they are.
#pragma once

#include "corpus/layers/arriving_light.h"
#include "corpus/layers/texel_paths.h"
#include "corpus/trace/tracer.h"

namespace tessera::corpus {

// Adds what `count` paths find, an even number, at a place with this normal. incoming(random) returns
// the light of one path. Returns the diffuse light of each half.
template <class IncomingOf>
std::array<glm::dvec3, 2> add_halves(const TexelPaths& randoms, unsigned count,
                                     const glm::dvec3& normal, const IncomingOf& incoming,
                                     ArrivingLight<glm::dvec3>& sum) {
    std::array<glm::dvec3, 2> halves;
    for (unsigned half = 0; half < 2; ++half) {
        const glm::dvec3 before = sum.diffuse;
        for (unsigned i = 0; i < count / 2; ++i) {
            PathRandom random = randoms[half * (count / 2) + i];
            const Tracer::Incoming found = incoming(random);
            sum.add(found.direction, found.light / found.density, normal);
        }
        halves[half] = sum.diffuse - before;
    }
    return halves;
}

} // namespace tessera::corpus
