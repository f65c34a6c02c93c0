// The files of a COLMAP model: cameras and images, as text or binary.
#pragma once

#include "corpus/photographs/stated_frames.h"

#include <map>
#include <span>

namespace tessera::corpus {

// A camera model of COLMAP.
struct ColmapLens {
    const char* name;
    std::size_t parameters; // how many numbers follow its size
    bool is_supported;
};

// By COLMAP's number or its name. Errors: invalid_file.
Result<ColmapLens> colmap_lens(std::int64_t number);
Result<ColmapLens> colmap_lens(std::string_view name);

struct ColmapCamera {
    ColmapLens lens{};
    std::uint64_t width = 0, height = 0; // pixels
    std::vector<double> parameters;      // as many as the lens has
};
using ColmapCameras = std::map<std::uint32_t, ColmapCamera>; // by id

// The place p of the world is at rotation(p) + shift in the camera's frame.
struct ColmapImage {
    std::string name;
    std::array<double, 4> rotation{}; // a quaternion: w, x, y, z
    glm::dvec3 shift{0.0};
    std::uint32_t camera = 0;
};

// Errors name the file and the place in it: io, invalid_file, unsupported (too many).
Result<ColmapCameras> read_colmap_cameras_text(const std::string& path);
Result<ColmapCameras> read_colmap_cameras_binary(const std::string& path);
Result<std::vector<ColmapImage>> read_colmap_images_text(const std::string& path);
Result<std::vector<ColmapImage>> read_colmap_images_binary(const std::string& path);

} // namespace tessera::corpus
