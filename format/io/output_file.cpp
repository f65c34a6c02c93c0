#include "format/output_file.h"

#include "format/io/system_calls.h"
#include "format/io/unfinished.h"

#include <cerrno>
#include <utility>

namespace tessera {

namespace {

using sys::system_error;

// Checked before any work is done: renaming to a directory would fail at the end, and renaming to a
// device would replace it.
Status check_target(const std::string& path) {
    using Kind = sys::FileFacts::Kind;
    sys::FileFacts facts;
    if (sys::facts_of(path, facts) != 0)
        return {};
    if (facts.kind != Kind::file)
        return {ErrorCode::io,
                path + ": cannot write: it is " +
                    (facts.kind == Kind::folder ? "a directory" : "not a regular file")};
    if (facts.read_only) // the rename would replace it nevertheless
        return {ErrorCode::io, path + ": cannot write: the file is read-only"};
    return {};
}

} // namespace

OutputFile::OutputFile(OutputFile&& other) noexcept {
    *this = std::move(other);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
    if (this != &other) {
        discard();
        path_ = std::move(other.path_);
        target_ = std::move(other.target_);
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
    sys::drop(std::exchange(descriptor_, -1));
    sys::remove_file(temporary_);
    forget_unfinished(temporary_);
}

Result<OutputFile> OutputFile::create(const std::string& path) {
    TESSERA_TRY(check_target(path));
    TESSERA_TRY_ASSIGN(const std::string target, output_target(path));
    // A killed run may have left its temporary file, and process numbers are reused.
    constexpr int attempts = 100;
    const auto held = hold_unfinished(); // no file may exist without being noted
    for (int attempt = 0; attempt < attempts; ++attempt) {
        OutputFile file;
        file.path_ = path;
        file.target_ = target;
        file.temporary_ = target + "." + std::to_string(sys::process_id());
        if (attempt > 0)
            file.temporary_.append("-").append(std::to_string(attempt));
        file.temporary_ += ".tmp";
        file.descriptor_ = sys::open(file.temporary_, sys::Access::create);
        if (file.descriptor_ >= 0) {
            note_unfinished(file.temporary_);
            sys::keep_mode_and_owner(file.descriptor_, target);
            return file;
        }
        if (errno != EEXIST)
            return system_error(path, "cannot create " + file.temporary_, errno);
    }
    return system_error(path, "cannot create a temporary file beside it", EEXIST);
}

Result<OutputFile> OutputFile::create(const std::string& path, const std::string& temporary) {
    TESSERA_TRY(check_target(path));
    TESSERA_TRY_ASSIGN(const std::string target, output_target(path));
    if (target != path) // perhaps on another file system
        return create(path);
    OutputFile file;
    file.path_ = path;
    file.target_ = target;
    file.temporary_ = temporary;
    sys::remove_file(temporary);
    const auto held = hold_unfinished();
    file.descriptor_ = sys::open(temporary, sys::Access::create);
    if (file.descriptor_ < 0)
        return system_error(path, "cannot create " + temporary, errno);
    note_unfinished(temporary);
    sys::keep_mode_and_owner(file.descriptor_, target);
    return file;
}

Status OutputFile::append(std::span<const std::byte> bytes) {
    TESSERA_TRY(write_at(appended_, bytes));
    appended_ += bytes.size();
    return {};
}

Status OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    if (descriptor_ < 0)
        return {ErrorCode::io, path_ + ": cannot write: the file is not open"};
    return sys::write_all(descriptor_, path_, bytes, offset);
}

Status OutputFile::commit() {
    if (descriptor_ < 0)
        return {ErrorCode::io, path_ + ": cannot finish: the file is not open"};
    if (sys::sync(descriptor_) < 0) {
        const int error = errno;
        discard();
        return system_error(path_, "cannot write to the disk", error);
    }
    std::string what = "cannot finish " + temporary_;
    // Some file systems report a failed write only here.
    int error = sys::close(std::exchange(descriptor_, -1)) < 0 ? errno : 0;
    const auto held = hold_unfinished();
    if (error == 0 && sys::rename(temporary_, target_) < 0) {
        error = errno;
        what = "cannot rename " + temporary_ + " to it";
    }
    forget_unfinished(temporary_);
    if (error == 0)
        return {};
    sys::remove_file(temporary_);
    return system_error(path_, what, error);
}

} // namespace tessera
