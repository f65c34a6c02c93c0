// A folder for tests of files, and what their errors must say.
#pragma once

#include "format/status.h"
#include "tests/support/test_folder.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace tessera::test {

class FilesInFolder : public ::testing::Test {
protected:
    void SetUp() override { folder_ = make_test_folder("format"); }
    void TearDown() override {
        std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
        std::filesystem::remove_all(folder_);
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::ptrdiff_t files() const {
        return std::distance(std::filesystem::directory_iterator(folder_), {});
    }
    std::filesystem::path folder_;
};

inline void expect_io_error(const Status& status, const std::string& path,
                            const std::string& word) {
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find(path), std::string::npos) << status.message();
    EXPECT_NE(status.message().find(word), std::string::npos) << status.message();
}

} // namespace tessera::test
