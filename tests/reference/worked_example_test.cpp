// format/EXAMPLE.md explains tests/golden/example.tess. The tests check that its bytes, its trace
// of the entropy coder and its texels match the file.
#include "tests/reference/agreement.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace tessera {
namespace {

using namespace test;

std::string read_text(const char* path) {
    const auto root = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
    std::ifstream in(root / path, std::ios::binary);
    EXPECT_TRUE(in) << "the test needs the source tree: " << path;
    return {std::istreambuf_iterator<char>(in), {}};
}

Bytes example_file() {
    const std::string content = read_text("tests/golden/example.tess");
    const auto bytes = std::as_bytes(std::span(content));
    return {bytes.begin(), bytes.end()};
}

// The table rows of the page that match `pattern`.
std::vector<std::smatch> rows(const std::string& page, const std::regex& pattern) {
    return {std::sregex_iterator(page.begin(), page.end(), pattern), {}};
}

TEST(WorkedExample, ShowsAllBytesInOrder) {
    const std::string page = read_text("format/EXAMPLE.md");
    Bytes shown;
    for (const auto& row : rows(page, std::regex(R"(\n\| (\d+) \| `([0-9A-F ]+)` \|)"))) {
        EXPECT_EQ(std::stoul(row[1]), shown.size()) << row[0];
        std::istringstream bytes(row[2]);
        for (std::string byte; bytes >> byte;)
            shown.push_back(static_cast<std::byte>(std::stoi(byte, nullptr, 16)));
    }
    EXPECT_EQ(shown, example_file());
}

TEST(WorkedExample, TracesTheStreamOfTheTile) {
    const std::string page = read_text("format/EXAMPLE.md");
    const Bytes file = example_file();
    ASSERT_GE(file.size(), 6u);
    const Bytes payload(file.end() - 6, file.end()); // of the only tile that is not empty
    std::size_t at = 0;
    std::uint32_t x = 0;
    const auto refill = [&] {
        if (x >= 65536 || at == payload.size())
            return;
        x = x << 16 | std::to_integer<std::uint32_t>(payload[at]) |
            std::to_integer<std::uint32_t>(payload[at + 1]) << 8;
        at += 2;
    };
    refill();
    refill();
    // Rows of symbols: | what | c[i] | r | c[i + 1] | value | x |. For raw bits r is their number.
    const std::regex row_pattern(
        R"(\n\| [^|]+\| *(\d*) *\| (\d+)( raw)? \| *(\d*) *\| (\d+) \| ([0-9A-F]{8}) \|)");
    const auto trace = rows(page, row_pattern);
    EXPECT_EQ(trace.size(), 20u);
    for (const auto& row : trace) {
        const auto number = [&](std::size_t i) {
            return static_cast<std::uint32_t>(std::stoul(row[i]));
        };
        if (row[3].matched) {
            EXPECT_EQ(x & ((1u << number(2)) - 1), number(5)) << row[0];
            x >>= number(2);
        } else {
            EXPECT_EQ(x % 4096, number(2)) << row[0];
            EXPECT_LE(number(1), number(2)) << row[0];
            EXPECT_LT(number(2), number(4)) << row[0];
            x = (number(4) - number(1)) * (x / 4096) + x % 4096 - number(1);
        }
        refill();
        EXPECT_EQ(x, std::stoul(row[6], nullptr, 16)) << row[0];
    }
    EXPECT_EQ(x, 0u);
    EXPECT_EQ(at, payload.size());
}

TEST(WorkedExample, ShowsTheDecodedTexels) {
    const std::string page = read_text("format/EXAMPLE.md");
    Bytes shown;
    for (const auto& row : rows(page, std::regex(R"(\n\| v = \d \|([0-9 |]+)\|)"))) {
        std::string cells = row[1];
        std::replace(cells.begin(), cells.end(), '|', ' ');
        std::istringstream samples(cells);
        for (int sample = 0; samples >> sample;)
            shown.push_back(static_cast<std::byte>(sample));
    }
    const Outcome outcome = expect_agreement(example_file(), "example.tess");
    EXPECT_EQ(shown, outcome.texels);
    for (const auto& [key, value] : outcome.metadata)
        EXPECT_NE(page.find("`" + key + "` = `" + value + "`"), std::string::npos) << key;
}

} // namespace
} // namespace tessera
