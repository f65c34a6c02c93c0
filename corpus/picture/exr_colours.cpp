#include "corpus/picture/exr_colours.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace tessera::corpus {
namespace {

bool is_near(const Imath::V2f& a, float x, float y) {
    return std::abs(a.x - x) < 0.002f && std::abs(a.y - y) < 0.002f; // as files round them
}

// XYZ with Y = 1.
glm::dvec3 xyz_of(const Imath::V2f& place) {
    return {place.x / place.y, 1, (1 - place.x - place.y) / double(place.y)};
}

// From linear RGB to XYZ, where (1, 1, 1) has Y = 1.
glm::dmat3 rgb_to_xyz(const Imf::Chromaticities& c) {
    const auto axis = [](const Imath::V2f& p) { return glm::dvec3(p.x, p.y, 1 - p.x - p.y); };
    const glm::dmat3 axes(axis(c.red), axis(c.green), axis(c.blue));
    const glm::dvec3 scale = glm::inverse(axes) * xyz_of(c.white);
    return {axes[0] * scale.x, axes[1] * scale.y, axes[2] * scale.z};
}

// From the look of colours under one white to the same look under another.
glm::dmat3 adaptation(const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dmat3 cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367,
                           1.0296); // Bradford
    const glm::dvec3 ratio = (cones * to) / (cones * from);
    return glm::inverse(cones) * glm::dmat3(ratio.x, 0, 0, 0, ratio.y, 0, 0, 0, ratio.z) * cones;
}

bool is_finite_matrix(const glm::dmat3& m) {
    for (glm::length_t column = 0; column < 3; ++column)
        for (glm::length_t row = 0; row < 3; ++row)
            if (!std::isfinite(m[column][row]) || std::abs(m[column][row]) > 1000)
                return false;
    return true;
}

} // namespace

bool are_xyz(const Imf::Chromaticities& c) {
    return is_near(c.red, 1, 0) && is_near(c.green, 0, 1) && is_near(c.blue, 0, 0);
}

bool are_bt709(const Imf::Chromaticities& c) {
    return is_near(c.red, 0.64f, 0.33f) && is_near(c.green, 0.30f, 0.60f) &&
           is_near(c.blue, 0.15f, 0.06f) && is_near(c.white, 0.3127f, 0.3290f);
}

glm::mat3 to_bt709(const Imf::Chromaticities& colours) {
    const Imf::Chromaticities bt709; // the default
    const glm::dmat3 from_xyz = glm::inverse(rgb_to_xyz(bt709));
    if (are_xyz(colours))
        return glm::mat3(from_xyz);
    const glm::dmat3 all =
        from_xyz * adaptation(xyz_of(colours.white), xyz_of(bt709.white)) * rgb_to_xyz(colours);
    return is_finite_matrix(all) ? glm::mat3(all) : glm::mat3(1);
}

std::string words_for(const Imf::Chromaticities& c) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "red %.4g %.4g, green %.4g %.4g, blue %.4g %.4g, white %.4g %.4g", c.red.x,
                  c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y);
    return text;
}

} // namespace tessera::corpus
