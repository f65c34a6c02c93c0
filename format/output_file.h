// A file, or a folder of files, that appears under its final name only when it is whole.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Writes to "<path>.<pid>.tmp" beside the target; commit() syncs and renames it over `path`.
// Destroyed without commit(), it removes the temporary file; an existing file at `path` is
// untouched until the rename. Errors: io, with the path and the system's reason. Not thread-safe,
// except write_at.
class OutputFile {
public:
    OutputFile() = default;
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&& other) noexcept;
    ~OutputFile();

    static Result<OutputFile> create(const std::string& path);
    // With a temporary name of the caller's choice, on the same file system and the caller's alone;
    // what a killed run left there is replaced.
    static Result<OutputFile> create(const std::string& path, const std::string& temporary);

    Status append(std::span<const std::byte> bytes);
    // Thread-safe for disjoint ranges. Does not move the append position.
    Status write_at(std::uint64_t offset, std::span<const std::byte> bytes);
    Status commit();
    std::uint64_t appended() const { return appended_; }
    const std::string& path() const { return path_; }

private:
    void discard();
    std::string path_, temporary_;
    int descriptor_ = -1;
    std::uint64_t appended_ = 0;
};

// Files go to "<path>.<pid>.tmp"; commit() renames that folder to `path`, in place of a folder that
// is there, which is put back where that fails. Destroyed without commit(), it removes what it made.
// Errors: io, with the path and the system's reason. Movable; add() is thread-safe for different names.
class OutputFolder {
public:
    OutputFolder() = default;
    OutputFolder(OutputFolder&& other) noexcept;
    OutputFolder& operator=(OutputFolder&& other) noexcept;
    ~OutputFolder();

    static Result<OutputFolder> create(const std::string& path);
    // Writes one new file of the folder.
    Status add(const std::string& name, std::span<const std::byte> bytes) const;
    Status commit();
    const std::string& path() const { return path_; }

private:
    void discard();
    std::string path_, temporary_; // the latter empty: there is nothing to remove
};

// Removes the temporary files and folders of all outputs that are not committed, in any thread, and returns
// what is worth keeping: folders of journals with finished tiles. For a process that ends by _exit() next:
// whoever begins, finishes or discards an output after this waits for ever.
std::vector<std::string> remove_unfinished_outputs();

} // namespace tessera
