#include "format/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace tessera {

namespace {

Status system_error(const std::string& path, const std::string& what, int error) {
    return {ErrorCode::io, path + ": " + what + ": " + std::generic_category().message(error)};
}

} // namespace

OutputFile::OutputFile(OutputFile&& other) noexcept {
    *this = std::move(other);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
    if (this != &other) {
        discard();
        path_ = std::move(other.path_);
        temporary_ = std::move(other.temporary_);
        descriptor_ = std::exchange(other.descriptor_, -1);
        appended_ = std::exchange(other.appended_, 0);
    }
    return *this;
}

OutputFile::~OutputFile() {
    discard();
}

void OutputFile::discard() {
    if (descriptor_ < 0)
        return;
    ::close(std::exchange(descriptor_, -1));
    ::unlink(temporary_.c_str());
}

Result<OutputFile> OutputFile::create(const std::string& path) {
    // Renaming over a directory fails only after all the work, and over a device replaces it.
    struct stat info = {};
    if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode))
        return Status(ErrorCode::io,
                      path + ": cannot write: it is " +
                          (S_ISDIR(info.st_mode) ? "a directory" : "not a regular file"));
    // A killed run may have left its temporary file, and process numbers come again.
    constexpr int attempts = 100;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        OutputFile file;
        file.path_ = path;
        file.temporary_ = path + "." + std::to_string(::getpid()) +
                          (attempt > 0 ? "-" + std::to_string(attempt) : "") + ".tmp";
        file.descriptor_ =
            ::open(file.temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file.descriptor_ >= 0)
            return file;
        if (errno != EEXIST)
            return system_error(path, "cannot create " + file.temporary_, errno);
    }
    return system_error(path, "cannot create a temporary file beside it", EEXIST);
}

Status OutputFile::append(std::span<const std::byte> bytes) {
    TESSERA_TRY(write_at(appended_, bytes));
    appended_ += bytes.size();
    return {};
}

Status OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    if (descriptor_ < 0)
        return {ErrorCode::io, path_ + ": cannot write: the file is not open"};
    while (!bytes.empty()) {
        const ssize_t put =
            ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR)
            continue;
        if (put <= 0)
            return system_error(path_, "cannot write at offset " + std::to_string(offset),
                                put < 0 ? errno : ENOSPC);
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
    return {};
}

Status OutputFile::commit() {
    if (descriptor_ < 0)
        return {ErrorCode::io, path_ + ": cannot finish: the file is not open"};
    if (::fsync(descriptor_) < 0) {
        const int error = errno;
        discard();
        return system_error(path_, "cannot write to the disk", error);
    }
    // Some file systems report a failed write only here.
    int error = ::close(std::exchange(descriptor_, -1)) < 0 ? errno : 0;
    if (error == 0 && ::rename(temporary_.c_str(), path_.c_str()) < 0)
        error = errno;
    if (error == 0)
        return {};
    ::unlink(temporary_.c_str());
    return system_error(path_, "cannot rename " + temporary_ + " to it", error);
}

} // namespace tessera
