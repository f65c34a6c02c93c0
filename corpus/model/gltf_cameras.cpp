#include "corpus/model/gltf_cameras.h"

#include <algorithm>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr std::size_t most_cameras = 256;
constexpr double farthest_camera = 1e12;

// The node's name is what people see in their programs.
std::string camera_name(const tinygltf::Node& node, const tinygltf::Camera& camera,
                        std::size_t number) {
    const std::string& name = !node.name.empty() ? node.name : camera.name;
    return name.empty() ? "camera " + std::to_string(number) : name.substr(0, longest_shown);
}

} // namespace

void GltfCameras::add(const tinygltf::Model& file, const tinygltf::Node& node,
                      const glm::dmat4& place) {
    if (!has(file.cameras, node.camera))
        return;
    const tinygltf::Camera& from = at(file.cameras, node.camera);
    ModelCamera camera;
    camera.eye = glm::dvec3(place[3]);
    camera.forward = -glm::dvec3(place[2]);
    camera.fov = from.perspective.yfov * 180.0 / std::numbers::pi;
    const double length = glm::length(camera.forward);
    camera.forward /= length;
    glm::dvec3 up(place[1]);
    up -= camera.forward * glm::dot(up, camera.forward);
    const double height = glm::length(up);
    camera.up = up / height;
    const bool is_sound = from.type == "perspective" && camera.fov > 0.0 && camera.fov < 180.0 &&
                          length > 1e-12 && length < 1e12 && height > 1e-12 && height < 1e12 &&
                          glm::length(camera.eye) < farthest_camera;
    if (!is_sound || cameras_.size() == most_cameras) {
        ++skipped_;
        return;
    }
    const std::string name = camera_name(node, from, cameras_.size());
    camera.name = name;
    for (int i = 2; std::ranges::any_of(
             cameras_, [&](const ModelCamera& other) { return other.name == camera.name; });
         ++i)
        camera.name = name + " (" + std::to_string(i) + ")";
    cameras_.push_back(std::move(camera));
}

void GltfCameras::finish(Model& model) && {
    if (skipped_ > 0)
        model.notes.push_back("skipped " + std::to_string(skipped_) +
                              (skipped_ == 1 ? " camera" : " cameras") +
                              " without a perspective, without a direction, or beyond the first " +
                              std::to_string(most_cameras));
    model.cameras = std::move(cameras_);
}

} // namespace tessera::corpus
