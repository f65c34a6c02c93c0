// Light from far away, all around: a picture of longitude and latitude.
#pragma once

#include "corpus/model/image_file.h"

#include <glm/vec2.hpp>

namespace tessera::corpus {

struct LightSample {
    glm::dvec3 direction{0.0}; // towards the light
    glm::dvec3 light{0.0};
    double density = 0; // per steradian
};

// y is up; the picture's middle is seen along +x, a quarter to its right along +z. Immutable, hence
// thread-safe.
class Environment {
public:
    // Precondition: the picture has texels, all finite and not below 0.
    explicit Environment(LightImage image);
    // .exr or .hdr. Errors: io, invalid_file (naming the file and the texel), unsupported.
    static Result<Environment> load(const std::string& path);
    // A bright sky with a softbox above and left, and a grey ground: shown where nothing is given.
    static Environment studio();
    static Environment uniform(double light);

    glm::dvec3 light(const glm::dvec3& direction) const;
    // More often where it is brighter; `random` in 0..1.
    LightSample sample(const glm::dvec2& random) const;
    double density(const glm::dvec3& direction) const;

private:
    double cell_density(std::size_t x, std::size_t y) const;

    LightImage image_;
    std::vector<double> rows_;  // sums of weights up to and with each row
    std::vector<double> cells_; // the same along each row
};

} // namespace tessera::corpus
