// Photographs with known cameras: which pictures there are, how their lenses draw, and their pixels.
//
// The readers expect hostile files, like those of corpus/picture_file.h.
#pragma once

#include "corpus/photographs/photo_camera.h"
#include "corpus/picture_file.h"
#include "format/status.h"

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::corpus {

inline constexpr std::size_t most_photographs = 100'000;

struct PosedPhotograph {
    std::string name;      // as the frame states it, "./train/r_0"; for messages and output files
    std::string path;      // of the picture
    std::string mask_path; // of a picture that is black where pixels do not count; empty: none
    PhotoCamera camera;    // describes the picture as read_photograph() returns it
    Exif exif = Exif::ignored; // whether the camera describes the picture as EXIF turns it
};

struct PhotographOptions {
    // The folder of the pictures; empty: where the description says they are.
    std::string images = {};
    // A folder with masks as COLMAP's mask_path: that of r_0.png is r_0.png.png. They replace those
    // that the description states. Empty: only those.
    std::string masks = {};
    // Without pictures, only those are opened whose cameras state no size. Frames whose pictures are
    // missing stay.
    bool with_pictures = true;
};

// Something that a user should know about a set of photographs.
struct PhotographNote {
    std::string kind;        // "the picture is missing, so its photograph is left out"
    std::string place;       // the first file or frame of which that is true
    std::uint64_t count = 1; // of how many it is true
};

struct PhotographSet {
    std::vector<PosedPhotograph> photographs; // in the order of the description; at least one
    // Missing, surplus, repeated, scaled and turned pictures, missing masks, and transformations of
    // the world that the description states.
    std::vector<PhotographNote> notes;
};

// Reads which photographs there are. `path` is a transforms.json of NeRF-synthetic, instant-ngp or
// nerfstudio, a COLMAP model (a folder with cameras and images, .bin or .txt), or a folder with a
// transforms.json, sparse/0 or sparse. Opens each picture to compare its size with the camera. The
// camera of a picture that was uniformly scaled, as those of nerfstudio's images_4, is scaled with
// it. Cameras describe pictures as they are stored. Where only the picture that EXIF turns has the
// camera's size, they describe that.
//
// The world's frame is that of the file and is never changed.
//
// Errors name the file and the frame: io, bad_argument (no description in the folder, no picture
// exists, no mask in options.masks), invalid_file (damaged; no frames; numbers that are not finite
// or not positive; matrices that mirror, scale or skew, or are transposed; a size that the picture
// does not have; a distortion that folds the picture), unsupported (fisheye lenses, other camera
// models of COLMAP, rolling shutters, too large pictures, more than most_photographs frames).
Result<PhotographSet> read_photographs(const std::string& path,
                                       const PhotographOptions& options = {});

// Whether `path` is a description for read_photographs(): a .json file, or a folder that has one.
bool is_photograph_set(const std::string& path);

// Whether files with this suffix, such as ".png", are pictures that a set may have.
bool is_picture_suffix(std::string_view suffix);

// Short names of photographs for outputs and tables, all different: paths below the folder that the
// frames share, without suffixes: "r_0", or "left/0001". None of them leaves that folder.
std::vector<std::string> names_of(std::span<const PosedPhotograph> photographs);

struct PhotoPixels {
    std::uint32_t width = 0, height = 0; // those of the camera
    // Red, green, blue as displayed (sRGB, 0..1; not multiplied by alpha), and a weight of 0..1.
    // Rows from the top.
    std::vector<std::array<float, 4>> texels;
};

// Reads the pixels of a photograph. Linear light, as that of EXR, becomes display values. The weight
// is the picture's alpha times the mask. With a `background`, in display values, colours are mixed
// with it by alpha, and the weight is the mask alone. Thread-safe. Errors name the file: those of
// open_picture_file(), unsupported (above 2^14 pixels a side or 2^26 in all), and invalid_file (a
// picture or mask that does not have the camera's size).
Result<PhotoPixels> read_photograph(const PosedPhotograph& photograph,
                                    const std::optional<glm::dvec3>& background = std::nullopt);

} // namespace tessera::corpus
