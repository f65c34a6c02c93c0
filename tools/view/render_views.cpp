#include "tools/view/render_views.h"

#include "format/output_file.h"
#include "tools/support/parse.h"
#include "tools/view/planar_renderer.h"

#include <filesystem>

namespace tessera {
namespace {

Status parse_picture_size(const std::string& text, Lens& lens) {
    const std::size_t cross = text.find('x');
    std::uint64_t width = 0, height = 0;
    if (cross == std::string::npos ||
        !parse_number(std::string_view(text).substr(0, cross), width) ||
        !parse_number(std::string_view(text).substr(cross + 1), height))
        return {ErrorCode::bad_argument, "--pixels '" + text + "' is not a size such as 640x480"};
    if (width < 1 || height < 1 || width > max_picture_side || height > max_picture_side)
        return {ErrorCode::bad_argument, "--pixels '" + text + "': each side must have 1 to " +
                                             std::to_string(max_picture_side) + " pixels"};
    lens.width = static_cast<std::uint32_t>(width);
    lens.height = static_cast<std::uint32_t>(height);
    return {};
}

// "out.png" -> "out-07.png".
std::string numbered(const std::string& path, std::size_t number, std::size_t digits) {
    const std::filesystem::path p = to_path(path);
    std::string text = std::to_string(number);
    text.insert(0, digits - std::min(digits, text.size()), '0');
    std::filesystem::path out = p;
    out.replace_filename(p.stem().string() + "-" + text + p.extension().string());
    return out.string();
}

Result<std::vector<NamedPose>> poses_of(const ViewRequest& request, const CameraPose& pose) {
    if (request.orbit > 0) {
        TESSERA_TRY_ASSIGN(const auto poses, orbit(pose, request.orbit));
        std::vector<NamedPose> named;
        for (const CameraPose& p : poses)
            named.push_back({"frame " + std::to_string(named.size() + 1), p});
        return named;
    }
    if (request.views.empty())
        return std::vector<NamedPose>{{"view", pose}};
    const std::vector<NamedPose> paper = paper_views(request.frame);
    if (request.views == "paper")
        return paper;
    std::uint64_t number = 0;
    if (!parse_number(request.views, number) || number < 1 || number > paper.size())
        return Status(ErrorCode::bad_argument, "--views '" + request.views +
                                                   "' is neither paper nor a number from 1 to " +
                                                   std::to_string(paper.size()));
    return std::vector<NamedPose>{paper[number - 1]};
}

} // namespace

Result<std::vector<PlannedView>> plan_views(const ViewRequest& request) {
    CameraPose pose = request.frame({});
    Lens lens;
    lens.fov = request.fov;
    if (!request.eye.empty())
        TESSERA_TRY(parse_point(request.eye, pose.eye).with_context("--eye"));
    if (!request.look.empty())
        TESSERA_TRY(parse_point(request.look, pose.look).with_context("--look"));
    if (!request.size.empty())
        TESSERA_TRY(parse_picture_size(request.size, lens));
    TESSERA_TRY_ASSIGN(const auto poses, poses_of(request, pose));
    const std::size_t digits = std::to_string(poses.size()).size();
    const bool many = request.orbit > 0 || poses.size() > 1;
    std::vector<PlannedView> plan;
    for (const NamedPose& p : poses) {
        TESSERA_TRY_ASSIGN(const auto camera, make_camera(p.pose, lens));
        plan.push_back({p.name, camera,
                        many ? numbered(request.output, plan.size() + 1, digits) : request.output});
    }
    return plan;
}

Result<std::vector<PlannedView>> plan_camera(const ViewRequest& request, const Metadata& metadata) {
    TESSERA_TRY_ASSIGN(const NamedCamera found, find_camera(metadata, request.camera));
    Lens lens;
    lens.fov = found.fov;
    if (!request.size.empty())
        TESSERA_TRY(parse_picture_size(request.size, lens));
    TESSERA_TRY_ASSIGN(const auto camera, make_camera(found.pose, lens));
    return std::vector<PlannedView>{{request.camera, camera, request.output}};
}

Result<std::vector<PlannedView>> plan_views(const ViewRequest& request, const CameraGrid& cameras,
                                            const Extent4& size) {
    ViewRequest from_cameras = request;
    if (request.eye.empty())
        from_cameras.eye = "0,0," + std::to_string(cameras.distance);
    TESSERA_TRY_ASSIGN(auto plan, plan_views(from_cameras));
    if (!request.look.empty() || request.orbit > 0 || !request.views.empty())
        return plan;
    for (PlannedView& view : plan) {
        if (request.eye.empty())
            view.camera.eye = {0, 0, cameras.distance};
        view.camera =
            window_camera(view.camera.eye, cameras, size, view.camera.width, view.camera.height);
    }
    return plan;
}

} // namespace tessera
