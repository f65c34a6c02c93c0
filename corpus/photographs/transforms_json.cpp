#include "corpus/model/obj_text.h"
#include "corpus/model/readers.h"
#include "corpus/photographs/stated_frames.h"

#include <array>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

namespace tessera::corpus {
namespace {

using FrameJson = nlohmann::json;

constexpr std::size_t most_transform_bytes = std::size_t{1} << 28;
constexpr int deepest_transforms = 16;
constexpr double most_skew = 1e-3; // of a rotation that was rounded when it was written

Status wrong_frame(const std::string& what) {
    return {ErrorCode::invalid_file, what};
}

// Where JSON could not be read, and why.
Status json_error(std::string_view text, std::size_t byte) {
    const std::size_t at = std::min(byte > 0 ? byte - 1 : 0, text.size());
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    // Python writes these, although JSON has no such numbers. The parser stops behind their start.
    const std::string_view near = text.substr(at - std::min<std::size_t>(at, 3), 12);
    for (const char* word : {"NaN", "Infinity"})
        if (near.find(std::string_view(word).substr(0, 3)) != std::string_view::npos)
            return wrong_frame("line " + std::to_string(line) + ": " + word + " is not a number");
    return wrong_frame("line " + std::to_string(line) + ": not JSON");
}

Result<FrameJson> parse_transforms(std::string_view text) {
    bool too_deep = false;
    const auto watch = [&](int depth, FrameJson::parse_event_t, FrameJson&) {
        too_deep = too_deep || depth > deepest_transforms;
        return !too_deep;
    };
    try {
        FrameJson json = FrameJson::parse(text, watch);
        if (too_deep)
            return wrong_frame("the JSON is nested more than " +
                               std::to_string(deepest_transforms) + " deep");
        if (!json.is_object())
            return wrong_frame("not a JSON object with frames");
        return json;
    } catch (const FrameJson::parse_error& e) {
        return json_error(text, e.byte);
    } catch (const FrameJson::exception&) {
        return wrong_frame("has a number that is too large");
    }
}

// The values of a frame, which come before those of the whole file.
struct Scopes {
    const FrameJson& frame;
    const FrameJson& file;

    // null if neither has the key.
    const FrameJson* find(const char* key) const {
        for (const FrameJson* scope : {&frame, &file})
            if (const auto it = scope->find(key); it != scope->end() && !it->is_null())
                return &*it;
        return nullptr;
    }

    Status number(const char* key, std::optional<double>& out) const {
        const FrameJson* value = find(key);
        if (value == nullptr)
            return {};
        if (!value->is_number())
            return wrong_frame(std::string(key) + " is not a number");
        out = value->get<double>();
        return {};
    }

    Status number_or_0(const char* key, double& out) const {
        std::optional<double> value;
        TESSERA_TRY(number(key, value));
        out = value.value_or(0.0);
        return {};
    }

