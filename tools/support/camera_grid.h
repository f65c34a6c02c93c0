// The positions of the cameras of planar views (FORMAT.md 5.3), in metadata and as options.
#pragma once

#include "format/metadata.h"
#include "format/texture.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

namespace tessera {

// The cameras look along -z from the plane z = distance through a window in the plane z = 0,
// centred at the origin. All views coincide in the plane of the window. World units.
struct CameraGrid {
    double spacing_x = 0, spacing_y = 0; // from camera to camera
    double distance = 0;                 // of the cameras from the window, above 0
    double width = 0;                    // of the window, above 0; its height follows from U and V
};

// What the user states about the cameras. Defaults replace the rest.
struct CameraFacts {
    std::string spacing;         // "0.05" or "0.05,0.04"
    std::optional<double> fov;   // across the picture, degrees
    std::optional<double> focus; // distance at which the views coincide, world units
    bool empty() const { return spacing.empty() && !fov && !focus; }
};

// By default the window is 2 wide and spans 40 degrees, and the longer side of the grid is a
// quarter of the distance. Errors: bad_argument, with the option.
Result<CameraGrid> camera_grid(const CameraFacts& facts, const Extent4& size);

inline constexpr const char* cameras_key = "Cameras";

// "0.05,0.05,3,2": spacing along x and y, distance, width.
std::string to_string(const CameraGrid& cameras);
// The value of the key Cameras; without the key, the default of camera_grid(). Errors:
// invalid_file.
Result<CameraGrid> cameras_in(const Metadata& metadata, const Extent4& size);

// Where the window of planar views is in the world of the cameras that photographed them. Without
// this key, that world is the window's own.
struct WindowPlace {
    glm::dvec3 centre{0.0};
    glm::dmat3 axes{1.0}; // columns: right, up and towards the cameras; a rotation
};

inline constexpr const char* window_key = "Window";

// Nine numbers: the centre, right and up.
std::string to_string(const WindowPlace& place);
// The value of the key Window; nothing without the key. Errors: invalid_file.
Result<std::optional<WindowPlace>> window_in(const Metadata& metadata);

} // namespace tessera
