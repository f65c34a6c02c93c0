// Where the cameras of planar views stand (FORMAT.md 5.3): the key Cameras, and options that say it.
#pragma once

#include "format/metadata.h"
#include "format/texture.h"

#include <optional>
#include <string>

namespace tessera {

// The cameras look along -z from the plane z = distance through a window in the plane z = 0, whose
// middle is the origin: there all views show the same. World units.
struct CameraGrid {
    double spacing_x = 0, spacing_y = 0; // from camera to camera
    double distance = 0;                 // of the cameras from the window, above 0
    double width = 0;                    // of the window, above 0; its height follows from U and V
};

// What people know of their cameras; the rest is taken for usual.
struct CameraFacts {
    std::string spacing;         // "0.05" or "0.05,0.04"
    std::optional<double> fov;   // across the picture, degrees
    std::optional<double> focus; // distance at which the views coincide
    bool empty() const { return spacing.empty() && !fov && !focus; }
};

// Without facts the window is 2 wide, seen under 40 degrees, and the longer side of the grid spans a quarter
// of its distance. Errors: bad_argument, with the option.
Result<CameraGrid> camera_grid(const CameraFacts& facts, const Extent4& size);

inline constexpr const char* cameras_key = "Cameras";

// "0.05,0.05,3,2": spacing along x and y, distance, width.
std::string to_string(const CameraGrid& cameras);
// What the key says; without it, the usual of camera_grid(). Errors: invalid_file.
Result<CameraGrid> cameras_in(const Metadata& metadata, const Extent4& size);

} // namespace tessera
