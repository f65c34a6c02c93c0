// A folder for the files that other programs read and write. The destructor deletes it unless it
// was created by keep().
#pragma once

#include "format/output_file.h"
#include "format/status.h"

#include <filesystem>
#include <random>
#include <string>
#include <system_error>
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
            std::filesystem::remove_all(to_path(path_), ignored);
    }

    // Creates a new folder below the system's folder for temporary files (TMPDIR).
    static Result<ScratchFolder> create() {
        namespace fs = std::filesystem;
        std::error_code error;
        const fs::path parent = fs::temp_directory_path(error);
        std::random_device random;
        constexpr int attempts = 100;
        fs::path path;
        for (int i = 0; !error && i < attempts; ++i) {
            path = parent / ("tessera-rd-" + std::to_string(random()));
            if (!fs::create_directory(path, error))
                continue; // the name is taken
            fs::permissions(path, fs::perms::owner_all, error);
            return ScratchFolder(path.string(), false);
        }
        return Status(ErrorCode::io,
                      path.string() + ": cannot be created: " +
                          (error ? error : std::make_error_code(std::errc::file_exists)).message());
    }

    // Empties `path`, or creates it, and does not delete it afterwards.
    static Result<ScratchFolder> keep(const std::string& path) {
        std::error_code error;
        std::filesystem::remove_all(to_path(path), error);
        if (!error)
            std::filesystem::create_directories(to_path(path), error);
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
