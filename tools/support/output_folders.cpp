#include "tools/support/output_folders.h"

#include "format/output_file.h"
#include "tools/support/parse.h"
#include "tools/support/system.h"
#include "tools/support/url.h"

#include <filesystem>
#include <system_error>

namespace tessera {
namespace {

namespace fs = std::filesystem;

// The folder that contains `path`, which may end in a slash.
fs::path parent_of(const std::string& path) {
    const fs::path whole = to_path(path);
    return whole.has_filename() ? whole.parent_path() : whole.parent_path().parent_path();
}

// Whether a new file of so many bytes fits into a folder that exists.
Status check_folder(const std::string& path, const fs::path& folder, std::uint64_t bytes) {
    const auto cannot = [&](const std::string& why) {
        return Status(ErrorCode::io, path + ": cannot write into " + folder.string() + ": " + why);
    };
    if (const std::string why = why_not_writable(folder); !why.empty())
        return cannot(why);
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    if (error || space.available >= bytes)
        return {};
    return cannot(space.available == 0 ? "the disk is full"
                                       : "the disk has " + human_bytes(space.available) +
                                             " left, and this takes " + human_bytes(bytes));
}

} // namespace

Status check_parent_folders(const std::string& path, std::uint64_t bytes) {
    std::error_code ignored;
    TESSERA_TRY_ASSIGN(const std::string target, output_target(path));
    if (parent_of(target).empty())
        return check_folder(path, ".", bytes);
    // The nearest existing ancestor must be a folder.
    for (fs::path folder = parent_of(target); !folder.empty(); folder = folder.parent_path()) {
        if (fs::is_directory(folder, ignored))
            return check_folder(path, folder, bytes);
        if (fs::exists(fs::symlink_status(folder, ignored)))
            return {ErrorCode::io, path + ": " + folder.string() + " is not a folder"};
        if (folder == folder.parent_path())
            break;
        if (folder.parent_path().empty()) // of a relative path
            return check_folder(path, ".", bytes);
    }
    return {};
}

bool is_glb_name(const std::string& path) {
    return without_query(path).ends_with(".glb");
}

Status check_output_path(const std::string& path) {
    if (is_url(path))
        return {ErrorCode::bad_argument, path + ": cannot write to a URL"};
    if (is_reserved(to_path(path)))
        return {ErrorCode::io, path + ": cannot write: the system reserves this name"};
    TESSERA_TRY(check_parent_folders(path));
    std::error_code ignored;
    const fs::file_status status = fs::status(to_path(path), ignored);
    if (!fs::exists(status))
        return {};
    if (!fs::is_regular_file(status))
        return {ErrorCode::io, path + ": exists and is not a regular file"};
    // Root may write everything, but means no such file.
    constexpr fs::perms any_write =
        fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
    if ((status.permissions() & any_write) == fs::perms::none || !is_writable(to_path(path)))
        return {ErrorCode::io, path + ": cannot write: the file is read-only"};
    return {};
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
