#include "format/io/system_calls.h"
#include "format/io/unfinished.h"
#include "format/output_file.h"

#include <cerrno>
#include <filesystem>
#include <utility>

namespace tessera {

namespace fs = std::filesystem;

namespace {

std::string beside(const std::string& path, const char* suffix) {
    return path + "." + std::to_string(sys::process_id()) + suffix;
}

} // namespace

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : path_(std::move(other.path_)), target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})) {}

OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept {
    if (this != &other) {
        discard();
        path_ = std::move(other.path_);
        target_ = std::move(other.target_);
        temporary_ = std::exchange(other.temporary_, {});
    }
    return *this;
}

OutputFolder::~OutputFolder() {
    discard();
}

void OutputFolder::discard() {
    if (temporary_.empty())
        return;
    sys::remove_tree(temporary_);
    forget_unfinished(temporary_);
    temporary_.clear();
}

Result<OutputFolder> OutputFolder::create(const std::string& path) {
    OutputFolder folder;
    TESSERA_TRY_ASSIGN(folder.target_, output_target(path));
    const std::string temporary = beside(folder.target_, ".tmp");
    const auto held = hold_unfinished(); // no folder may exist without being noted
    if (sys::make_folder(temporary) < 0)
        return sys::system_error(path, "cannot create " + temporary, errno);
    note_unfinished(temporary);
    folder.path_ = path;
    folder.temporary_ = temporary;
    return folder;
}

Status OutputFolder::add(const std::string& name, std::span<const std::byte> bytes) const {
    const std::string path = temporary_ + "/" + name;
    const int file = sys::open(path, sys::Access::create);
    if (file < 0)
        return sys::system_error(path, "cannot create", errno);
    sys::keep_mode_and_owner(file, target_ + "/" + name);
    Status status = sys::write_all(file, path, bytes, 0);
    if (sys::close(file) < 0 && status.ok())
        status = sys::system_error(path, "cannot write", errno);
    return status;
}

Status OutputFolder::commit() {
    std::error_code ignored;
    const std::string old = beside(target_, ".old");
    const bool replacing = fs::exists(to_path(target_), ignored);
    sys::keep_mode_and_owner(temporary_, target_);
    const auto held = hold_unfinished(); // between the two renames no folder has the final name
    if (replacing && sys::rename(target_, old) < 0)
        return sys::system_error(path_, "cannot rename it to " + old, errno);
    if (sys::rename(temporary_, target_) < 0) {
        const int error = errno;
        if (replacing) // not sys::rename(), which tests make fail: this undoes the first rename
            fs::rename(to_path(old), to_path(target_), ignored);
        return sys::system_error(path_, "cannot rename " + temporary_ + " to it", error);
    }
    forget_unfinished(temporary_);
    temporary_.clear();
    if (replacing)
        sys::remove_tree(old);
    return {};
}

} // namespace tessera
