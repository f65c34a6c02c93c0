// Plans the views that `tessera render` draws: their cameras and output files.
#pragma once

#include "corpus/photographs/photograph.h"
#include "tools/support/camera_grid.h"
#include "tools/view/model_cameras.h"

#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct ViewRequest {
    std::string eye, look; // "x,y,z"; empty: those of CameraPose in `frame`
    ViewFrame frame;       // of that pose and of the views
    std::string camera;    // of the file, by name; empty: eye and look
    std::string size;      // of the picture, "WxH"; empty: the default of Lens
    double fov = 45;       // vertical, degrees
    std::string views;     // "paper" or the number of one of its views; empty: eye and look
    unsigned orbit = 0;    // number of frames; 0: no orbit
    std::string output;
    // A description of photographs for corpus::read_photographs(), whose cameras draw the views;
    // empty: one of the cameras above.
    std::string cameras;
    std::optional<double> scale; // of the photographs' sizes
};

struct PlannedView {
    std::string name;
    Camera camera;
    // "out.png" for a single view, otherwise numbered as in "out-3.png". Views of photographs have
    // the photographs' names: "folder/r_0.png", or "out-r_0.png".
    std::string output;
};

// Errors: bad_argument (text that cannot be parsed, or an impossible camera).
Result<std::vector<PlannedView>> plan_views(const ViewRequest& request);

// The same from the camera of the file that the request names. Errors: those of find_camera().
Result<std::vector<PlannedView>> plan_camera(const ViewRequest& request, const Metadata& metadata);

// The same for planar views. Without look, views and orbit the picture shows their whole window.
// The default of request.eye is the centre of the camera grid.
Result<std::vector<PlannedView>> plan_views(const ViewRequest& request, const CameraGrid& cameras,
                                            const Extent4& size);

// The views of request.cameras. Adds what a user should know about them to `notes`. Errors: those of
// corpus::read_photographs(), and bad_argument (--scale, --cameras with another camera).
Result<std::vector<PlannedView>> plan_photographs(const ViewRequest& request,
                                                  std::vector<corpus::PhotographNote>& notes);

} // namespace tessera
