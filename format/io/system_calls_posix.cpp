#include "format/io/system_calls.h"
#include "format/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace tessera::sys {

namespace {

template <class Work> auto repeat_interrupted(const Work& work) {
    auto result = work();
    while (result < 0 && errno == EINTR)
        result = work();
    return result;
}

int flags_of(Access access) {
    switch (access) {
    case Access::read:
        return O_RDONLY | O_NONBLOCK;
    case Access::read_no_link:
        return O_RDONLY | O_NOFOLLOW;
    case Access::create:
        return O_WRONLY | O_CREAT | O_EXCL;
    case Access::update:
        return O_RDWR | O_CREAT | O_NOFOLLOW;
    }
    return O_RDONLY;
}

void set_facts(const struct stat& info, FileFacts& facts) {
    using Kind = FileFacts::Kind;
    facts.kind = S_ISREG(info.st_mode)   ? Kind::file
                 : S_ISDIR(info.st_mode) ? Kind::folder
                                         : Kind::other;
    facts.size = static_cast<std::uint64_t>(info.st_size);
    facts.device = static_cast<std::uint64_t>(info.st_dev);
    facts.number = static_cast<std::uint64_t>(info.st_ino);
#ifdef __APPLE__
    facts.seconds = info.st_mtimespec.tv_sec;
    facts.nanoseconds = info.st_mtimespec.tv_nsec;
#else
    facts.seconds = info.st_mtim.tv_sec;
    facts.nanoseconds = info.st_mtim.tv_nsec;
#endif
}

} // namespace

int open(const std::string& path, Access access) {
    const bool writes = access == Access::create || access == Access::update;
    if (writes && is_made_to_fail(Call::open))
        return -1;
    return repeat_interrupted(
        [&] { return ::open(path.c_str(), flags_of(access) | O_CLOEXEC, 0666); });
}

int close(int descriptor) {
    const int result = ::close(descriptor); // Linux closes the file even if it reports EINTR
    return is_made_to_fail(Call::close) ? -1 : result < 0 && errno == EINTR ? 0 : result;
}

void drop(int descriptor) {
    ::close(descriptor);
}

std::int64_t read_at(int descriptor, std::span<std::byte> out, std::uint64_t offset) {
    return repeat_interrupted(
        [&] { return ::pread(descriptor, out.data(), out.size(), static_cast<off_t>(offset)); });
}

std::int64_t write_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t offset) {
    if (is_made_to_fail(Call::write))
        return -1;
    return repeat_interrupted([&] {
        return ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    });
}

int truncate(int descriptor, std::uint64_t length) {
    if (is_made_to_fail(Call::truncate))
        return -1;
    return repeat_interrupted([&] { return ::ftruncate(descriptor, static_cast<off_t>(length)); });
}

int sync(int descriptor) {
    if (is_made_to_fail(Call::sync))
        return -1;
    return repeat_interrupted([&] { return ::fsync(descriptor); });
}

int rename(const std::string& from, const std::string& to) {
    return is_made_to_fail(Call::rename) ? -1 : ::rename(from.c_str(), to.c_str());
}

int make_folder(const std::string& path) {
    return is_made_to_fail(Call::make_folder) ? -1 : ::mkdir(path.c_str(), 0777);
}

int remove_file(const std::string& path) {
    return ::unlink(path.c_str());
}

int remove_empty_folder(const std::string& path) {
    return ::rmdir(path.c_str());
}

int list_folder(const std::string& path, std::vector<std::string>& names) {
    std::error_code error;
    names.clear();
    for (std::filesystem::directory_iterator i(path, error), end; !error && i != end;
         i.increment(error))
        names.push_back(i->path().filename().string());
    errno = error.value();
    return error ? -1 : 0;
}

int remove_tree(const std::string& path) {
    std::error_code error;
    std::filesystem::remove_all(path, error);
    errno = error.value();
    return error ? -1 : 0;
}

int facts_of(int descriptor, FileFacts& facts) {
    struct stat info = {};
    if (::fstat(descriptor, &info) < 0)
        return -1;
    set_facts(info, facts);
    return 0;
}

int facts_of(const std::string& path, FileFacts& facts) {
    struct stat info = {};
    if (::stat(path.c_str(), &info) < 0)
        return -1;
    set_facts(info, facts);
    // Root may write everything, but the mode says what is meant.
    facts.read_only = (info.st_mode & 0222) == 0 || ::access(path.c_str(), W_OK) != 0;
    return 0;
}

bool is_other_than_folder(const std::string& path) {
    struct stat info = {};
    return ::lstat(path.c_str(), &info) == 0 && !S_ISDIR(info.st_mode);
}

Lock lock(int descriptor) {
    if (repeat_interrupted([&] { return ::flock(descriptor, LOCK_EX | LOCK_NB); }) == 0)
        return Lock::taken;
    return errno == EWOULDBLOCK ? Lock::held_by_another : Lock::failed;
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

void keep_mode_and_owner(const std::string& folder, const std::string& target) {
    if (const int own = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); own >= 0) {
        keep_mode_and_owner(own, target);
        ::close(own);
    }
}

std::uint64_t process_id() {
    return static_cast<std::uint64_t>(::getpid());
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

} // namespace tessera::sys

namespace tessera {

std::filesystem::path to_path(const std::string& utf8) {
    return utf8;
}

} // namespace tessera
