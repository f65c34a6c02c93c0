// The encoder's output for small textures is frozen in tests/golden/encodings.txt. After an
// intentional change the table is written again, as tests/golden/README.md explains.
#include "tests/support/encodings.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace tessera {
namespace {

// The lines of the table by the names of the encodings.
std::map<std::string, std::string> frozen_lines() {
    const auto tests = std::filesystem::path(__FILE__).parent_path().parent_path();
    std::ifstream table(tests / "golden" / "encodings.txt");
    std::map<std::string, std::string> lines;
    for (std::string line; std::getline(table, line);)
        lines[line.substr(0, line.find(' '))] = line;
    return lines;
}

void expect_frozen(int effort) {
    const auto frozen = frozen_lines();
    for (const test::Encoding& encoding : test::encodings()) {
        if (encoding.effort() != effort)
            continue;
        const auto line = frozen.find(encoding.name);
        ASSERT_TRUE(line != frozen.end()) << encoding.name;
        const Result<std::string> made = test::encoded_line(encoding);
        ASSERT_TRUE(made) << encoding.name << made.status().message();
        EXPECT_EQ(*made, line->second) << "if this is intended, see tests/golden/README.md";
    }
}

TEST(Encodings, AreFrozenAtEffort0) {
    expect_frozen(0);
}

TEST(Encodings, AreFrozenAtEffort1) {
    expect_frozen(1);
}

TEST(Encodings, AreFrozenAtEffort2) {
    expect_frozen(2);
}

TEST(Encodings, AreFrozenAtEffort3) {
    expect_frozen(3);
}

TEST(Encodings, AreFrozenAtEffort4) {
    expect_frozen(4);
}

} // namespace
} // namespace tessera
