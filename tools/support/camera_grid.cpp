#include "tools/support/camera_grid.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>
#include <string_view>

namespace tessera {
namespace {

constexpr double usual_fov = 40;
constexpr double usual_width = 2;
constexpr double usual_span = 0.25; // longer side of the grid, as a share of the distance
// World units: large enough to divide by, and the limit for the position of an eye.
constexpr double smallest_length = 1e-12, largest_length = 1e6;

bool is_length(double x) {
    return x >= smallest_length && x <= largest_length;
}

bool parse_lengths(std::string_view text, std::span<double> out) {
    return parse_numbers(text, out) && std::ranges::all_of(out, is_length);
}

} // namespace

Result<CameraGrid> camera_grid(const CameraFacts& facts, const Extent4& size) {
    const double steps = std::max({size[axis_s] - 1.0, size[axis_t] - 1.0, 1.0});
    const double half_fov = facts.fov.value_or(usual_fov) * std::numbers::pi / 360;
    if (!(half_fov > 0) || half_fov >= std::numbers::pi / 2)
        return Status(ErrorCode::bad_argument, "--camera-fov: must be between 0 and 180 degrees");
    if (facts.focus && !is_length(*facts.focus))
        return Status(ErrorCode::bad_argument, "--camera-focus: must be above 0 and at most 1e6");
    CameraGrid cameras;
    double spacing[2] = {0, 0};
    if (!facts.spacing.empty()) {
        if (!parse_lengths(facts.spacing, spacing)) {
            if (!parse_lengths(facts.spacing, std::span(spacing, 1)))
                return Status(ErrorCode::bad_argument, "--camera-spacing: '" + facts.spacing +
                                                           "' is not a length, or two as x,y");
            spacing[1] = spacing[0];
        }
        cameras.distance =
            facts.focus.value_or(std::max(spacing[0], spacing[1]) * steps / usual_span);
    } else {
        cameras.distance = facts.focus.value_or(usual_width / 2 / std::tan(half_fov));
        spacing[0] = spacing[1] = cameras.distance * usual_span / steps;
    }
    cameras.spacing_x = spacing[0];
    cameras.spacing_y = spacing[1];
    cameras.width = 2 * cameras.distance * std::tan(half_fov);
    for (const double length :
         {cameras.spacing_x, cameras.spacing_y, cameras.distance, cameras.width})
        if (!is_length(length)) // cameras_in() would refuse it
            return Status(ErrorCode::bad_argument,
                          "--camera-spacing, --camera-fov and --camera-focus give " +
                              to_string(cameras) + ", which must be above 0 and at most 1e6");
    return cameras;
}

std::string to_string(const CameraGrid& cameras) {
    char text[120];
    std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g,%.9g", cameras.spacing_x, cameras.spacing_y,
                  cameras.distance, cameras.width);
    return text;
}

Result<CameraGrid> cameras_in(const Metadata& metadata, const Extent4& size) {
    const auto said = metadata.find(cameras_key);
    if (said == metadata.end())
        return camera_grid({}, size);
    double numbers[4];
    if (!parse_lengths(said->second, numbers))
        return Status(ErrorCode::invalid_file,
                      "its key Cameras is not four lengths above 0: spacing x, y, distance, width");
    return CameraGrid{numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::string to_string(const WindowPlace& place) {
    std::string text;
    for (const glm::dvec3& v : {place.centre, place.axes[0], place.axes[1]})
        for (glm::length_t i = 0; i < 3; ++i) {
            char number[40];
            std::snprintf(number, sizeof number, "%s%.12g", text.empty() ? "" : ",", v[i]);
            text += number;
        }
    return text;
}

Result<std::optional<WindowPlace>> window_in(const Metadata& metadata) {
    constexpr double tolerance = 1e-6;
    const auto said = metadata.find(window_key);
    if (said == metadata.end())
        return std::optional<WindowPlace>();
    double n[9];
    WindowPlace place;
    bool is_valid = parse_numbers(said->second, n);
    if (is_valid) {
        place.centre = {n[0], n[1], n[2]};
        const glm::dvec3 right(n[3], n[4], n[5]), up(n[6], n[7], n[8]);
        place.axes = glm::dmat3(right, up, glm::cross(right, up));
        is_valid = glm::length(place.centre) <= largest_length &&
                   std::abs(glm::length(right) - 1.0) <= tolerance &&
                   std::abs(glm::length(up) - 1.0) <= tolerance &&
                   std::abs(glm::dot(right, up)) <= tolerance;
    }
    if (!is_valid)
        return Status(ErrorCode::invalid_file,
                      "its key Window is not nine numbers: the centre of the window, and two unit "
                      "vectors to the right and up");
    return std::optional(place);
}

} // namespace tessera
