#include "corpus/model/readers.h"

#include <algorithm>
#include <exception>
#include <new>

namespace tessera::corpus {
namespace {

std::string suffix_of(const std::string& path) {
    const std::size_t dot = path.find_last_of("./");
    if (dot == std::string::npos || path[dot] != '.')
        return {};
    std::string suffix = path.substr(dot + 1);
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return suffix;
}

bool is_gltf(const std::string& suffix) {
    return suffix == "gltf" || suffix == "glb";
}

Result<Model> load(const std::string& path) {
    const std::string suffix = suffix_of(path);
    ModelBuilder builder;
    TESSERA_TRY(is_gltf(suffix) ? read_gltf(path, builder)
                                : read_with_assimp(path, suffix == "ply", builder));
    return std::move(builder).finish();
}

} // namespace

bool is_model_path(const std::string& path) {
    const std::string suffix = suffix_of(path);
    return is_gltf(suffix) || suffix == "obj" || suffix == "ply";
}

Result<Model> load_model(const std::string& path) {
    if (!is_model_path(path))
        return Status(ErrorCode::bad_argument, path + ": not a .gltf, .glb, .obj or .ply");
    // The libraries throw what they do not expect.
    try {
        Result<Model> model = load(path);
        const bool named = model.status().message().rfind(path, 0) == 0;
        return named ? std::move(model) : std::move(model).with_context(path);
    } catch (const std::bad_alloc&) {
        return Status(ErrorCode::runtime, path + ": out of memory");
    } catch (const std::exception& e) {
        return Status(ErrorCode::invalid_file, path + ": " + e.what());
    }
}

} // namespace tessera::corpus
