// What a description states about its photographs, before their pictures are looked for.
#pragma once

#include "corpus/photographs/photograph.h"
#include "format/output_file.h"

#include <cmath>
#include <filesystem>

namespace tessera::corpus {

// Numbers that the description leaves out are absent.
struct StatedLens {
    std::optional<std::uint32_t> width, height; // pixels
    std::optional<double> fx, fy, cx, cy;       // pixels
    std::optional<double> angle_x, angle_y;     // the field of view, radians
    LensDistortion distortion;
};

struct StatedFrame {
    std::string name;
    std::string mask; // a path; empty: none
    StatedLens lens;
    glm::dvec3 eye{0.0};
    glm::dmat3 axes{1.0}; // as in PhotoCamera
};

struct StatedFrames {
    std::vector<StatedFrame> frames;
    // Where names of pictures begin, in the order in which the folders are tried.
    std::vector<std::string> folders;
    std::vector<PhotographNote> notes;
};

// Their errors name the file and the frame.
Result<StatedFrames> read_transforms_json(const std::string& path);
Result<StatedFrames> read_colmap_model(const std::string& folder);
// Whether the folder has the files of a COLMAP model.
bool is_colmap_model(const std::string& folder);

// Whether the regular file exists.
inline bool is_file(const std::string& utf8) {
    std::error_code none;
    return std::filesystem::is_regular_file(to_path(utf8), none);
}
inline bool is_file(const std::filesystem::path& path) {
    return is_file(path.string());
}

// Names in damaged files can be very long.
inline std::string frame_context(const std::string& path, const std::string& name) {
    return path + ": frame '" + name.substr(0, 200) + "'";
}

// A number of frames that is neither 0 nor too large. Errors do not name the file.
Status check_frame_count(std::uint64_t count);

// The camera of a frame whose picture has this size where the description states none. Errors, which
// name no file: invalid_file (an absent, infinite or not positive number, a distortion that folds
// the picture), unsupported (too large).
Result<PhotoCamera> camera_of(const StatedFrame& frame, std::optional<std::uint32_t> picture_width,
                              std::optional<std::uint32_t> picture_height);

// Turns the photographs of `stated` into posed ones by finding and opening their pictures. `path`
// names the description in messages.
Result<PhotographSet> find_pictures(const std::string& path, StatedFrames stated,
                                    const PhotographOptions& options);

} // namespace tessera::corpus
