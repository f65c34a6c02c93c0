#include "corpus/fit/view_surfaces.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

Status frame_error(const PosedPhotograph& photograph, const std::string& what) {
    return {ErrorCode::bad_argument, "frame '" + photograph.name.substr(0, 200) + "': " + what};
}

// The element below which `share` of them lie. Precondition: there are numbers.
double quantile(std::vector<double> numbers, double share) {
    const auto at = numbers.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(numbers.size() - 1));
    std::nth_element(numbers.begin(), at, numbers.end());
    return *at;
}

// Places along the picture's edges, in pixels.
std::vector<glm::dvec2> edge_places(const PhotoCamera& camera) {
    constexpr int steps = 4; // per side
    std::vector<glm::dvec2> places;
    for (int i = 0; i <= steps; ++i)
        for (const double end : {0.0, 1.0}) {
            const double share = static_cast<double>(i) / steps;
            places.emplace_back(share * camera.width, end * camera.height);
            places.emplace_back(end * camera.width, share * camera.height);
        }
    return places;
}

// The place with the least sum of squared distances to the cameras' axes.
Result<glm::dvec3> place_in_view(std::span<const PosedPhotograph> photographs) {
    glm::dmat3 squares(0.0);
    glm::dvec3 products(0.0);
    for (const PosedPhotograph& p : photographs) {
        const glm::dvec3& axis = p.camera.axes[2];
        const glm::dmat3 across = glm::dmat3(1.0) - glm::outerProduct(axis, axis);
        squares += across;
        products += across * p.camera.eye;
    }
    const auto count = static_cast<double>(photographs.size());
    const glm::dmat3 mean = squares / count;
    if (!(glm::determinant(mean) > 1e-4))
        return Status(ErrorCode::bad_argument,
                      "all cameras look in the same direction, so they do not say where the sphere "
                      "is; state its centre and radius, or fit planar views");
    const glm::dvec3 centre = glm::inverse(squares) * products;
    const auto behind = std::ranges::count_if(photographs, [&](const PosedPhotograph& p) {
        return glm::dot(centre - p.camera.eye, p.camera.axes[2]) <= 0.0;
    });
    if (2 * behind > static_cast<std::ptrdiff_t>(photographs.size()))
        return Status(ErrorCode::bad_argument,
                      "the cameras look outwards, away from the middle of their views; a sphere "
                      "needs photographs of an object from around it");
    return centre;
}

// Of the largest sphere around `centre` that the photograph shows whole; 0 if the centre is outside.
double radius_in_view(const PhotoCamera& camera, const glm::dvec3& centre) {
    const auto at = camera.project(centre);
    if (!at || at->x < 0 || at->y < 0 || at->x > camera.width || at->y > camera.height)
        return 0;
    const glm::dvec3 to_centre = centre - camera.eye;
    double least = std::numeric_limits<double>::max();
    for (const glm::dvec2& place : edge_places(camera))
        least =
            std::min(least, glm::length(glm::cross(to_centre, camera.direction(place.x, place.y))));
    return least;
}

// The distance from the centre of the rays of nearly all pixels that differ from the background.
Result<double> radius_of_object(std::span<const PosedPhotograph> photographs,
                                const glm::dvec3& centre, const glm::dvec3& background) {
    constexpr std::size_t most_read = 24;
    constexpr double tolerance = 8.0 / 255.0, counted = 0.999, margin = 1.02;
    const std::size_t count = std::min(most_read, photographs.size());
    double radius = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const PosedPhotograph& photograph = photographs[n * photographs.size() / count];
        TESSERA_TRY_ASSIGN(const PhotoPixels pixels, read_photograph(photograph, background));
        std::vector<double> distances;
        for (std::uint32_t y = 0; y < pixels.height; ++y)
            for (std::uint32_t x = 0; x < pixels.width; ++x) {
                const auto& texel = pixels.texels[std::size_t{y} * pixels.width + x];
                double difference = 0;
                for (glm::length_t c = 0; c < 3; ++c)
                    difference =
                        std::max(difference,
                                 std::abs(static_cast<double>(texel[static_cast<std::size_t>(c)]) -
                                          background[c]));
                if (texel[3] > 0.0f && difference > tolerance)
                    distances.push_back(
                        glm::length(glm::cross(centre - photograph.camera.eye,
                                               photograph.camera.direction(x + 0.5, y + 0.5))));
            }
        if (!distances.empty())
            radius = std::max(radius, margin * quantile(std::move(distances), counted));
    }
    return radius;
}

