// Where a sphere or a window lies that photographs look at, and how fine a texture on it may be.
// All functions are thread-safe.
#pragma once

#include "corpus/fit/seen_surface.h"
#include "corpus/photographs/photograph.h"

#include <span>

namespace tessera::corpus {

struct PhotoSphere {
    glm::dvec3 centre{0.0};
    double radius = 1;
};

// What the user states; the rest is estimated.
struct SphereWish {
    std::optional<glm::dvec3> centre;
    std::optional<double> radius;
};

// The centre is the place that is nearest to the axes of all cameras. The radius is that of the
// sphere which half of the photographs show whole. With a `background`, in display values, it is not
// larger than the pixels of other colours need. Errors: bad_argument (cameras that do not look at
// one place; a camera inside the sphere, with its frame), those of read_photograph().
Result<PhotoSphere> sphere_of(std::span<const PosedPhotograph> photographs, const SphereWish& wish,
                              const std::optional<glm::dvec3>& background);

// The window at `focus` world units from the cameras' plane, which is perpendicular to the mean of
// their axes. It is as wide as the photographs show it, around the axis through the middle of the
// cameras. There are about as many cameras as photographs; `cameras`, if it is not 0, is their
// number along the longer side. `texels` of the whole texture are the most that are wanted.
// `height` fits to whole texels. Errors: bad_argument (cameras that look in opposite directions, or
// that all stand at one place; a camera behind the window or parallel to it, with its frame).
struct SizedWindow {
    PhotoWindow window;
    std::array<std::uint32_t, 2> pixels{1, 1}; // of a view
};
Result<SizedWindow> window_of(std::span<const PosedPhotograph> photographs, double focus,
                              std::uint32_t cameras, double texels);

// Distances of the window that are worth a trial, ascending: from the width of the cameras' plane
// to 32 times that. Empty if all cameras stand at one place.
std::vector<double> possible_focuses(std::span<const PosedPhotograph> photographs);

// The number of directions along s and t of a texture on the sphere, 4 to 32, such that neighbouring
// directions are half as far apart as neighbouring photographs, seen from its centre. Between
// photographs, the fit continues what they show at the focus.
std::uint32_t directions_of(const PhotoSphere& sphere,
                            std::span<const PosedPhotograph> photographs);

// The number of places along u, which is twice that along v. It is that of the nearest pixels, but
// not so large that the texture has more than `texels`.
std::uint32_t width_on(const PhotoSphere& sphere, std::span<const PosedPhotograph> photographs,
                       std::uint32_t directions, double texels);

} // namespace tessera::corpus
