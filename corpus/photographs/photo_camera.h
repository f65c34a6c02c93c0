// The camera of a photograph: its lens with distortion, and its pose. All functions are thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat2x2.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace tessera::corpus {

// How a lens moves points of the picture, by OpenCV's model with a radial polynomial of four
// coefficients. Points are tangents: (x, y) for the direction (x, y, 1) right, down and forward.
struct LensDistortion {
    double k1 = 0, k2 = 0, k3 = 0, k4 = 0; // radial: of r^2, r^4, r^6, r^8
    double p1 = 0, p2 = 0;                 // tangential

    bool operator==(const LensDistortion&) const = default;
    bool is_none() const { return *this == LensDistortion{}; }
    glm::dvec2 distort(const glm::dvec2& point) const;
    // The derivatives of distort(): column 0 by x, column 1 by y.
    glm::dmat2 slopes(const glm::dvec2& point) const;
    // The inverse of distort(), by Newton's method. Where there is none, returns a nearby point.
    glm::dvec2 undistort(const glm::dvec2& distorted) const;
    // Whether the radial polynomial still grows at a point before its distortion. Points further out
    // would be drawn a second time inside the picture.
    bool is_inside(const glm::dvec2& point) const;
};

struct PhotoCamera {
    std::uint32_t width = 0, height = 0; // pixels
    // Focal lengths and principal point, in pixels. The centre of the top left pixel is (0.5, 0.5).
    double fx = 0, fy = 0, cx = 0, cy = 0;
    LensDistortion distortion;
    glm::dvec3 eye{0.0};
    glm::dmat3 axes{1.0}; // columns: right, down and forward in the world's frame; a rotation

    // The unit direction, in the world's frame, of the ray through a point of the picture. The point
    // is given in pixels from the top left corner.
    glm::dvec3 direction(double x, double y) const;
    // Where the picture shows a place of the world, in pixels, which may be outside the picture.
    // Nothing for places that are not in front of the camera, or where the distortion folds.
    std::optional<glm::dvec2> project(const glm::dvec3& place) const;
    // How the direction with a forward component of 1 changes from one pixel to the next, to the
    // right and down, at the ray along `direction`, in the world's frame. Precondition: the
    // direction points forward.
    std::array<glm::dvec3, 2> turns(const glm::dvec3& direction) const;
    // The same camera with a picture of another size, in which each pixel covers more or less.
    PhotoCamera resized(std::uint32_t to_width, std::uint32_t to_height) const;
};

} // namespace tessera::corpus
