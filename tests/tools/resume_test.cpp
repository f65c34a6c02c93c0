// Kills the tool at random moments and resumes: the file must be the same as without interruption.
#include "tests/support/test_folder.h"
#include "tests/support/tool_under_test.h"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

namespace fs = std::filesystem;
using tessera::test::slurp;
using Clock = std::chrono::steady_clock;

class Resume : public testing::Test {
protected:
    void SetUp() override { folder_ = tessera::test::make_test_folder("resume"); }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path at(const std::string& name) const { return folder_ / name; }
    bool has_journal(const std::string& output) const {
        return fs::exists(at(output + ".journal"));
    }

    // Starts `tessera <arguments>` without a shell, so that a kill hits the tool itself.
    pid_t start(const std::string& arguments) const {
        std::vector<std::string> words{tessera::test::tool_under_test()};
        std::istringstream in(arguments);
        for (std::string word; in >> word;)
            words.push_back(word);
        std::vector<char*> argv;
        for (std::string& word : words)
            argv.push_back(word.data());
        argv.push_back(nullptr);
        const pid_t child = fork();
        if (child == 0) {
            const int err = open((folder_ / "err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
            dup2(err, STDERR_FILENO);
            if (chdir(folder_.c_str()) == 0)
                execv(argv[0], argv.data());
            _exit(126);
        }
        return child;
    }

    // Waits for the child. Returns its exit code, or 128 + signal if a signal ended it.
    static int code_of(pid_t child) {
        int status = 0;
        waitpid(child, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    int run(const std::string& arguments) const { return code_of(start(arguments)); }
    std::string message() const { return slurp(at("err")); }

    // Sends `signal` after `seconds` if the command is still running.
    int run_until(const std::string& arguments, double seconds, int signal) const {
        const auto begin = Clock::now();
        const pid_t child = start(arguments);
        siginfo_t ended{};
        while (std::chrono::duration<double>(Clock::now() - begin).count() < seconds &&
               (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
                ended.si_pid == 0))
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        kill(child, signal); // an ended process exists until it is waited for
        return code_of(child);
    }

    // Sends `signal` as soon as the journal of x.tess holds tiles. An old journal is removed first,
    // because it would trigger the signal too early.
    int run_until_tiles(const std::string& arguments, int signal) const {
        fs::remove_all(at("x.tess.journal"));
        const pid_t child = start(arguments);
        std::error_code error;
        const fs::path tiles = at("x.tess.journal/pass-1");
        while (waitpid(child, nullptr, WNOHANG) == 0) {
            if (const auto size = fs::file_size(tiles, error); !error && size > 2000) {
                kill(child, signal);
                return code_of(child);
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return -1; // the command ended first
    }

    // Kills `command` `kills` times in all, resuming each time and starting again once it is
    // complete. The moments are spread evenly over the time of a whole run. Returns the number of
    // kills that interrupted a run.
    int torture(const std::string& command, int kills, unsigned seed) {
        const auto begin = Clock::now();
        EXPECT_EQ(run(command + " -o whole.tess --threads 2"), 0) << message();
        double whole = std::chrono::duration<double>(Clock::now() - begin).count();
        const std::string expected = slurp(at("whole.tess"));
        std::mt19937 random(seed);
        int hits = 0;
        bool anew = true; // no journal exists
        for (int i = 0; i <= kills; ++i) {
            const std::string threads = random() % 2 ? " --threads 1" : " --threads 2";
            const double moment = static_cast<double>(random() % 1000) / 1000 * whole;
            const std::string resumed = command + " -o out.tess --resume" + threads;
            const auto started = Clock::now();
            const int code = i < kills ? run_until(resumed, moment, SIGKILL) : run(resumed);
            hits += code == 128 + SIGKILL;
            if (code == 128 + SIGKILL) {
                anew = false;
                continue;
            }
            // Measures again, because on a machine that has become faster most kills would come too
            // late.
            if (anew)
                whole = std::chrono::duration<double>(Clock::now() - started).count();
            anew = true;
            EXPECT_EQ(code, 0) << message();
            EXPECT_EQ(slurp(at("out.tess")) == expected, true) << "after kill " << i;
            EXPECT_FALSE(has_journal("out.tess"));
            fs::remove(at("out.tess"));
        }
        std::vector<std::string> left;
        for (const auto& entry : fs::directory_iterator(folder_))
            left.push_back(entry.path().filename().string());
        EXPECT_EQ(left.size(), static_cast<std::size_t>(fs::exists(at("in.rgb"))) + 2)
            << testing::PrintToString(left); // the others are whole.tess and err
        return hits;
    }

    fs::path folder_;
};

TEST_F(Resume, BakeSurvivesFiftyKills) {
    const int hits =
        torture("bake composed --size 40x24x16x8 --spp 1 --tile 8x8x8x8 --effort 1 -q", 50, 1);
    EXPECT_GE(hits, 20);
}

TEST_F(Resume, PassesOfRateControlSurviveKills) {
    ASSERT_EQ(run("bake gallery --size 24x16x12x8 --spp 1 -q -o in.rgb"), 0);
    const std::string encode = "encode in.rgb --size 24x16x12x8 -q --effort 1 --tile 8x8x8x4 ";
    EXPECT_GE(torture(encode + "--target-psnr 41.3", 25, 2), 8);
    EXPECT_GE(torture(encode + "--target-bytes 5000", 15, 3), 5);
}

TEST_F(Resume, TheHighestEffortAndCorrectionsSurviveKills) {
    ASSERT_EQ(run("bake lamps --size 12x10x8x8 --spp 1 -q -o in.rgb16f"), 0);
    fs::rename(at("in.rgb16f"), at("in.rgb")); // torture() counts one input of this name
    const std::string encode = "encode in.rgb --size 12x10x8x8 --type half --tile 4x8x8x4 -q ";
    // --type overrides the type that .rgb implies.
    EXPECT_GE(torture(encode + "--effort 4 --quality 40", 10, 4), 3);
    EXPECT_GE(torture(encode + "--effort 1 --max-error 40", 10, 5), 3);
}

// Many tiles, so that a signal after the first tiles comes before the last.
const std::string slow_scene = "gallery --spp 4 --size 48x48x16x8";
const std::string options = " --tile 8x8x8x8 --effort 2 -q -o x.tess ";
const std::string slow_bake = "bake " + slow_scene + options;

TEST_F(Resume, SignalsLeaveTheOldFileAndSayHowToGoOn) {
    for (const int signal : {SIGINT, SIGTERM}) {
        std::ofstream(at("x.tess")) << "the old file";
        EXPECT_EQ(run_until_tiles(slow_bake, signal), 128 + signal) << message();
        EXPECT_EQ(slurp(at("x.tess")), "the old file");
        EXPECT_NE(message().find("interrupted; finished tiles are kept in x.tess.journal; the same "
                                 "command with --resume continues"),
                  std::string::npos)
            << message();
        EXPECT_TRUE(has_journal("x.tess"));
    }
    EXPECT_EQ(run(slow_bake + "--resume"), 0) << message();
    EXPECT_FALSE(has_journal("x.tess"));
    EXPECT_EQ(run("validate -q x.tess"), 0);
}

TEST_F(Resume, RefusesOtherOptions) {
    ASSERT_EQ(run_until_tiles(slow_bake, SIGTERM), 128 + SIGTERM) << message();
    const auto refused = [&](const std::string& more, const std::string& word,
                             const std::string& effort = " --effort 2 ") {
        EXPECT_EQ(run(more + effort + "--tile 8x8x8x8 -q -o x.tess --resume"), 1)
            << more << message();
        EXPECT_NE(message().find("cannot resume: " + word), std::string::npos) << message();
        EXPECT_EQ(message().find("--resume"), std::string::npos) << message();
        EXPECT_TRUE(has_journal("x.tess")) << more;
    };
    const std::string same = "bake " + slow_scene + " ";
    refused(same + "--quality 74", "rate was 'quality 75' and is 'quality 74'");
    refused(same, "effort", " --effort 1 ");
    refused(same + "--seed 2", "seed");
    refused(same + "--strict", "strictness");
    refused(same + "--meta Author=me", "metadata Author");
    refused(same + "--viewing-radius 4,20", "description");
    refused("bake gallery --spp 5 --size 48x48x16x8", "samples per texel");
    refused("bake gallery --spp 4 --size 48x40x16x8", "size");
    refused("bake mirror --spp 4 --size 48x48x16x8", "scene was 'gallery' and is 'mirror'");
    EXPECT_EQ(run("bake " + slow_scene + " --effort 2 -q -o x.tess --tile 16x8x8x8 --resume"), 1);
    EXPECT_NE(message().find("largest tile"), std::string::npos) << message();
    // Options that do not affect the bytes may change.
    EXPECT_EQ(run(slow_bake + "--resume --threads 1 --no-verify"), 0) << message();
}

TEST_F(Resume, RefusesAChangedInput) {
    ASSERT_EQ(run("bake gallery --size 48x48x16x16 --spp 1 -q -o in.rgb"), 0);
    const std::string encode = "encode in.rgb --size 48x48x16x16 --threads 1" + options;
    ASSERT_EQ(run_until_tiles(encode, SIGKILL), 128 + SIGKILL);
    ASSERT_TRUE(has_journal("x.tess"));
    const auto time = fs::last_write_time(at("in.rgb"));
    fs::last_write_time(at("in.rgb"), time + std::chrono::seconds(1));
    EXPECT_EQ(run(encode + "--resume"), 1);
    EXPECT_NE(message().find("cannot resume: time of the input"), std::string::npos) << message();
    // Another texture with the same size and time.
    std::string texels = slurp(at("in.rgb"));
    for (char& c : texels)
        c = static_cast<char>(c ^ 1);
    std::ofstream(at("in.rgb"), std::ios::binary) << texels;
    fs::last_write_time(at("in.rgb"), time);
    EXPECT_EQ(run(encode + "--resume"), 1);
    EXPECT_NE(message().find("checksum of sampled texels"), std::string::npos) << message();
}

TEST_F(Resume, RefusesAChangedMask) {
    ASSERT_EQ(run("bake gallery --size 48x48x16x16 --spp 1 -q -o in.rgb"), 0);
    std::ofstream(at("m.gray"), std::ios::binary) << std::string(16 * 16, 'x');
    const std::string encode = "encode in.rgb --size 48x48x16x16 --threads 1" + options +
                               "--mask m.gray --mask-size 1x1x16x16 ";
    ASSERT_EQ(run_until_tiles(encode, SIGKILL), 128 + SIGKILL);
    fs::last_write_time(at("m.gray"), fs::last_write_time(at("m.gray")) + std::chrono::seconds(1));
    EXPECT_EQ(run(encode + "--resume"), 1);
    EXPECT_NE(message().find("cannot resume: time of the mask"), std::string::npos) << message();
}

TEST_F(Resume, TwoProcessesCannotWriteOneOutput) {
    const pid_t first = start(slow_bake);
    for (int i = 0; i < 500 && !fs::exists(at("x.tess.journal/lock")); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(50)); // time to lock the new file
    for (const std::string more : {"", "--resume"}) {
        EXPECT_EQ(run(slow_bake + more), 2);
        EXPECT_NE(message().find("another process"), std::string::npos) << message();
    }
    kill(first, SIGKILL);
    EXPECT_EQ(code_of(first), 128 + SIGKILL);
    EXPECT_EQ(run(slow_bake), 0) << message(); // the journal of the killed process is no obstacle
}

} // namespace
