// What a process that is made to end takes with it.
#include "format/output_file.h"
#include "tests/support/test_folder.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

TEST(Unfinished, OutputsThatAreNotCommittedAreRemoved) {
    const fs::path folder = test::make_test_folder("unfinished");
    const pid_t child = ::fork();
    if (child == 0) {
        auto open = OutputFile::create((folder / "open").string());
        auto done = OutputFile::create((folder / "done").string());
        auto dropped = OutputFile::create((folder / "dropped").string());
        auto views = OutputFolder::create((folder / "views").string());
        if (!open.ok() || !done.ok() || !dropped.ok() || !views.ok() || !done->commit().ok() ||
            !views->add("a.png", {}).ok())
            ::_exit(1);
        *dropped = OutputFile();
        remove_unfinished_outputs();
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator(folder))
        left.push_back(entry.path().filename().string());
    EXPECT_EQ(left, std::vector<std::string>{"done"});
    fs::remove_all(folder);
}

} // namespace
} // namespace tessera
