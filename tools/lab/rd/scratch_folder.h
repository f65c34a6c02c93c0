// A folder for the files that other programs read and write. The destructor deletes it unless it
// was created by keep().
#pragma once

#include "format/status.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

namespace tessera {

class ScratchFolder {
public:
    ScratchFolder(ScratchFolder&& other) noexcept
        : path_(std::exchange(other.path_, "")), kept_(other.kept_) {}
    ScratchFolder& operator=(ScratchFolder&&) = delete;
    ~ScratchFolder() {
        std::error_code ignored;
        if (!path_.empty() && !kept_)
            std::filesystem::remove_all(path_, ignored);
    }

    // Creates a new folder below the system's folder for temporary files (TMPDIR).
    static Result<ScratchFolder> create() {
        std::error_code ignored;
        std::string name =
            (std::filesystem::temp_directory_path(ignored) / "tessera-rd-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr)
            return Status(ErrorCode::io, name + ": cannot be created: " + std::strerror(errno));
        return ScratchFolder(std::move(name), false);
    }

    // Empties `path`, or creates it, and does not delete it afterwards.
    static Result<ScratchFolder> keep(const std::string& path) {
        std::error_code error;
        std::filesystem::remove_all(path, error);
        if (!error)
            std::filesystem::create_directories(path, error);
        if (error)
            return Status(ErrorCode::io, path + ": cannot be created: " + error.message());
        return ScratchFolder(path, true);
    }

    std::string at(const std::string& name) const { return path_ + "/" + name; }

private:
    ScratchFolder(std::string path, bool kept) : path_(std::move(path)), kept_(kept) {}
    std::string path_;
    bool kept_ = false;
};

} // namespace tessera
