#include "corpus/photographs/stated_frames.h"

#include <algorithm>
#include <vector>

namespace tessera::corpus {
namespace {

namespace fs = std::filesystem;

constexpr const char* model_folders[] = {"", "/sparse/0", "/sparse"}; // below a project's folder

// What is wrong with a folder that is no description, and which files the user may mean.
Status no_description(const std::string& folder) {
    std::string found;
    std::error_code ignored;
    for (const std::string& name : names_in(folder, ignored))
        if (name.starts_with("transforms") && name.ends_with(".json"))
            found = found.empty() || name < found ? name : found;
    const std::string hint =
        found.empty() ? "" : "; name the file that you mean, such as " + folder + "/" + found;
    return {ErrorCode::bad_argument,
            folder +
                ": has neither a transforms.json nor a COLMAP model (cameras and images, "
                ".bin or .txt, here, in sparse/0 or in sparse)" +
                hint};
}

Result<StatedFrames> stated_frames_in(const std::string& folder) {
    if (const std::string path = folder + "/transforms.json"; is_file(path))
        return read_transforms_json(path);
    for (const char* below : model_folders)
        if (is_colmap_model(folder + below))
            return read_colmap_model(folder + below);
    return no_description(folder);
}

} // namespace

bool is_photograph_set(const std::string& path) {
    std::error_code none;
    if (!fs::is_directory(to_path(path), none))
        return to_path(path).extension() == ".json";
    return is_file(path + "/transforms.json") ||
           std::ranges::any_of(model_folders,
                               [&](const char* below) { return is_colmap_model(path + below); });
}

Result<PhotographSet> read_photographs(const std::string& path, const PhotographOptions& options) {
    std::error_code none;
    TESSERA_TRY_ASSIGN(StatedFrames stated, fs::is_directory(to_path(path), none)
                                                ? stated_frames_in(path)
                                                : read_transforms_json(path));
    return find_pictures(path, std::move(stated), options);
}

} // namespace tessera::corpus
