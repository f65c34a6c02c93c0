#include "corpus/model/text_lines.h"
#include "corpus/photographs/colmap_files.h"

#include <array>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

namespace tessera::corpus {
namespace {

// In the order of COLMAP's numbers.
constexpr std::array<ColmapLens, 11> colmap_lenses{{{"SIMPLE_PINHOLE", 3, true},
                                                    {"PINHOLE", 4, true},
                                                    {"SIMPLE_RADIAL", 4, true},
                                                    {"RADIAL", 5, true},
                                                    {"OPENCV", 8, true},
                                                    {"OPENCV_FISHEYE", 8, false},
                                                    {"FULL_OPENCV", 12, false},
                                                    {"FOV", 5, false},
                                                    {"SIMPLE_RADIAL_FISHEYE", 4, false},
                                                    {"RADIAL_FISHEYE", 5, false},
                                                    {"THIN_PRISM_FISHEYE", 12, false}}};

// Errors do not name the file.
Result<StatedLens> lens_of(const ColmapCamera& camera) {
    const std::string_view name = camera.lens.name;
    if (!camera.lens.is_supported)
        return Status(ErrorCode::unsupported,
                      "the camera model " + std::string(name) +
                          " is not supported; undistort the pictures with `colmap "
                          "image_undistorter`, or use PINHOLE, SIMPLE_RADIAL, RADIAL or OPENCV");
    const auto& p = camera.parameters;
    constexpr std::uint64_t most = 1'000'000'000;
    StatedLens lens;
    lens.width = static_cast<std::uint32_t>(std::min(camera.width, most));
    lens.height = static_cast<std::uint32_t>(std::min(camera.height, most));
    // PINHOLE and OPENCV have two focal lengths.
    const bool has_fy = name == "PINHOLE" || name == "OPENCV";
    std::size_t next = 0;
    lens.fx = p[next++];
    lens.fy = has_fy ? p[next++] : p[0];
    lens.cx = p[next++];
    lens.cy = p[next++];
    for (double* number :
         {&lens.distortion.k1, &lens.distortion.k2, &lens.distortion.p1, &lens.distortion.p2})
        if (next < p.size())
            *number = p[next++];
    return lens;
}

Status take_colmap_pose(const ColmapImage& image, StatedFrame& frame) {
    const auto& [w, x, y, z] = image.rotation;
    const double length = std::sqrt(w * w + x * x + y * y + z * z);
    if (!(std::abs(length - 1) < 1e-2))
        return {ErrorCode::invalid_file, "its rotation is not a quaternion of length 1"};
    const glm::dmat3 into_camera =
        glm::mat3_cast(glm::dquat(w / length, x / length, y / length, z / length));
    frame.axes = glm::transpose(into_camera);
    frame.eye = -(frame.axes * image.shift);
    return {};
}

std::string colmap_file(const std::string& folder, const char* name, bool is_text) {
    return folder + "/" + name + (is_text ? ".txt" : ".bin");
}

bool has_colmap_files(const std::string& folder, bool is_text) {
    return is_file(colmap_file(folder, "cameras", is_text)) &&
           is_file(colmap_file(folder, "images", is_text));
}

} // namespace

Result<ColmapLens> colmap_lens(std::int64_t number) {
    if (number < 0 || number >= static_cast<std::int64_t>(colmap_lenses.size()))
        return Status(ErrorCode::invalid_file,
                      "no camera model of COLMAP has the number " + std::to_string(number));
    return colmap_lenses[static_cast<std::size_t>(number)];
}

Result<ColmapLens> colmap_lens(std::string_view name) {
    for (const ColmapLens& lens : colmap_lenses)
        if (name == lens.name)
            return lens;
    return Status(ErrorCode::invalid_file, in_quotes(name) + " is no camera model of COLMAP");
}

bool is_colmap_model(const std::string& folder) {
    return has_colmap_files(folder, false) || has_colmap_files(folder, true);
}

Result<StatedFrames> read_colmap_model(const std::string& folder) {
    const bool is_text = !has_colmap_files(folder, false);
    const std::string path = colmap_file(folder, "images", is_text);
    const std::string cameras_path = colmap_file(folder, "cameras", is_text);
    TESSERA_TRY_ASSIGN(const auto cameras, is_text ? read_colmap_cameras_text(cameras_path)
                                                   : read_colmap_cameras_binary(cameras_path));
    TESSERA_TRY_ASSIGN(auto images,
                       is_text ? read_colmap_images_text(path) : read_colmap_images_binary(path));
    TESSERA_TRY(check_frame_count(images.size()).with_context(path));
    StatedFrames stated;
    for (const char* place : {"/images", "/../images", "/../../images"})
        stated.folders.push_back(folder + place);
    for (ColmapImage& image : images) {
        StatedFrame frame;
        const std::string context = frame_context(path, image.name);
        frame.name = std::move(image.name);
        const auto camera = cameras.find(image.camera);
        if (camera == cameras.end())
            return Status(ErrorCode::invalid_file, context + ": camera " +
                                                       std::to_string(image.camera) +
                                                       " is not in " + cameras_path);
        TESSERA_TRY_ASSIGN(frame.lens, lens_of(camera->second)
                                           .with_context(cameras_path + ": camera " +
                                                         std::to_string(image.camera)));
        TESSERA_TRY(take_colmap_pose(image, frame).with_context(context));
        stated.frames.push_back(std::move(frame));
    }
    return stated;
}

} // namespace tessera::corpus
