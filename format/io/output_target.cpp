#include "format/io/output_target.h"

#include "format/io/system_calls.h"
#include "format/output_file.h"

#include <cerrno>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>

namespace tessera {

namespace fs = std::filesystem;

Result<std::string> output_target(const std::string& path) {
    constexpr int most_links = 40; // as in Linux
    fs::path target = path;
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

void keep_mode_and_owner(int descriptor, const std::string& target) {
    struct stat old = {}, own = {};
    if (::stat(target.c_str(), &old) != 0 || ::fstat(descriptor, &own) != 0)
        return;
    mode_t mode = old.st_mode & 07777;
    if ((old.st_uid != own.st_uid || old.st_gid != own.st_gid) &&
        ::fchown(descriptor, old.st_uid, old.st_gid) != 0 &&
        ::fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) != 0)
        mode &= 0777; // another owner shall not run it under its name
    (void)::fchmod(descriptor, mode);
}

} // namespace tessera
