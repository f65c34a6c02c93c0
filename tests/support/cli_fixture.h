// Runs the built tool in a temporary folder for each test.
#pragma once

#include "tests/support/test_folder.h"
#include "tests/support/tool_under_test.h"
#include "tools/support/json_text.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace tessera::test {

namespace fs = std::filesystem;
using tessera::Json;

struct Outcome {
    int code = -1;
    std::string out, err;
};

// Gives each test an empty folder, which is the tool's current folder.
class CliFixture : public testing::Test {
protected:
    void SetUp() override {
        base_ = make_test_folder("cli");
        folder_ = base_ / "work";
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(base_); }

    fs::path at(const std::string& name) const { return folder_ / name; }

    // Runs `tessera <arguments>` through the shell. `before` goes in front of the command, for
    // example "ulimit -f 8;" or "cat a |". `input` is the redirection of standard input.
    Outcome run(const std::string& arguments, const std::string& before = "",
                const std::string& input = "</dev/null") const {
        const std::string command = "cd '" + folder_.string() + "' && " + before + " '" +
                                    tool_under_test() + "' " + arguments + " >'" +
                                    (base_ / "out").string() + "' 2>'" + (base_ / "err").string() +
                                    "' " + input;
        const int status = std::system(command.c_str());
        Outcome outcome;
        outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        outcome.out = slurp(base_ / "out");
        outcome.err = slurp(base_ / "err");
        return outcome;
    }

    void succeed(const std::string& arguments) const {
        const Outcome o = run(arguments);
        EXPECT_EQ(o.code, 0) << arguments << "\n" << o.err;
        EXPECT_EQ(o.err, "") << arguments;
    }

    // Expects exit code `code` and one line `tessera <verb>: error: ...` that contains all `words`.
    void fail(int code, const std::string& arguments, const std::vector<std::string>& words,
              const std::string& before = "") const {
        const Outcome o = run(arguments, before);
        EXPECT_EQ(o.code, code) << arguments << "\n" << o.err;
        const std::string verb = arguments.substr(0, arguments.find(' '));
        EXPECT_EQ(o.err.rfind("tessera " + verb + ": error: ", 0), 0u) << o.err;
        EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
        for (const std::string& word : words)
            EXPECT_NE(o.err.find(word), std::string::npos) << arguments << "\n" << o.err;
    }

    Json json(const std::string& arguments) const {
        const Outcome o = run(arguments);
        Json parsed = Json::parse(o.out, nullptr, false);
        EXPECT_TRUE(parsed.is_object()) << arguments << "\n" << o.out << o.err;
        return parsed;
    }

    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const auto& entry : fs::directory_iterator(folder_))
            all.push_back(entry.path().filename().string());
        std::sort(all.begin(), all.end());
        return all;
    }

    fs::path base_, folder_;
};

} // namespace tessera::test
