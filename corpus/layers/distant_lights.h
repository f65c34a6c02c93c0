// The environment as a few distant lights.
#pragma once

#include "corpus/trace/tracer.h"
#include "format/layers.h"

#include <optional>

namespace tessera::corpus {

// The environment, split into parts. Its picture is split at the place that reduces the spread of
// the parts most, weighted by brightness, until there are enough. Neighbouring parts in the list are
// close to each other. The sun, if there is one, and each directional lamp are parts without spread.
// Immutable and thread-safe.
class DistantLights {
public:
    static constexpr unsigned least = 16, most = 32;

    // At most `count` parts of the environment's picture. By default `least`, or `most` if that few
    // would each stand for light from too many directions, as those of a broad sky do.
    explicit DistantLights(const ModelLight& light, std::optional<unsigned> count = {});

    std::size_t count() const { return parts_.size(); }
    // One for each part, with all of its light. `exposure` multiplies it.
    std::vector<DistantLight> lights(double exposure) const;

    struct Sample {
        glm::dvec3 direction{0.0};  // unit
        glm::dvec3 irradiance{0.0}; // the mean over many samples is that of the part
    };
    // Brighter places of the part are sampled more often.
    Sample sample(std::size_t part, const glm::dvec2& random) const;

private:
    // Cells of the picture beside each other.
    struct Row {
        std::uint32_t y = 0, x0 = 0;
        std::vector<double> brightness; // sums up to and including each cell
        std::vector<glm::dvec3> light;  // of each cell, divided by the probability of the cell
    };
    struct Part {
        DistantLight light;
        std::vector<double> brightness; // sums up to and including each row
        std::vector<Row> rows;          // none without spread
    };

    std::vector<double> cosines_; // of the rows of the picture
    std::vector<Part> parts_;
};

} // namespace tessera::corpus
