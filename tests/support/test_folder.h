// Temporary folders for tests, which their fixtures remove, and whole files as strings.
#pragma once

#include "format/io/system_calls.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>

namespace tessera::test {

// Creates a folder. Its name contains the process and the running test, so that parallel tests do
// not collide.
inline std::filesystem::path make_test_folder(const std::string& suite) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("tessera_" + suite + "_" + std::to_string(sys::process_id()) + "_" +
                         testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
    return folder;
}

inline std::string slurp(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void spit(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

} // namespace tessera::test
