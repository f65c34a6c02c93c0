#include "corpus/photographs/stated_frames.h"
#include "corpus/picture/picture_readers.h"

#include <algorithm>
#include <map>
#include <set>

namespace tessera::corpus {
namespace {

namespace fs = std::filesystem;

constexpr const char* is_missing = "the picture is missing, so its photograph is left out";
constexpr const char* is_repeated = "a frame repeats the picture of another one and is left out";
constexpr const char* is_scaled =
    "the picture is a scaled one of the size that the camera states, so the camera is scaled, too";
constexpr const char* is_turned = "the picture has the camera's size only when it is turned as its "
                                  "EXIF metadata states, so it is";
constexpr const char* has_no_mask = "a photograph has no mask, so all of its pixels count";
constexpr const char* is_surplus = "the picture belongs to no frame";

constexpr std::array picture_suffixes = {".png", ".jpg", ".jpeg", ".exr", ".webp", ".tif", ".tiff"};

// Counts what happened by kind, and keeps the first place of each.
class NoteCounts {
public:
    void add(const char* kind, const std::string& place) {
        const auto [entry, is_new] = notes_.try_emplace(kind, PhotographNote{kind, place, 0});
        ++entry->second.count;
    }
    void append_to(std::vector<PhotographNote>& notes) const {
        for (const auto& [kind, note] : notes_)
            notes.push_back(note);
    }

private:
    std::map<std::string, PhotographNote> notes_;
};

// The picture of a frame, or the place where it should be. NeRF-synthetic leaves out ".png".
fs::path picture_of(const std::string& name, const StatedFrames& stated,
                    const PhotographOptions& options) {
    std::vector<fs::path> places;
    if (options.images.empty()) {
        for (const std::string& folder : stated.folders)
            places.push_back(lexical_path(folder) / lexical_path(name));
    } else {
        places.push_back(lexical_path(options.images) / lexical_path(name));
        places.push_back(lexical_path(options.images) / lexical_path(name).filename());
    }
    for (const fs::path& place : places) {
        if (is_file(place))
            return place.lexically_normal();
        for (const char* suffix : picture_suffixes)
            if (const fs::path with_suffix = lexical_path(place.string() + suffix);
                is_file(with_suffix))
                return with_suffix.lexically_normal();
    }
    return places.front().lexically_normal();
}

// Where COLMAP looks for the mask of a picture, or the same without the folders of its name.
fs::path mask_of(const PosedPhotograph& photograph, const std::string& folder) {
    const fs::path file = lexical_path(lexical_path(photograph.path).filename().string() + ".png");
    const fs::path place =
        lexical_path(folder) / lexical_path(photograph.name).parent_path() / file;
    const fs::path beside = lexical_path(folder) / file;
    return (!is_file(place) && is_file(beside) ? beside : place).lexically_normal();
}

// Gives the photographs the masks of the folder.
Status take_masks(const std::string& folder, PhotographSet& set, NoteCounts& notes) {
    bool any = false;
    for (PosedPhotograph& photograph : set.photographs) {
        const std::string mask = mask_of(photograph, folder).string();
        if (is_file(mask)) {
            photograph.mask_path = mask;
            any = true;
        } else if (photograph.mask_path.empty()) {
            notes.add(has_no_mask, mask);
        }
    }
    if (!any)
        return {ErrorCode::bad_argument, folder + ": has no mask of any photograph, such as " +
                                             mask_of(set.photographs.front(), folder).string()};
    return {};
}

Result<PictureShape> shape_of_picture(const std::string& path, Exif exif) {
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    TESSERA_TRY_ASSIGN(const auto picture, open_picture_file(*file, {.exif = exif}));
    const PictureShape& shape = picture->shape();
    TESSERA_TRY(check_size(shape.width, shape.height).with_context(path));
    return shape;
}

enum class SizeMatch { equal, scaled, none };

// A scaled picture may have been rounded by a pixel.
SizeMatch match_sizes(const PictureShape& picture, std::uint32_t width, std::uint32_t height) {
    if (picture.width == width && picture.height == height)
        return SizeMatch::equal;
    const auto across = static_cast<double>(picture.width) * height;
    const auto down = static_cast<double>(picture.height) * width;
    return std::abs(across - down) <= std::max(width, height) ? SizeMatch::scaled : SizeMatch::none;
}

std::string size_text(std::uint32_t width, std::uint32_t height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

// Compares the picture's size with the camera's, which may be scaled or describe the turned picture.
Status fit_to_picture(PosedPhotograph& photograph, const PictureShape& stored, NoteCounts& notes) {
    PhotoCamera& camera = photograph.camera;
    if (match_sizes(stored, camera.width, camera.height) == SizeMatch::equal)
        return {};
    TESSERA_TRY_ASSIGN(const PictureShape turned,
                       shape_of_picture(photograph.path, Exif::followed));
    const bool has_turn = turned.width != stored.width;
    for (const SizeMatch wanted : {SizeMatch::equal, SizeMatch::scaled})
        for (const bool turn : {false, true}) {
            const PictureShape& shape = turn ? turned : stored;
            if ((turn && !has_turn) || match_sizes(shape, camera.width, camera.height) != wanted)
                continue;
            if (turn) {
                photograph.exif = Exif::followed;
                notes.add(is_turned, photograph.path);
            }
            if (wanted == SizeMatch::scaled) {
                camera = camera.resized(shape.width, shape.height);
                notes.add(is_scaled, photograph.path);
            }
            return {};
        }
    return {ErrorCode::invalid_file, "its camera is for a picture of " +
                                         size_text(camera.width, camera.height) + " pixels, but " +
                                         photograph.path + " has " +
                                         size_text(stored.width, stored.height)};
}

Status pose_photograph(const StatedFrame& frame, bool with_pictures, PosedPhotograph& photograph,
                       NoteCounts& notes) {
    const bool has_size = frame.lens.width && frame.lens.height;
    std::optional<PictureShape> shape;
    if (is_file(photograph.path) && (with_pictures || !has_size)) {
        TESSERA_TRY_ASSIGN(shape, shape_of_picture(photograph.path, Exif::ignored));
    }
    std::optional<std::uint32_t> width, height;
    if (shape) {
        width = shape->width;
        height = shape->height;
    }
    TESSERA_TRY_ASSIGN(photograph.camera, camera_of(frame, width, height));
    if (shape)
        TESSERA_TRY(fit_to_picture(photograph, *shape, notes));
    if (with_pictures && !photograph.mask_path.empty() && !is_file(photograph.mask_path))
        return {ErrorCode::io, "its mask " + photograph.mask_path + " is missing"};
    return {};
}

// Counts the pictures in the folders of the photographs that belong to none of them.
void note_surplus(const PhotographSet& set, NoteCounts& notes) {
    std::set<std::string> known, folders;
    for (const PosedPhotograph& photograph : set.photographs) {
        known.insert(photograph.path);
        known.insert(photograph.mask_path);
        folders.insert(lexical_path(photograph.path).parent_path().string());
    }
    std::set<std::string> surplus; // sorted, so that the first one does not depend on the disk
    for (const std::string& folder : folders) {
        std::error_code ignored;
        for (const std::string& name : names_in(folder.empty() ? "." : folder, ignored)) {
            const fs::path path = (lexical_path(folder) / lexical_path(name)).lexically_normal();
            const std::string suffix = path.extension().string();
            if (is_picture_suffix(suffix) && !known.contains(path.string()))
                surplus.insert(path.string());
        }
    }
    for (const std::string& path : surplus)
        notes.add(is_surplus, path);
}

} // namespace

bool is_picture_suffix(std::string_view suffix) {
    return std::ranges::find(picture_suffixes, suffix) != picture_suffixes.end();
}

Result<PhotographSet> find_pictures(const std::string& path, StatedFrames stated,
                                    const PhotographOptions& options) {
    PhotographSet set;
    NoteCounts notes;
    std::set<std::string> seen;
    std::string first_missing;
    for (const StatedFrame& frame : stated.frames) {
        PosedPhotograph photograph;
        photograph.name = frame.name;
        photograph.path = picture_of(frame.name, stated, options).string();
        photograph.mask_path = frame.mask;
        const bool exists = is_file(photograph.path);
        if (!exists && first_missing.empty())
            first_missing = photograph.path;
        if (!seen.insert(photograph.path).second) {
            notes.add(is_repeated, photograph.path);
            continue;
        }
        if (!exists && options.with_pictures) {
            notes.add(is_missing, photograph.path);
            continue;
        }
        TESSERA_TRY(pose_photograph(frame, options.with_pictures, photograph, notes)
                        .with_context(frame_context(path, frame.name)));
        set.photographs.push_back(std::move(photograph));
    }
    if (set.photographs.empty())
        return Status(ErrorCode::bad_argument, path + ": none of its " +
                                                   std::to_string(stated.frames.size()) +
                                                   " pictures exists, such as " + first_missing +
                                                   "; --images names their folder");
    if (!options.masks.empty())
        TESSERA_TRY(take_masks(options.masks, set, notes));
    if (options.with_pictures)
        note_surplus(set, notes);
    set.notes = std::move(stated.notes);
    notes.append_to(set.notes);
    return set;
}

} // namespace tessera::corpus
