// Which views `tessera render` draws, from where and into which file.
#pragma once

#include "tools/support/camera_grid.h"
#include "tools/view/camera.h"

#include <string>
#include <vector>

namespace tessera {

struct ViewRequest {
    std::string eye, look; // "x,y,z"; empty: the defaults of CameraPose
    std::string size;      // "WxH"; empty: that of Lens
    double fov = 45;       // vertical, degrees
    std::string views;     // empty, "paper", or the number of one of the paper's views
    unsigned orbit = 0;    // frames; 0: no orbit
    std::string output;
};

struct PlannedView {
    std::string name;
    Camera camera;
    std::string output; // "out.png", or with a number: "out-3.png"
};

// Errors: bad_argument.
Result<std::vector<PlannedView>> plan_views(const ViewRequest& request);

// The same of planar views: without request.look the picture is their window, seen from request.eye,
// else from the middle of the cameras.
Result<std::vector<PlannedView>> plan_views(const ViewRequest& request, const CameraGrid& cameras,
                                            const Extent4& size);

} // namespace tessera