    // Some programs write sizes as 800.0.
    Status pixels(const char* key, std::optional<std::uint32_t>& out) const {
        std::optional<double> value;
        TESSERA_TRY(number(key, value));
        if (!value)
            return {};
        if (!(*value >= 1 && *value <= 1e9) || *value != std::floor(*value))
            return wrong_frame(std::string(key) + " is not a number of pixels");
        out = static_cast<std::uint32_t>(*value);
        return {};
    }
};

Status check_camera_model(const Scopes& scopes) {
    if (const FrameJson* model = scopes.find("camera_model")) {
        if (!model->is_string())
            return wrong_frame("camera_model is not a name");
        constexpr std::array known = {"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL",
                                      "RADIAL",         "OPENCV",  "PERSPECTIVE"};
        const auto& name = model->get_ref<const std::string&>();
        if (std::ranges::find(known, name) == known.end())
            return {ErrorCode::unsupported,
                    "camera_model " + in_quotes(name) +
                        " is not supported, only PINHOLE, SIMPLE_RADIAL, RADIAL and OPENCV"};
    }
    if (const FrameJson* fisheye = scopes.find("is_fisheye"); fisheye && *fisheye == true)
        return {ErrorCode::unsupported, "fisheye lenses are not supported"};
    if (const FrameJson* shutter = scopes.find("rolling_shutter"); shutter && shutter->is_array())
        for (const FrameJson& number : *shutter)
            if (number != 0)
                return {ErrorCode::unsupported, "rolling shutters are not supported"};
    for (const char* key : {"k5", "k6"})
        if (const FrameJson* number = scopes.find(key); number && *number != 0)
            return {ErrorCode::unsupported,
                    std::string(key) + ": OpenCV's rational distortion is not supported"};
    return {};
}

Result<StatedLens> stated_lens(const Scopes& scopes) {
    TESSERA_TRY(check_camera_model(scopes));
    StatedLens lens;
    TESSERA_TRY(scopes.pixels("w", lens.width));
    TESSERA_TRY(scopes.pixels("h", lens.height));
    TESSERA_TRY(scopes.number("fl_x", lens.fx));
    TESSERA_TRY(scopes.number("fl_y", lens.fy));
    TESSERA_TRY(scopes.number("cx", lens.cx));
    TESSERA_TRY(scopes.number("cy", lens.cy));
    TESSERA_TRY(scopes.number("camera_angle_x", lens.angle_x));
    TESSERA_TRY(scopes.number("camera_angle_y", lens.angle_y));
    TESSERA_TRY(scopes.number_or_0("k1", lens.distortion.k1));
    TESSERA_TRY(scopes.number_or_0("k2", lens.distortion.k2));
    TESSERA_TRY(scopes.number_or_0("k3", lens.distortion.k3));
    TESSERA_TRY(scopes.number_or_0("k4", lens.distortion.k4));
    TESSERA_TRY(scopes.number_or_0("p1", lens.distortion.p1));
    TESSERA_TRY(scopes.number_or_0("p2", lens.distortion.p2));
    return lens;
}

using Rows = std::array<std::array<double, 4>, 4>;

// Three or four rows of four numbers.
Result<Rows> matrix_of(const FrameJson& json, const std::string& key) {
    Rows rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    if (!json.is_array() || (json.size() != 3 && json.size() != 4))
        return wrong_frame(key + " is not a matrix of 3x4 or 4x4 numbers");
    for (std::size_t i = 0; i < json.size(); ++i) {
        if (!json[i].is_array() || json[i].size() != 4)
            return wrong_frame("row " + std::to_string(i + 1) + " of " + key +
                               " does not have four numbers");
        for (std::size_t j = 0; j < 4; ++j) {
            if (!json[i][j].is_number())
                return wrong_frame(key + " has an element that is not a number, in row " +
                                   std::to_string(i + 1));
            rows[i][j] = json[i][j].get<double>();
        }
    }
    return rows;
}

Status check_last_row(const Rows& m) {
    const auto is_near = [](double x, double y) { return std::abs(x - y) <= 1e-6; };
    if (is_near(m[3][0], 0) && is_near(m[3][1], 0) && is_near(m[3][2], 0) && is_near(m[3][3], 1))
        return {};
    if (is_near(m[0][3], 0) && is_near(m[1][3], 0) && is_near(m[2][3], 0) && is_near(m[3][3], 1))
        return wrong_frame("transform_matrix is transposed: the camera's position is in its last "
                           "row, and should be in its last column");
    return wrong_frame("the last row of transform_matrix is not 0 0 0 1");
}

std::string short_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", x);
    return text;
}

// Makes exact what is a rotation but for rounding.
Result<glm::dmat3> rotation_of(const glm::dmat3& m) {
    const glm::dvec3 lengths(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
    const double mean = (lengths.x + lengths.y + lengths.z) / 3;
    if (!(mean > 1e-12 && mean < 1e12))
        return wrong_frame("transform_matrix has axes of length " + short_number(mean));
    const bool is_even = glm::length(lengths - glm::dvec3(mean)) <= most_skew * mean;
    const double angles = std::max({std::abs(glm::dot(m[0], m[1])), std::abs(glm::dot(m[0], m[2])),
                                    std::abs(glm::dot(m[1], m[2]))}) /
                          (mean * mean);
    if (!is_even || angles > 2 * most_skew)
        return wrong_frame("transform_matrix is skewed or scales its axes differently; a camera "
                           "needs a rotation");
    if (glm::determinant(m) < 0)
        return wrong_frame("transform_matrix mirrors: its determinant is negative; exchange or "
                           "negate one of its axes, as the camera's program did");
    if (std::abs(mean - 1) > most_skew)
        return wrong_frame("transform_matrix scales by " + short_number(mean) +
                           "; a camera needs a rotation");
    const glm::dvec3 x = glm::normalize(m[0]);
    const glm::dvec3 y = glm::normalize(m[1] - x * glm::dot(x, m[1]));
    return glm::dmat3(x, y, glm::cross(x, y));
}

// The pose of OpenGL's camera, which looks along -z with y upwards.
Status take_pose(const FrameJson& frame, StatedFrame& out) {
    const auto it = frame.find("transform_matrix");
    if (it == frame.end())
        return wrong_frame("has no transform_matrix");
    TESSERA_TRY_ASSIGN(const Rows m, matrix_of(*it, "transform_matrix"));
    TESSERA_TRY(check_last_row(m));
    glm::dmat3 turn;
    for (glm::length_t column = 0; column < 3; ++column)
        for (glm::length_t row = 0; row < 3; ++row)
            turn[column][row] = m[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    TESSERA_TRY_ASSIGN(turn, rotation_of(turn));
    out.axes = glm::dmat3(turn[0], -turn[1], -turn[2]);
    out.eye = {m[0][3], m[1][3], m[2][3]};
    return {};
}

// A path in the file, relative to its folder. Windows programs write backslashes.
Result<std::string> path_at(const FrameJson& frame, const char* key) {
    const auto it = frame.find(key);
    if (it == frame.end() || !it->is_string())
        return wrong_frame(std::string("has no ") + key);
    std::string path = it->get<std::string>();
    if (path.empty() || path.size() > 4096 || path.find('\0') != std::string::npos)
        return wrong_frame(std::string(key) + " is not a path");
    std::ranges::replace(path, '\\', '/');
    return path;
}

Status take_frame(const FrameJson& json, const FrameJson& file, const std::string& folder,
                  StatedFrame& frame) {
    TESSERA_TRY_ASSIGN(frame.lens, stated_lens({json, file}));
    TESSERA_TRY(take_pose(json, frame));
    if (const auto mask = json.find("mask_path"); mask != json.end() && !mask->is_null()) {
        TESSERA_TRY_ASSIGN(const std::string name, path_at(json, "mask_path"));
        frame.mask = (lexical_path(folder) / lexical_path(name)).lexically_normal().string();
    }
    return {};
}

// What nerfstudio did to the cameras before it wrote them.
Status note_transformations(const FrameJson& file, const std::string& path,
                            std::vector<PhotographNote>& notes) {
    const Scopes scopes{file, file};
    std::optional<double> scale;
    TESSERA_TRY(scopes.number("applied_scale", scale));
    bool is_moved = scale.value_or(1.0) != 1.0;
    if (const FrameJson* applied = scopes.find("applied_transform")) {
        TESSERA_TRY_ASSIGN(const Rows m, matrix_of(*applied, "applied_transform"));
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 4; ++j)
                is_moved = is_moved || m[i][j] != (i == j ? 1.0 : 0.0);
    }
    if (is_moved)
        notes.push_back({"the cameras were transformed (applied_transform); a mesh must be in the "
                         "frame of the transformed cameras",
                         path});
    return {};
}

Result<StatedFrames> frames_of(const FrameJson& file, const std::string& path) {
    const auto list = file.find("frames");
    if (list == file.end() || !list->is_array())
        return wrong_frame("has no list of frames").with_context(path);
    TESSERA_TRY(check_frame_count(list->size()).with_context(path));
    StatedFrames stated;
    stated.folders.push_back(folder_of(path));
    TESSERA_TRY(note_transformations(file, path, stated.notes).with_context(path));
    for (const FrameJson& json : *list) {
        const std::string number = std::to_string(stated.frames.size());
        if (!json.is_object())
            return wrong_frame("frames[" + number + "] is not an object").with_context(path);
        StatedFrame frame;
        TESSERA_TRY_ASSIGN(
            frame.name, path_at(json, "file_path").with_context(path + ": frames[" + number + "]"));
        TESSERA_TRY(take_frame(json, file, stated.folders.front(), frame)
                        .with_context(frame_context(path, frame.name)));
        stated.frames.push_back(std::move(frame));
    }
    return stated;
}

} // namespace

Result<StatedFrames> read_transforms_json(const std::string& path) {
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_transform_bytes));
    TESSERA_TRY_ASSIGN(const FrameJson json, parse_transforms(text_of(bytes)).with_context(path));
    return frames_of(json, path);
}

} // namespace tessera::corpus
