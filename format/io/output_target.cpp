#include "format/output_file.h"

#include "format/io/system_calls.h"

#include <cerrno>
#include <filesystem>

namespace tessera {

namespace fs = std::filesystem;

Result<std::string> output_target(const std::string& path) {
    constexpr int most_links = 40; // as in Linux
    fs::path target = to_path(path);
    for (int links = 0; links < most_links; ++links) {
        std::error_code error;
        if (fs::symlink_status(target, error).type() != fs::file_type::symlink)
            return target.string();
        const fs::path next = fs::read_symlink(target, error);
        if (error)
            return sys::system_error(path, "cannot follow the link", error.value());
        target = target.parent_path() / next; // an absolute one replaces it
    }
    return sys::system_error(path, "cannot follow the link", ELOOP);
}

std::filesystem::path lexical_path(const std::string& utf8) {
    return std::u8string(utf8.begin(), utf8.end());
}

std::vector<std::string> names_in(const std::string& folder, std::error_code& error) {
    std::vector<std::string> names;
    const bool listed = sys::list_folder(folder, names) == 0;
    error = listed ? std::error_code() : std::error_code(errno, std::generic_category());
    return names;
}

} // namespace tessera
