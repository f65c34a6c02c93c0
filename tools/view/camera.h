// A camera and its pose. The world is right-handed: seen from +z, x points right and y up.
// All functions are thread-safe.
#pragma once

#include "corpus/photographs/photo_camera.h"
#include "format/status.h"

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct CameraPose {
    glm::dvec3 eye{10.0, 0.0, 0.0};
    glm::dvec3 look{0.0}; // the point that the camera looks at
    glm::dvec3 up{0.0};   // 0: as below
};

// Turns poses for the paper's scene, in its sphere of radius 3.5 around the origin, into those that
// show another surface in the same way.
struct ViewFrame {
    glm::dvec3 centre{0.0}; // of the surface
    double scale = 1.0;     // of the surface, relative to the paper's scene
    CameraPose operator()(const CameraPose& pose) const {
        return {centre + scale * pose.eye, centre + scale * pose.look, pose.up};
    }
};

constexpr std::uint32_t max_picture_side = 16384; // pixels

struct Lens {
    double fov = 45;                         // vertical, degrees
    std::uint32_t width = 640, height = 480; // pixels
};

// A ray through the point (x, y) of the picture, which ranges from (-1, -1) at the bottom left to
// (1, 1) at the top right, has the direction forward + x * right + y * up.
//
// The picture's up is +y unless the pose has its own. A camera that looks straight down (-y) has -z as its up, and one that
// looks straight up (+y) has +z. In both cases right is +x.
struct Camera {
    glm::dvec3 eye, forward, right, up;
    std::uint32_t width = 0, height = 0;
    // A lens that distorts, or whose principal point is not the picture's centre. Rays follow it;
    // forward, right and up then describe the same camera without distortion and centred.
    std::optional<corpus::PhotoCamera> lens{};

    // The unit direction of the ray through a point of the picture. The point is given in pixels
    // from the top left corner; the centre of pixel (i, j) is (i + 0.5, j + 0.5).
    glm::dvec3 direction(double x, double y) const;
    // The ray along `direction` meets a plane at `place`; `normal` is the plane's unit normal.
    // Returns how that intersection moves, in world units, for a step of one pixel to the right and
    // one pixel down. The steps are large but finite where the ray is parallel to the plane.
    std::array<glm::dvec3, 2> steps(const glm::dvec3& direction, const glm::dvec3& place,
                                    const glm::dvec3& normal) const;
};

// Errors: bad_argument if eye and look are the same point, a coordinate exceeds 10^6, the field of
// view is outside (0, 180) degrees, or a side of the picture is outside 1..max_picture_side.
Result<Camera> make_camera(const CameraPose& pose, const Lens& lens);

// The camera of a photograph that read_photographs() accepted.
Camera make_camera(const corpus::PhotoCamera& photograph);

// The paper's five views of its composed scene, in the paper's order.
struct NamedPose {
    std::string name;
    CameraPose pose;
};
// The poses are those in `frame`, whose surface need not be the paper's.
std::vector<NamedPose> paper_views(const ViewFrame& frame = {});

// Returns `count` poses, evenly spaced around the vertical line through `start.look`. They start at
// `start` and run counter-clockwise as seen from above. Errors: bad_argument if the eye is on that
// line.
Result<std::vector<CameraPose>> orbit(const CameraPose& start, unsigned count);

} // namespace tessera
