#include "corpus/photographs/stated_frames.h"

#include "corpus/picture/picture_readers.h"

#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr double most_distance = 1e9; // of an eye from the origin, world units
// Pixels. Within these bounds tangents and their powers stay finite.
constexpr double least_focal = 1e-3, most_focal = 1e9;

Status wrong_lens(const std::string& what) {
    return {ErrorCode::invalid_file, what};
}

std::string lens_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

// The focal length in pixels for a field of view across `side` pixels.
Result<double> focal_of(double angle, const char* key, std::uint32_t side) {
    if (!(angle > 0 && angle < std::numbers::pi))
        return wrong_lens(std::string(key) + " is " + lens_number(angle) +
                          ", but must lie between 0 and pi");
    return 0.5 * side / std::tan(angle / 2);
}

Status take_focal_lengths(const StatedLens& lens, PhotoCamera& camera) {
    std::optional<double> fx = lens.fx, fy = lens.fy;
    if (!fx && lens.angle_x) {
        TESSERA_TRY_ASSIGN(fx, focal_of(*lens.angle_x, "camera_angle_x", camera.width));
    }
    if (!fy && lens.angle_y) {
        TESSERA_TRY_ASSIGN(fy, focal_of(*lens.angle_y, "camera_angle_y", camera.height));
    }
    if (!fx && !fy)
        return wrong_lens("has no focal length, neither fl_x nor camera_angle_x");
    camera.fx = fx ? *fx : *fy;
    camera.fy = fy ? *fy : *fx;
    for (const double focal : {camera.fx, camera.fy})
        if (!(focal >= least_focal && focal <= most_focal))
            return wrong_lens("its focal length is " + lens_number(focal) +
                              " pixels, but must lie between 0.001 and 1e9");
    return {};
}

Status check_distortion(const PhotoCamera& camera) {
    const LensDistortion& d = camera.distortion;
    for (const double number : {d.k1, d.k2, d.k3, d.k4, d.p1, d.p2})
        if (!std::isfinite(number))
            return wrong_lens("its distortion is not finite");
    constexpr int steps = 8;
    for (int j = 0; j <= steps && !d.is_none(); ++j)
        for (int i = 0; i <= steps; ++i) {
            const glm::dvec2 point((camera.width * i / double{steps} - camera.cx) / camera.fx,
                                   (camera.height * j / double{steps} - camera.cy) / camera.fy);
            const glm::dvec2 straight = d.undistort(point);
            const double gap = glm::length(d.distort(straight) - point);
            if (!(gap < 1e-6) || !(glm::determinant(d.slopes(straight)) > 0))
                return wrong_lens("its distortion (k1 " + lens_number(d.k1) + ", k2 " +
                                  lens_number(d.k2) +
                                  ", ...) folds the picture: two directions meet in one pixel");
        }
    return {};
}

} // namespace

Status check_frame_count(std::uint64_t count) {
    if (count == 0)
        return wrong_lens("has no frames");
    if (count > most_photographs)
        return {ErrorCode::unsupported, "has " + std::to_string(count) + " frames, more than " +
                                            std::to_string(most_photographs)};
    return {};
}

Result<PhotoCamera> camera_of(const StatedFrame& frame, std::optional<std::uint32_t> picture_width,
                              std::optional<std::uint32_t> picture_height) {
    const StatedLens& lens = frame.lens;
    const auto width = lens.width ? lens.width : picture_width;
    const auto height = lens.height ? lens.height : picture_height;
    if (!width || !height)
        return wrong_lens("states no size of its picture, which is missing");
    TESSERA_TRY(check_size(*width, *height));
    PhotoCamera camera;
    camera.width = *width;
    camera.height = *height;
    TESSERA_TRY(take_focal_lengths(lens, camera));
    camera.cx = lens.cx.value_or(camera.width / 2.0);
    camera.cy = lens.cy.value_or(camera.height / 2.0);
    if (!(std::abs(camera.cx) <= most_focal && std::abs(camera.cy) <= most_focal))
        return wrong_lens("its principal point is not finite");
    camera.eye = frame.eye;
    if (!(glm::length(camera.eye) <= most_distance))
        return wrong_lens("the position of its camera is not finite or too far from the origin");
    camera.axes = frame.axes;
    camera.distortion = lens.distortion;
    TESSERA_TRY(check_distortion(camera));
    return camera;
}

} // namespace tessera::corpus
