// A file, or a folder of files, that appears under its final name only when it is complete.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Paths in this library are UTF-8. Where std::filesystem wants a path, a std::string would be taken
// to be in the system's code page on Windows, so it is converted by this. Bytes that are not UTF-8
// stay as they are, but on Windows become U+FFFD. Thread-safe.
std::filesystem::path to_path(const std::string& utf8);

// A path to take apart, not to open: it lacks the prefix that to_path() gives a long one on Windows,
// which lexically_normal() would break. Thread-safe.
std::filesystem::path lexical_path(const std::string& utf8);

// Names of what a folder holds, in any order. std::filesystem with mingw-w64 would list the current
// folder instead of one whose path has more than 260 characters. Thread-safe.
std::vector<std::string> names_in(const std::string& folder, std::error_code& error);

// What writing to `path` creates or replaces: `path` itself or, where that is a symbolic link, what
// it points to, which need not exist. Errors: io (a loop of links).
Result<std::string> output_target(const std::string& path);

// Writes to a temporary file "<target>.<pid>.tmp" beside output_target(path). commit() flushes it to
// the disk and renames it to the target, so that a link stays a link. An existing file is untouched
// until then; the new one has its mode and, where the system allows it, its owner. A file that
// nobody may write is refused. Without commit() the destructor removes the temporary file. Errors of all members: io, with the path and the system's reason. Not
// thread-safe, except for write_at().
class OutputFile {
public:
    OutputFile() = default;
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&& other) noexcept;
    ~OutputFile();

    static Result<OutputFile> create(const std::string& path);
    // Uses a temporary name that the caller chooses beside `path`, and that nobody else uses. A file
    // that a killed run left there is replaced. If `path` is a link, the name is not used.
    static Result<OutputFile> create(const std::string& path, const std::string& temporary);

    Status append(std::span<const std::byte> bytes);
    // Thread-safe for disjoint ranges. Does not move the append position.
    Status write_at(std::uint64_t offset, std::span<const std::byte> bytes);
    Status commit();
    std::uint64_t appended() const { return appended_; } // bytes
    const std::string& path() const { return path_; }

private:
    void discard();
    std::string path_, target_, temporary_;
    int descriptor_ = -1;
    std::uint64_t appended_ = 0;
};

// Writes files to a temporary folder "<target>.<pid>.tmp" beside output_target(path). commit() renames
// it to the target and replaces a folder of that name, whose mode and owner it keeps, and which is
// put back if the rename fails. Without commit() the destructor
// removes the temporary folder. Errors of all members: io, with the path and the system's reason.
// Not thread-safe, except for add() with different names.
class OutputFolder {
public:
    OutputFolder() = default;
    OutputFolder(OutputFolder&& other) noexcept;
    OutputFolder& operator=(OutputFolder&& other) noexcept;
    ~OutputFolder();

    static Result<OutputFolder> create(const std::string& path);
    // Writes one new file in the folder.
    Status add(const std::string& name, std::span<const std::byte> bytes) const;
    Status commit();
    const std::string& path() const { return path_; }

private:
    void discard();
    std::string path_, target_, temporary_; // temporary_ is empty when there is nothing to remove
};

// Removes the temporary files and folders of all outputs of the process that are not committed.
// Returns the paths that it keeps: folders of journals that hold finished tiles. Thread-safe. The
// process must end by _exit() next, because a thread that begins, commits or discards an output now
// waits forever.
std::vector<std::string> remove_unfinished_outputs();

} // namespace tessera
