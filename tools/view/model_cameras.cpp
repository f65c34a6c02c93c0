#include "tools/view/model_cameras.h"

#include "tools/support/parse.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

Json list_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

bool read_vector(const Json& camera, const char* key, glm::dvec3& v) {
    const auto it = camera.find(key);
    if (it == camera.end() || !it->is_array() || it->size() != 3)
        return false;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(*it)[i].is_number())
            return false;
        v[static_cast<glm::length_t>(i)] = (*it)[i].get<double>();
    }
    return true;
}

bool read_camera(const Json& from, corpus::ModelCamera& camera) {
    if (!from.is_object() || !from.contains("name") || !from["name"].is_string() ||
        !from.contains("fov") || !from["fov"].is_number())
        return false;
    camera.name = from["name"].get<std::string>();
    camera.fov = from["fov"].get<double>();
    return read_vector(from, "eye", camera.eye) && read_vector(from, "forward", camera.forward) &&
           read_vector(from, "up", camera.up) && glm::length(camera.forward) > 0.5 &&
           glm::length(glm::cross(camera.forward, camera.up)) > 1e-6;
}

} // namespace

std::string cameras_text(std::span<const corpus::ModelCamera> cameras) {
    Json list = Json::array();
    for (const corpus::ModelCamera& camera : cameras)
        list.push_back({{"name", camera.name},
                        {"eye", list_of(camera.eye)},
                        {"forward", list_of(camera.forward)},
                        {"up", list_of(camera.up)},
                        {"fov", camera.fov}});
    return list.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<std::vector<corpus::ModelCamera>> model_cameras_in(const Metadata& metadata) {
    std::vector<corpus::ModelCamera> cameras;
    const auto text = metadata.find(model_cameras_key);
    if (text == metadata.end())
        return cameras;
    const Json list = Json::parse(text->second, nullptr, false);
    bool is_sound = list.is_array();
    if (is_sound)
        for (const Json& from : list) {
            cameras.emplace_back();
            is_sound = is_sound && read_camera(from, cameras.back());
        }
    if (!is_sound)
        return Status(ErrorCode::invalid_file, std::string("the metadata key ") +
                                                   model_cameras_key + " is not a list of cameras");
    return cameras;
}

Result<NamedCamera> find_camera(const Metadata& metadata, const std::string& name) {
    TESSERA_TRY_ASSIGN(const auto cameras, model_cameras_in(metadata));
    std::string names;
    for (const corpus::ModelCamera& camera : cameras) {
        if (camera.name == name)
            return NamedCamera{{camera.eye, camera.eye + camera.forward, camera.up}, camera.fov};
        if (names.size() < 300)
            names += (names.empty() ? "'" : ", '") + printable(camera.name) + "'";
    }
    return Status(ErrorCode::bad_argument,
                  "--camera '" + printable(name.substr(0, 80)) + "': " +
                      (names.empty() ? "the file has no cameras. bake stores those of a glTF file"
                                     : "the file has " + names));
}

} // namespace tessera