// How the cameras of a window stand, in world units.
struct CameraPlane {
    glm::dmat3 axes{1.0};   // right, up and towards the cameras
    glm::dvec3 middle{0.0}; // of the cameras
    glm::dvec2 extent{0.0}; // along right and up
};

Result<CameraPlane> camera_plane(std::span<const PosedPhotograph> photographs) {
    glm::dvec3 forward(0.0), right(0.0);
    for (const PosedPhotograph& p : photographs) {
        forward += p.camera.axes[2];
        right += p.camera.axes[0];
    }
    const auto count = static_cast<double>(photographs.size());
    if (!(glm::length(forward) > 0.5 * count) || !(glm::length(right) > 0.5 * count))
        return Status(ErrorCode::bad_argument,
                      "the cameras look in too different directions, or are turned about their "
                      "axes, so they have no window in common; fit a sphere");
    CameraPlane plane;
    const glm::dvec3 back = -glm::normalize(forward);
    const glm::dvec3 x = glm::normalize(right - back * glm::dot(right, back));
    plane.axes = glm::dmat3(x, glm::cross(back, x), back);
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low), sum(0.0);
    for (const PosedPhotograph& p : photographs) {
        const glm::dvec3 eye = p.camera.eye * plane.axes;
        low = glm::min(low, eye);
        high = glm::max(high, eye);
        sum += eye;
    }
    plane.middle =
        plane.axes * glm::dvec3((low.x + high.x) / 2, (low.y + high.y) / 2, sum.z / count);
    plane.extent = {high.x - low.x, high.y - low.y};
    return plane;
}

// How many cameras to a side, and how far apart.
Status set_cameras(PhotoWindow& window, const CameraPlane& plane, std::size_t photographs,
                   std::uint32_t given) {
    constexpr double most_cameras = 64;
    const double longer = std::max(plane.extent.x, plane.extent.y);
    if (!(longer > 1e-9 * window.distance))
        return {ErrorCode::bad_argument,
                "all photographs are from one place, which is not enough for planar views"};
    const glm::dvec2 share = plane.extent / longer;
    // A row of cameras has no extent to speak of across it.
    constexpr double least_share = 0.02;
    const bool is_row = std::min(share.x, share.y) < least_share;
    const double usual = is_row ? static_cast<double>(photographs)
                                : std::sqrt(static_cast<double>(photographs) / (share.x * share.y));
    const double along = given > 0 ? given : usual;
    for (glm::length_t i = 0; i < 2; ++i) {
        const double number = share[i] < least_share
                                  ? 1.0
                                  : std::clamp(std::round(along * share[i]), 2.0, most_cameras);
        window.cameras[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(number);
        (i == 0 ? window.spacing_x : window.spacing_y) =
            number > 1 ? plane.extent[i] / (number - 1) : longer;
    }
    return {};
}

} // namespace

Result<PhotoSphere> sphere_of(std::span<const PosedPhotograph> photographs, const SphereWish& wish,
                              const std::optional<glm::dvec3>& background) {
    PhotoSphere sphere;
    if (wish.centre) {
        sphere.centre = *wish.centre;
    } else {
        TESSERA_TRY_ASSIGN(sphere.centre, place_in_view(photographs));
    }
    if (wish.radius) {
        sphere.radius = *wish.radius;
    } else {
        std::vector<double> radii;
        for (const PosedPhotograph& p : photographs)
            radii.push_back(radius_in_view(p.camera, sphere.centre));
        sphere.radius = quantile(std::move(radii), 0.5);
        if (background) {
            TESSERA_TRY_ASSIGN(const double needed,
                               radius_of_object(photographs, sphere.centre, *background));
            if (needed > 0)
                sphere.radius = std::min(sphere.radius, needed);
        }
        if (!(sphere.radius > 0))
            return Status(ErrorCode::bad_argument,
                          "half of the photographs do not show the centre of the sphere; state its "
                          "centre and radius");
    }
    for (const PosedPhotograph& p : photographs)
        if (glm::length(p.camera.eye - sphere.centre) <= sphere.radius)
            return frame_error(p, "the camera is inside the sphere; state a smaller radius");
    return sphere;
}

