// A folder of a test's own, for fixtures; they remove it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <unistd.h>

namespace tessera::test {

// Makes it; its name holds the process and the running test, so that parallel tests do not meet.
inline std::filesystem::path make_test_folder(const std::string& suite) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("tessera_" + suite + "_" + std::to_string(getpid()) + "_" +
                         testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
    return folder;
}

} // namespace tessera::test
