// Output files and byte sources where the system has links, modes, owners and pipes.
#include "format/byte_source.h"
#include "format/output_file.h"
#include "tests/support/files_in_folder.h"
#include "tests/support/format_bytes.h"

#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tessera {
namespace {

using namespace tessera::test;

class PosixFiles : public FilesInFolder {};

TEST_F(PosixFiles, RefusesInvalidTargets) {
    expect_io_error(OutputFile::create(folder_.string()).status(), folder_.string(), "directory");
    expect_io_error(OutputFile::create("/dev/full").status(), "/dev/full", "regular");
    expect_io_error(OutputFile::create(path("none/a")).status(), path("none/a"), "No such file");
    EXPECT_EQ(files(), 0);
}

std::string linked(const std::string& link) {
    return std::filesystem::read_symlink(link).string();
}

TEST_F(PosixFiles, LinksStayLinks) {
    std::filesystem::create_directories(path("far"));
    std::filesystem::create_symlink("far/data", path("link"));
    std::filesystem::create_symlink(path("link"), path("link2"));
    for (const std::string text : {"new", "newer"}) { // first what it points to does not exist
        auto file = OutputFile::create(path("link2"));
        ASSERT_TRUE(file.ok()) << file.status().message();
        ASSERT_TRUE(file->append(std::as_bytes(std::span(text))).ok());
        ASSERT_TRUE(file->commit().ok());
        EXPECT_EQ(test::slurp(path("far/data")), text);
    }
    EXPECT_EQ(linked(path("link")), "far/data");
    EXPECT_EQ(linked(path("link2")), path("link"));
    // The same with a temporary name that the caller chooses.
    auto file = OutputFile::create(path("link"), path("own.tmp"));
    ASSERT_TRUE(file.ok()) << file.status().message();
    ASSERT_TRUE(file->commit().ok());
    EXPECT_EQ(test::slurp(path("far/data")), "");
    std::filesystem::create_symlink("loop", path("loop"));
    expect_io_error(OutputFile::create(path("loop")).status(), path("loop"), "link");
    // A folder.
    std::filesystem::create_directory_symlink("far", path("views"));
    auto folder = OutputFolder::create(path("views"));
    ASSERT_TRUE(folder.ok()) << folder.status().message();
    ASSERT_TRUE(folder->add("a", {}).ok());
    ASSERT_TRUE(folder->commit().ok());
    EXPECT_EQ(linked(path("views")), "far");
    EXPECT_TRUE(std::filesystem::exists(path("far/a")));
    EXPECT_FALSE(std::filesystem::exists(path("far/data")));
}

TEST_F(PosixFiles, ReplacedFilesKeepTheirModeAndOwner) {
    const auto mode_of = [](const std::string& name) {
        struct stat info = {};
        EXPECT_EQ(::stat(name.c_str(), &info), 0) << name;
        return info;
    };
    test::spit(path("a"), "old");
    ASSERT_EQ(::chmod(path("a").c_str(), 0640), 0);
    const bool is_root = ::geteuid() == 0;
    if (is_root)
        ASSERT_EQ(::chown(path("a").c_str(), 1234, 4321), 0);
    auto file = OutputFile::create(path("a"));
    ASSERT_TRUE(file.ok()) << file.status().message();
    ASSERT_TRUE(file->commit().ok());
    EXPECT_EQ(mode_of(path("a")).st_mode & 07777, 0640u);
    if (is_root) {
        EXPECT_EQ(mode_of(path("a")).st_uid, 1234u);
        EXPECT_EQ(mode_of(path("a")).st_gid, 4321u);
    }
    std::filesystem::create_directory(path("f"));
    test::spit(path("f/x"), "old");
    ASSERT_EQ(::chmod(path("f/x").c_str(), 0600), 0);
    ASSERT_EQ(::chmod(path("f").c_str(), 0710), 0);
    auto folder = OutputFolder::create(path("f"));
    ASSERT_TRUE(folder.ok()) << folder.status().message();
    ASSERT_TRUE(folder->add("x", {}).ok());
    ASSERT_TRUE(folder->commit().ok());
    EXPECT_EQ(mode_of(path("f")).st_mode & 07777, 0710u);
    EXPECT_EQ(mode_of(path("f/x")).st_mode & 07777, 0600u);
}

TEST_F(PosixFiles, ReadOnlyFilesAreRefused) {
    test::spit(path("a"), "old");
    ASSERT_EQ(::chmod(path("a").c_str(), 0444), 0);
    expect_io_error(OutputFile::create(path("a")).status(), path("a"), "read-only");
    EXPECT_EQ(test::slurp(path("a")), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(PosixFiles, ReadOnlyFolder) {
    std::filesystem::permissions(folder_, static_cast<std::filesystem::perms>(0555));
    const auto child = [this] {
        constexpr uid_t nobody = 65534; // as root every write would succeed
        if (::geteuid() == 0 && ::setuid(nobody) != 0)
            std::_Exit(2);
        expect_io_error(OutputFile::create(path("a")).status(), path("a"), "denied");
        std::_Exit(HasFailure() || files() != 0 ? 1 : 0);
    };
    EXPECT_EXIT(child(), ::testing::ExitedWithCode(0), "");
}

// Without standard input, the first file that a process opens gets descriptor 0.
TEST_F(PosixFiles, DescriptorZeroIsValid) {
    const auto child = [this] {
        ::close(STDIN_FILENO);
        Result<OutputFolder> folder = OutputFolder::create(path("views"));
        const bool good = folder && folder->add("a", bytes_of("a")) && folder->commit() &&
                          open_file(path("views/a"));
        std::_Exit(good ? 0 : 1);
    };
    EXPECT_EXIT(child(), ::testing::ExitedWithCode(0), "");
}

TEST_F(PosixFiles, FullDisk) {
    // In a child process, because a limit on file size simulates the full disk.
    const auto child = [this] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{1000, 1000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        Status status;
        {
            Result<OutputFile> file = OutputFile::create(path("a"));
            const std::vector<std::byte> bytes(600);
            status = file->append(bytes);
            if (status)
                status = file->append(bytes);
        }
        const bool good = status.code() == ErrorCode::io && files() == 0 &&
                          status.message().find("offset 1000") != std::string::npos;
        std::_Exit(good ? 0 : 1);
    };
    EXPECT_EXIT(child(), ::testing::ExitedWithCode(0), "");
}

TEST_F(PosixFiles, ReportsReadErrorsOfOpenSources) {
    std::ofstream(path("a")) << "0123456789";
    const int descriptor = ::dup(STDERR_FILENO); // the next descriptor that open() will return
    ::close(descriptor);
    Result<std::unique_ptr<ByteSource>> file = open_file(path("a"));
    ASSERT_TRUE(file) << file.status().message();
    const int write_only = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    ASSERT_EQ(::dup2(write_only, descriptor), descriptor);
    ::close(write_only);
    std::array<std::byte, 4> four;
    expect_io_error((*file)->read(4, four), path("a"), "cannot read at offset 4");
}

TEST_F(PosixFiles, RefusesInvalidSources) {
    expect_io_error(open_file(path("none")).status(), path("none"), "No such file");
    expect_io_error(open_file(folder_.string()).status(), folder_.string(), "directory");
    expect_io_error(open_file("/dev/null").status(), "/dev/null", "regular");
    ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    expect_io_error(open_file(path("pipe")).status(), path("pipe"), "regular");
}

} // namespace
} // namespace tessera
