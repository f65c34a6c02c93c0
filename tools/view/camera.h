// A pinhole camera and where it stands. The world is right-handed: seen from +z, x grows to the
// right and y upwards.
#pragma once

#include "format/status.h"

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace tessera {

struct CameraPose {
    glm::dvec3 eye{10.0, 0.0, 0.0};
    glm::dvec3 look{0.0}; // a point on the axis of view
};

constexpr std::uint32_t max_picture_side = 16384;

struct Lens {
    double fov = 45; // vertical, degrees
    std::uint32_t width = 640, height = 480;
};

// The ray through a point of the picture, x and y from -1 (left, bottom) to 1 (right, top), runs
// along forward + x * right + y * up.
//
// The picture's up is +y. Looking along -y it is -z, and looking along +y it is +z, as for a camera
// that climbs over the scene or dives under it from its place at +z; right is +x there.
struct Camera {
    glm::dvec3 eye, forward, right, up;
    std::uint32_t width = 0, height = 0;

    // Unit direction through a place of the picture in pixels, (0, 0) its top left corner; the
    // centre of pixel (i, j) is (i + 0.5, j + 0.5).
    glm::dvec3 direction(double x, double y) const;
    // How the place changes where the ray along `direction` meets the plane through it with that normal,
    // a pixel to the right and a pixel down. Large, but finite, along the plane.
    std::array<glm::dvec3, 2> steps(const glm::dvec3& direction, const glm::dvec3& place,
                                    const glm::dvec3& normal) const;
};

// Errors: bad_argument, for a point at the eye, numbers beyond 10^6 and a fov outside (0, 180) or a
// side outside 1..max_picture_side.
Result<Camera> make_camera(const CameraPose& pose, const Lens& lens);

// The paper's views of its composed scene, in its order.
struct NamedPose {
    std::string name;
    CameraPose pose;
};
std::vector<NamedPose> paper_views();

// `count` poses evenly around the vertical line through `start.look`, counter-clockwise seen from
// above, the first being `start`. Errors: bad_argument, where the eye is on that line.
Result<std::vector<CameraPose>> orbit(const CameraPose& start, unsigned count);

} // namespace tessera
