// Plans the views that `tessera render` draws: their cameras and output files.
#pragma once

#include "tools/support/camera_grid.h"
#include "tools/view/model_cameras.h"

#include <string>
#include <vector>

namespace tessera {

struct ViewRequest {
    std::string eye, look; // "x,y,z"; empty: the defaults of CameraPose
    std::string camera;    // of the file, by name; empty: eye and look
    std::string size;      // of the picture, "WxH"; empty: the default of Lens
    double fov = 45;       // vertical, degrees
    std::string views;     // "paper" or the number of one of its views; empty: eye and look
    unsigned orbit = 0;    // number of frames; 0: no orbit
    std::string output;
};

struct PlannedView {
    std::string name;
    Camera camera;
    std::string output; // "out.png" for a single view, otherwise numbered as in "out-3.png"
};

// Errors: bad_argument (text that cannot be parsed, or an impossible camera).
Result<std::vector<PlannedView>> plan_views(const ViewRequest& request);

// The same from the camera of the file that the request names. Errors: those of find_camera().
Result<std::vector<PlannedView>> plan_camera(const ViewRequest& request, const Metadata& metadata);

// The same for planar views. Without look, views and orbit the picture shows their whole window.
// The default of request.eye is the centre of the camera grid.
Result<std::vector<PlannedView>> plan_views(const ViewRequest& request, const CameraGrid& cameras,
                                            const Extent4& size);

} // namespace tessera
