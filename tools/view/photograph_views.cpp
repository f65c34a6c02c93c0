#include "format/output_file.h"
#include "tools/support/parse.h"
#include "tools/view/render_views.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// The photograph's camera for a picture of `scale` times its size.
Result<corpus::PhotoCamera> scaled_camera(const corpus::PhotoCamera& camera, double scale) {
    const auto side = [scale](std::uint32_t pixels) {
        return std::max(1.0, std::round(pixels * scale));
    };
    const double width = side(camera.width), height = side(camera.height);
    if (width > max_picture_side || height > max_picture_side)
        return Status(ErrorCode::bad_argument, "--scale " + format_number(scale, 3) +
                                                   ": each side must have at most " +
                                                   std::to_string(max_picture_side) + " pixels");
    return camera.resized(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
}

// "views" -> "views/left/r_0.png"; "out.png" -> "out-left-r_0.png".
std::string output_of(const std::string& output, std::string name) {
    const std::string ending = to_path(output).extension().string();
    if (ending != ".png" && ending != ".exr")
        return output + (output.ends_with('/') ? "" : "/") + name + ".png";
    std::ranges::replace(name, '/', '-');
    return output.substr(0, output.size() - ending.size()) + "-" + name + ending;
}

} // namespace

Result<std::vector<PlannedView>> plan_photographs(const ViewRequest& request,
                                                  std::vector<corpus::PhotographNote>& notes) {
    TESSERA_TRY_ASSIGN(auto set, corpus::read_photographs(request.cameras,
                                                          {.images = "", .with_pictures = false}));
    notes = std::move(set.notes);
    const std::vector<std::string> names = corpus::names_of(set.photographs);
    std::vector<PlannedView> plan;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const corpus::PosedPhotograph& photograph = set.photographs[i];
        TESSERA_TRY_ASSIGN(const auto camera,
                           scaled_camera(photograph.camera, request.scale.value_or(1)));
        plan.push_back({names[i], make_camera(camera), output_of(request.output, names[i])});
    }
    return plan;
}

} // namespace tessera
