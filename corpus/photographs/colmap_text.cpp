#include "corpus/model/obj_text.h"
#include "corpus/model/readers.h"
#include "corpus/photographs/colmap_files.h"

namespace tessera::corpus {
namespace {

constexpr std::size_t most_colmap_text = std::size_t{1} << 30;

bool is_comment(std::string_view line) {
    return trimmed(line).starts_with('#');
}

// Calls take(lines, line) for each line that is no comment. Blank lines count in images.txt.
template <class Take> Status each_line(const std::string& path, const Take& take) {
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_colmap_text));
    LineReader lines(text_of(bytes));
    while (!lines.at_end())
        if (const std::string_view line = lines.next(); !is_comment(line))
            TESSERA_TRY(take(lines, line).with_context(path));
    return {};
}

template <class Number>
Status take_colmap_number(const LineReader& lines, std::string_view& line, const char* what,
                          Number& out) {
    const std::string_view word = take_word(line);
    if (!parse_word(word, out))
        return wrong_line(lines, std::string(what) + " is not a number: " + in_quotes(word));
    return {};
}

} // namespace

Result<ColmapCameras> read_colmap_cameras_text(const std::string& path) {
    ColmapCameras cameras;
    TESSERA_TRY(each_line(path, [&](const LineReader& lines, std::string_view line) -> Status {
        if (trimmed(line).empty())
            return {};
        TESSERA_TRY(check_frame_count(cameras.size() + 1));
        std::uint32_t id = 0;
        ColmapCamera camera;
        TESSERA_TRY(take_colmap_number(lines, line, "the camera's id", id));
        TESSERA_TRY_ASSIGN(
            camera.lens,
            colmap_lens(take_word(line)).with_context("line " + std::to_string(lines.number())));
        TESSERA_TRY(take_colmap_number(lines, line, "the width", camera.width));
        TESSERA_TRY(take_colmap_number(lines, line, "the height", camera.height));
        camera.parameters.resize(camera.lens.parameters);
        for (double& parameter : camera.parameters)
            TESSERA_TRY(take_colmap_number(lines, line, "a parameter of the camera", parameter));
        if (!trimmed(line).empty())
            return wrong_line(lines, "a camera " + std::string(camera.lens.name) + " has only " +
                                         std::to_string(camera.lens.parameters) + " parameters");
        if (!cameras.emplace(id, std::move(camera)).second)
            return wrong_line(lines, "camera " + std::to_string(id) + " exists twice");
        return {};
    }));
    return cameras;
}

// Each image has two lines. The second one lists its points and may be empty.
Result<std::vector<ColmapImage>> read_colmap_images_text(const std::string& path) {
    std::vector<ColmapImage> images;
    bool is_points = false;
    TESSERA_TRY(each_line(path, [&](const LineReader& lines, std::string_view line) -> Status {
        if (is_points || (images.empty() && trimmed(line).empty())) {
            is_points = false;
            return {};
        }
        if (trimmed(line).empty()) // at the end of the file
            return {};
        TESSERA_TRY(check_frame_count(images.size() + 1));
        std::uint32_t id = 0;
        ColmapImage image;
        TESSERA_TRY(take_colmap_number(lines, line, "the image's id", id));
        for (double& part : image.rotation)
            TESSERA_TRY(take_colmap_number(lines, line, "the image's rotation", part));
        for (glm::length_t axis = 0; axis < 3; ++axis)
            TESSERA_TRY(
                take_colmap_number(lines, line, "the image's translation", image.shift[axis]));
        TESSERA_TRY(take_colmap_number(lines, line, "the image's camera", image.camera));
        image.name = trimmed(line);
        if (image.name.empty())
            return wrong_line(lines, "the image has no name");
        images.push_back(std::move(image));
        is_points = true;
        return {};
    }));
    return images;
}

} // namespace tessera::corpus