std::uint32_t directions_of(const PhotoSphere& sphere,
                            std::span<const PosedPhotograph> photographs) {
    constexpr double fewest = 4, most = 32;
    std::vector<glm::dvec3> towards;
    for (const PosedPhotograph& p : photographs)
        towards.push_back(glm::normalize(p.camera.eye - sphere.centre));
    constexpr std::size_t most_looked_at = 2000; // the work grows with the square
    towards.resize(std::min(towards.size(), most_looked_at));
    std::vector<double> angles;
    for (std::size_t i = 0; i < towards.size(); ++i) {
        double nearest = 2.0;
        for (std::size_t j = 0; j < towards.size(); ++j)
            if (j != i)
                nearest = std::min(nearest, glm::length(towards[i] - towards[j]));
        angles.push_back(2.0 * std::asin(nearest / 2.0));
    }
    const double angle = std::max(quantile(std::move(angles), 0.5), 1e-3);
    return static_cast<std::uint32_t>(
        std::clamp(std::round(2.0 * std::numbers::pi / angle), fewest, most));
}

std::uint32_t width_on(const PhotoSphere& sphere, std::span<const PosedPhotograph> photographs,
                       std::uint32_t directions, double texels) {
    std::vector<double> pixels; // as large as they are where the sphere is nearest
    for (const PosedPhotograph& p : photographs)
        pixels.push_back((glm::length(p.camera.eye - sphere.centre) - sphere.radius) /
                         std::sqrt(p.camera.fx * p.camera.fy));
    const double finest =
        std::numbers::pi * sphere.radius / std::max(quantile(std::move(pixels), 0.05), 1e-12);
    const double affordable = std::sqrt(texels / 2.0) / directions;
    constexpr double fewest = 4, most = 8192; // along v
    return 2 * static_cast<std::uint32_t>(
                   std::clamp(std::floor(std::min(finest, affordable)), fewest, most));
}

Result<SizedWindow> window_of(std::span<const PosedPhotograph> photographs, double focus,
                              std::uint32_t cameras, double texels) {
    TESSERA_TRY_ASSIGN(const CameraPlane plane, camera_plane(photographs));
    SizedWindow sized;
    PhotoWindow& window = sized.window;
    window.axes = plane.axes;
    window.distance = focus;
    window.centre = plane.middle - focus * plane.axes[2];
    TESSERA_TRY(set_cameras(window, plane, photographs.size(), cameras));
    constexpr double least_slope = 0.1; // of rays towards the window
    glm::dvec2 half(0.0);
    std::vector<double> pixels;
    for (const PosedPhotograph& p : photographs) {
        const glm::dvec3 eye = window.local(p.camera.eye);
        if (!(eye.z > 0.1 * focus))
            return frame_error(p, "the camera is behind the window; state a larger --focus");
        pixels.push_back(eye.z / std::sqrt(p.camera.fx * p.camera.fy));
        for (const glm::dvec2& place : edge_places(p.camera)) {
            const glm::dvec3 d = p.camera.direction(place.x, place.y) * window.axes;
            if (!(d.z < -least_slope))
                return frame_error(p, "the camera looks along the window; fit a sphere");
            const glm::dvec3 at = eye - eye.z / d.z * d;
            half = glm::max(half, glm::abs(glm::dvec2(at)));
        }
    }
    constexpr double fewest = 4, most = 16384;
    const double views = static_cast<double>(window.cameras[0]) * window.cameras[1];
    const double pixel = std::max(quantile(std::move(pixels), 0.5),
                                  std::sqrt(4.0 * half.x * half.y * views / texels));
    const auto side = [&](double length) {
        return static_cast<std::uint32_t>(std::clamp(std::round(length / pixel), fewest, most));
    };
    sized.pixels = {side(2.0 * half.x), side(2.0 * half.y)};
    window.width = 2.0 * half.x;
    window.height = window.width * sized.pixels[1] / sized.pixels[0];
    return sized;
}

std::vector<double> possible_focuses(std::span<const PosedPhotograph> photographs) {
    constexpr int steps = 11;
    std::vector<double> focuses;
    const auto plane = camera_plane(photographs);
    if (!plane.ok())
        return focuses;
    const double longer = std::max(plane->extent.x, plane->extent.y);
    for (int i = 0; i < steps && longer > 0; ++i)
        focuses.push_back(longer * std::exp2(0.5 * i));
    return focuses;
}

} // namespace tessera::corpus
