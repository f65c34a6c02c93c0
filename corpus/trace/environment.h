// Distant light from all directions: a picture of longitude and latitude.
#pragma once

#include "corpus/picture_file.h"

#include <glm/vec2.hpp>

namespace tessera::corpus {

struct LightSample {
    glm::dvec3 direction{0.0}; // towards the light
    glm::dvec3 light{0.0};
    double density = 0; // per steradian
};

// y is up. The middle of the picture lies along +x, and the middle of its right half along +z.
// Immutable and thread-safe.
class Environment {
public:
    // Precondition: the picture has texels, all of them finite and at least 0.
    explicit Environment(LightImage image);
    // .exr, .hdr or .pfm; `layer` of an EXR as in PictureOptions. Errors: io, invalid_file (naming
    // the file and the texel), unsupported, bad_argument (the layer).
    static Result<Environment> load(const std::string& path, const std::string& layer = "");
    // The default light: a bright sky, a softbox and a grey ground.
    static Environment studio();

    glm::dvec3 light(const glm::dvec3& direction) const;
    // A direction whose density grows with its light. `random` is in 0..1.
    LightSample sample(const glm::dvec2& random) const;
    double density(const glm::dvec3& direction) const;

private:
    double cell_density(std::size_t x, std::size_t y) const;

    LightImage image_;
    std::vector<double> cosines_; // of its rows
    std::vector<double> rows_;    // for each row the sum of the weights of all rows up to it
    std::vector<double> cells_;   // the same along each row
};

} // namespace tessera::corpus
