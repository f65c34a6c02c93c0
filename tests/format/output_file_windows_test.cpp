// Output files and byte sources where the system has drive letters, sharing modes and devices.
#include "format/byte_source.h"
#include "format/io/system_calls.h"
#include "format/output_file.h"
#include "tests/support/files_in_folder.h"
#include "tests/support/format_bytes.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

namespace tessera {
namespace {

using namespace tessera::test;

class WindowsFiles : public FilesInFolder {
protected:
    void write(const std::string& name, const std::string& text) const {
        Result<OutputFile> file = OutputFile::create(name);
        ASSERT_TRUE(file) << file.status().message();
        ASSERT_TRUE(file->append(bytes_of(text)));
        const Status status = file->commit();
        ASSERT_TRUE(status) << status.message();
    }
    std::string read(const std::string& name) const {
        const auto source = open_file(name);
        if (!source)
            return source.status().message();
        std::string text((*source)->size(), ' ');
        EXPECT_TRUE((*source)->read(0, std::as_writable_bytes(std::span(text))));
        return text;
    }
    // Opens a file as a program does that lets no other use it.
    HANDLE hold(const std::string& name) const {
        const HANDLE held = CreateFileW(to_path(name).c_str(), GENERIC_READ, 0, nullptr,
                                        OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
        EXPECT_NE(held, INVALID_HANDLE_VALUE);
        return held;
    }
};

TEST_F(WindowsFiles, NamesAreUtf8) {
    const std::string name = "gr\xC3\xB6\xC3\x9F"
                             "e \xE2\x82\xAC \xF0\x9F\x8E\xA8.tess";
    write(path("") + name, "new");
    EXPECT_EQ(read(path("") + name), "new");
    const std::filesystem::path found = std::filesystem::directory_iterator(folder_)->path();
    EXPECT_EQ(found.filename().native(), L"gr\u00F6\u00DFe \u20AC \U0001F3A8.tess");
    EXPECT_EQ(to_path(name), found.filename());
    expect_io_error(open_file(path("") + "\xFF").status(), folder_.string(), "No such file");
}

TEST_F(WindowsFiles, PathsMayBeLong) {
    std::string folder = folder_.string();
    while (folder.size() < 400) {
        folder += "/a-folder-with-a-name-of-40-characters-xx";
        ASSERT_EQ(sys::make_folder(folder), 0) << folder << ": " << sys::reason(errno);
    }
    write(folder + "/a.tess", "old");
    write(folder + "/a.tess", "new");
    EXPECT_EQ(read(folder + "/a.tess"), "new");
    // Windows refuses such a path unless it begins so; wine accepts both.
    EXPECT_TRUE(to_path(folder + "/a.tess").native().starts_with(L"\\\\?\\"));
    EXPECT_TRUE(std::filesystem::is_regular_file(to_path(folder + "/a.tess")));
    for (const char* text : {"old", "new"}) { // the second replaces a folder
        Result<OutputFolder> views = OutputFolder::create(folder + "/views");
        ASSERT_TRUE(views) << views.status().message();
        ASSERT_TRUE(views->add("b", bytes_of(text)));
        ASSERT_TRUE(views->commit());
        EXPECT_EQ(read(folder + "/views/b"), text);
    }
    std::error_code error;
    std::vector<std::string> names = names_in(folder, error);
    ASSERT_FALSE(error) << error.message();
    std::ranges::sort(names);
    EXPECT_EQ(names, (std::vector<std::string>{"a.tess", "views"}));
    const std::string first = path("a-folder-with-a-name-of-40-characters-xx");
    EXPECT_EQ(sys::remove_tree(first), 0);
    EXPECT_FALSE(std::filesystem::exists(to_path(first)));
}

TEST_F(WindowsFiles, DrivesAndBothSlashes) {
    ASSERT_EQ(folder_.string()[1], ':');
    write(path("a"), "new");
    std::string slashes = path("a");
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    EXPECT_EQ(read(slashes), "new");
    expect_io_error(open_file("Q:\\none\\a").status(), "Q:\\none\\a", "No such file");
}

TEST_F(WindowsFiles, FilesThatAreInUseAreSaidToBe) {
    write(path("a"), "old");
    Result<OutputFile> file = OutputFile::create(path("a"));
    ASSERT_TRUE(file && file->append(bytes_of("new")));
    const HANDLE held = hold(path("a"));
    expect_io_error(open_file(path("a")).status(), path("a"), "another process has the file open");
    expect_io_error(file->commit(), path("a"), "another process has the file open");
    CloseHandle(held);
    EXPECT_EQ(read(path("a")), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(WindowsFiles, ReadOnlyFilesAreRefused) {
    write(path("a"), "old");
    ASSERT_TRUE(SetFileAttributesW(to_path(path("a")).c_str(), FILE_ATTRIBUTE_READONLY));
    expect_io_error(OutputFile::create(path("a")).status(), path("a"), "read-only");
    ASSERT_TRUE(SetFileAttributesW(to_path(path("a")).c_str(), FILE_ATTRIBUTE_NORMAL));
    EXPECT_EQ(read(path("a")), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(WindowsFiles, FoldersAndDevicesAreRefused) {
    expect_io_error(open_file(folder_.string()).status(), folder_.string(), "directory");
    expect_io_error(OutputFile::create(folder_.string()).status(), folder_.string(), "directory");
    expect_io_error(open_file("NUL").status(), "NUL", "regular");
    expect_io_error(OutputFile::create("NUL").status(), "NUL", "regular");
}

TEST_F(WindowsFiles, LocksExcludeAndEndWithTheFile) {
    const int first = sys::open(path("lock"), sys::Access::update);
    const int second = sys::open(path("lock"), sys::Access::update);
    ASSERT_TRUE(first >= 0 && second >= 0);
    EXPECT_EQ(sys::lock(first), sys::Lock::taken);
    EXPECT_EQ(sys::lock(second), sys::Lock::held_by_another);
    sys::FileFacts a, b;
    ASSERT_EQ(sys::facts_of(first, a), 0);
    ASSERT_EQ(sys::facts_of(path("lock"), b), 0);
    EXPECT_TRUE(a.device == b.device && a.number == b.number);
    sys::close(first);
    EXPECT_EQ(sys::lock(second), sys::Lock::taken);
    sys::close(second);
}

} // namespace
} // namespace tessera
