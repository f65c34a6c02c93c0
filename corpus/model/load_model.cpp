#include "corpus/model/readers.h"

#include "format/byte_source.h"
#include "format/output_file.h"

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

using Reader = Status (*)(const std::string& path, ModelBuilder& builder);

// The reader for files of this name; null for other kinds.
Reader reader_of(const std::string& path) {
    const std::string suffix = suffix_of(path);
    return suffix == "gltf" || suffix == "glb" ? read_gltf
           : suffix == "obj"                   ? read_obj
           : suffix == "ply"                   ? read_ply
           : suffix == "stl"                   ? read_stl
                                               : nullptr;
}

Result<Model> load(const std::string& path) {
    ModelBuilder builder;
    TESSERA_TRY(reader_of(path)(path, builder));
    return std::move(builder).finish();
}

} // namespace

Result<std::vector<unsigned char>> read_whole_file(const std::string& path, std::size_t most) {
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    if (file->size() > most)
        return Status(ErrorCode::unsupported,
                      path + ": more than " + std::to_string(most) + " bytes");
    std::vector<unsigned char> bytes(file->size());
    TESSERA_TRY(file->read(0, std::as_writable_bytes(std::span(bytes))));
    return bytes;
}

Status check_is_model(const std::vector<unsigned char>& bytes) {
    const std::string kind = known_kind(std::as_bytes(std::span(bytes)));
    if (kind.empty() || kind == "a binary glTF model")
        return {};
    return {ErrorCode::invalid_file, "not a model, but " + kind};
}

bool is_model_path(const std::string& path) {
    return reader_of(path) != nullptr;
}

std::string folder_of(const std::string& path) {
    const std::string folder = lexical_path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

Result<Model> load_model(const std::string& path) {
    if (!is_model_path(path))
        return Status(ErrorCode::bad_argument, path + ": not a .gltf, .glb, .obj, .ply or .stl");
    // The libraries throw exceptions.
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
