#include "tools/view/camera.h"

#include "tools/support/parse.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera {
namespace {

constexpr double max_coordinate = 1e6;
constexpr double radians = std::numbers::pi / 180;

bool is_within(const glm::dvec3& p) {
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(p[i]) <= max_coordinate)) // written so that NaN fails, too
            return false;
    return true;
}

} // namespace

glm::dvec3 Camera::direction(double x, double y) const {
    if (lens)
        return lens->direction(x, y);
    return glm::normalize(forward + (2 * x / width - 1) * right + (1 - 2 * y / height) * up);
}

std::array<glm::dvec3, 2> Camera::steps(const glm::dvec3& d, const glm::dvec3& place,
                                        const glm::dvec3& normal) const {
    const glm::dvec3 axis = lens ? lens->axes[2] : forward;
    const double distance = glm::dot(place - eye, axis) / glm::dot(axis, axis);
    const double slope = glm::dot(d, normal);
    const double away = std::copysign(std::max(std::abs(slope), 1e-6), slope);
    const auto step = [&](const glm::dvec3& turn) {
        return distance * (turn - d * (glm::dot(turn, normal) / away));
    };
    if (!lens)
        return {step(right * (2.0 / width)), step(up * (-2.0 / height))};
    const auto turns = lens->turns(d);
    return {step(turns[0]), step(turns[1])};
}

Result<Camera> make_camera(const CameraPose& pose, const Lens& lens) {
    if (!is_within(pose.eye) || !is_within(pose.look))
        return Status(ErrorCode::bad_argument,
                      "the coordinates of eye and look must lie between -1000000 and 1000000");
    if (!(lens.fov > 0 && lens.fov < 180))
        return Status(ErrorCode::bad_argument, "a field of view of " + format_number(lens.fov, 3) +
                                                   " degrees is not between 0 and 180");
    if (lens.width < 1 || lens.height < 1 || lens.width > max_picture_side ||
        lens.height > max_picture_side)
        return Status(ErrorCode::bad_argument, "the picture has " + std::to_string(lens.width) +
                                                   "x" + std::to_string(lens.height) +
                                                   " pixels; each side must have 1 to " +
                                                   std::to_string(max_picture_side));
    const double distance = glm::length(pose.look - pose.eye);
    if (distance < 1e-9)
        return Status(ErrorCode::bad_argument, "eye and look are the same point");
    Camera camera;
    camera.eye = pose.eye;
    camera.forward = (pose.look - pose.eye) / distance;
    camera.width = lens.width;
    camera.height = lens.height;
    const bool vertical = std::hypot(camera.forward.x, camera.forward.z) < 1e-9;
    const bool has_up = glm::length(glm::cross(camera.forward, pose.up)) > 1e-9;
    const glm::dvec3 upwards = has_up     ? pose.up
                               : vertical ? glm::dvec3{0.0, 0.0, camera.forward.y > 0 ? 1.0 : -1.0}
                                          : glm::dvec3{0.0, 1.0, 0.0};
    const glm::dvec3 right = glm::normalize(glm::cross(camera.forward, upwards));
    const double half_height = std::tan(lens.fov * radians / 2);
    camera.right = right * (half_height * lens.width / lens.height);
    camera.up = glm::cross(right, camera.forward) * half_height;
    return camera;
}

Camera make_camera(const corpus::PhotoCamera& photograph) {
    constexpr double most_off_centre = 1e-6; // pixels
    Camera camera;
    camera.eye = photograph.eye;
    camera.forward = photograph.axes[2];
    camera.right = photograph.axes[0] * (photograph.width / (2 * photograph.fx));
    camera.up = photograph.axes[1] * (photograph.height / (-2 * photograph.fy));
    camera.width = photograph.width;
    camera.height = photograph.height;
    if (!photograph.distortion.is_none() ||
        std::abs(photograph.cx - photograph.width / 2.0) > most_off_centre ||
        std::abs(photograph.cy - photograph.height / 2.0) > most_off_centre)
        camera.lens = photograph;
    return camera;
}

std::vector<NamedPose> paper_views(const ViewFrame& frame) {
    std::vector<NamedPose> views = {{"10,0,0", {{10, 0, 0}, {0, 0, 0}}},
                                    {"10,0,-3", {{10, 0, -3}, {0, 0, -3}}},
                                    {"10,0,3", {{10, 0, 3}, {0, 0, 3}}},
                                    {"0,0,10", {{0, 0, 10}, {0, 0, 0}}},
                                    {"0,10,0", {{0, 10, 0}, {0, 0, 0}}}};
    if (frame.scale == 1.0 && frame.centre == glm::dvec3(0.0))
        return views;
    for (std::size_t i = 0; i < views.size(); ++i)
        views[i] = {"view " + std::to_string(i + 1), frame(views[i].pose)};
    return views;
}

Result<std::vector<CameraPose>> orbit(const CameraPose& start, unsigned count) {
    const glm::dvec3 arm = start.eye - start.look;
    if (!(std::hypot(arm.x, arm.z) > 1e-9))
        return Status(ErrorCode::bad_argument, "an orbit is impossible, because the eye is on the "
                                               "vertical line through the look point");
    std::vector<CameraPose> poses;
    for (unsigned i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        const double c = std::cos(angle), s = std::sin(angle);
        const glm::dvec3 turned{arm.x * c + arm.z * s, arm.y, arm.z * c - arm.x * s};
        poses.push_back({start.look + turned, start.look, start.up});
    }
    return poses;
}

} // namespace tessera
