#include "tools/support/output_folders.h"

#include "format/output_file.h"
#include "tools/support/url.h"

#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// The folder that contains `path`, which may end in a slash.
fs::path parent_of(const std::string& path) {
    const fs::path whole(path);
    return whole.has_filename() ? whole.parent_path() : whole.parent_path().parent_path();
}

} // namespace

Status check_parent_folders(const std::string& path) {
    std::error_code ignored;
    // The nearest existing ancestor must be a folder.
    for (fs::path folder = parent_of(path); !folder.empty(); folder = folder.parent_path()) {
        if (fs::is_directory(folder, ignored))
            return {};
        if (fs::exists(fs::symlink_status(folder, ignored)))
            return {ErrorCode::io, path + ": " + folder.string() + " is not a folder"};
        if (folder == folder.parent_path())
            break;
    }
    return {};
}

Status check_output_path(const std::string& path) {
    if (is_url(path))
        return {ErrorCode::bad_argument, path + ": cannot write to a URL"};
    TESSERA_TRY(check_parent_folders(path));
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (!fs::exists(status) || fs::is_regular_file(status))
        return {};
    return {ErrorCode::io, path + ": exists and is not a regular file"};
}

Status make_parent_folders(const std::string& path) {
    const fs::path folder = parent_of(path);
    if (folder.empty())
        return {};
    std::error_code error;
    fs::create_directories(folder, error);
    return error ? Status(ErrorCode::io,
                          path + ": cannot create " + folder.string() + ": " + error.message())
                 : Status();
}

Status write_bytes(const std::string& path, std::span<const std::byte> bytes) {
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    TESSERA_TRY(file.append(bytes));
    return file.commit();
}

} // namespace tessera
