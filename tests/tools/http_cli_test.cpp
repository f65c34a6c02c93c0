// Tests every verb that reads a .tess file, with a URL of `tessera serve`.
#include "tests/support/cli_fixture.h"
#include "tests/support/raw_server.h"

#include <chrono>
#include <fcntl.h>
#include <thread>
#include <unistd.h>

namespace {

using namespace tessera::test;

class HttpCli : public CliFixture {
protected:
    void SetUp() override {
        CliFixture::SetUp();
        ::setenv("no_proxy", "127.0.0.1", 1);
        succeed("bake composed --size 64x32x16x16 --spp 1 -q -o a.tess --quality 99 --effort 1");
        fs::create_directory(base_ / "served");
        fs::copy_file(at("a.tess"), base_ / "served" / "a.tess");
        start();
    }
    void TearDown() override {
        if (server_ > 0)
            EXPECT_EQ(stop(), 0);
        CliFixture::TearDown();
    }

    // Starts `tessera serve` as a child process, whose first line is its URL.
    void start() {
        const std::string log = (base_ / "log").string(), folder = (base_ / "served").string();
        const std::string tool = tool_under_test();
        server_ = ::fork();
        if (server_ == 0) {
            ::dup2(::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
            ::execl(tool.c_str(), tool.c_str(), "serve", folder.c_str(), "--port", "0", nullptr);
            ::_exit(127);
        }
        for (int i = 0; i < 1000 && url_.empty(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            const std::string said = slurp(log);
            if (said.find('\n') != said.npos)
                url_ = said.substr(0, said.find('\n'));
        }
        ASSERT_EQ(url_.substr(0, 17), "http://127.0.0.1:") << url_;
        url_ += "a.tess";
    }

    // Sends Ctrl-C and returns the exit code.
    int stop() {
        ::kill(server_, SIGINT);
        int status = 0;
        ::waitpid(server_, &status, 0);
        server_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

    // The number of requests in the log.
    std::size_t requests() const {
        const std::string said = slurp(base_ / "log");
        return static_cast<std::size_t>(std::count(said.begin(), said.end(), '\n')) - 1;
    }

    // Runs a command, which must succeed, and returns its number of requests.
    std::size_t requests_of(const std::string& arguments) {
        const std::size_t before = requests();
        succeed(arguments);
        std::this_thread::sleep_for(std::chrono::milliseconds(50)); // waits for the log's last line
        return requests() - before;
    }

    pid_t server_ = 0;
    std::string url_;
};

TEST_F(HttpCli, PrintsInfo) {
    Json remote = json("info --json " + url_), local = json("info --json a.tess");
    EXPECT_EQ(remote["file"], url_);
    remote.erase("file");
    local.erase("file");
    EXPECT_EQ(remote, local);
    EXPECT_LE(requests(), 1u) << "the first request should include this small file's index";
}

TEST_F(HttpCli, Decodes) {
    // One request opens the file, and one more reads what the head does not hold.
    EXPECT_LE(requests_of("decode -q -o far.rgb --box 3:40,2:20,0:9,: " + url_), 2u);
    succeed("decode -q -o near.rgb --box 3:40,2:20,0:9,: a.tess");
    EXPECT_EQ(slurp(at("far.rgb")), slurp(at("near.rgb")));
    for (const std::string name : {"x.rgb", "x.exr", "views/"}) {
        EXPECT_LE(requests_of("decode -q -o " + name + " " + url_), 3u) << name;
        EXPECT_EQ(json("compare a.tess --json " + name + " --size 64x32x16x16")["identical"], true);
    }
    const Outcome o = run("decode -o x.rgb '" + url_ + "?version=1#here'");
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_NE(o.out.find(" requests, "), std::string::npos) << o.out;
    EXPECT_NE(o.out.find(" received"), std::string::npos) << o.out;
}

TEST_F(HttpCli, ComparesTranscodesDraws) {
    const auto before = requests();
    EXPECT_EQ(json("compare --json a.tess " + url_)["identical"], true);
    EXPECT_EQ(json("compare --json --no-ssim " + url_ + " a.tess")["identical"], true);
    // Ten requests, or more on a busy machine where read-ahead comes late. Tile by tile it would be
    // 18.
    EXPECT_LE(requests() - before, 15u) << "was read tile by tile";
    succeed("render -q --pixels 32x24 -o far.png " + url_);
    succeed("render -q --pixels 32x24 -o near.png a.tess");
    EXPECT_EQ(slurp(at("far.png")), slurp(at("near.png")));
    succeed("encode -q --effort 0 -o far.tess " + url_);
    succeed("encode -q --effort 0 -o near.tess a.tess");
    EXPECT_EQ(slurp(at("far.tess")), slurp(at("near.tess")));
    succeed("sheet -q -o far.png a.tess " + url_);
    succeed("rd -q --rivals none --quick --quality 40 --efforts 0 -o report " + url_);
    const Outcome bench = run("bench gpu --pixels 99999x1 " + url_);
    EXPECT_NE(bench.code, 2) << "it could not be opened\n" << bench.err;
}

TEST_F(HttpCli, Validates) {
    const auto before = requests();
    EXPECT_EQ(json("validate --json " + url_)["valid"], true);
    EXPECT_LE(requests() - before, 3u);
    std::string bad = slurp(at("a.tess"));
    bad[bad.size() - 100] = static_cast<char>(bad[bad.size() - 100] ^ 1);
    spit(base_ / "served" / "bad.tess", bad);
    const std::string url = url_.substr(0, url_.size() - 6) + "bad.tess";
    fail(3, "validate " + url, {"not valid"});
    fail(3, "decode -o x.rgb " + url, {"bad.tess", "checksum"});
    spit(base_ / "served" / "empty.tess", "");
    fail(3, "info " + url_.substr(0, url_.size() - 6) + "empty.tess", {"0 bytes"});
}

TEST_F(HttpCli, RefusesMissingFilesAndOtherFormats) {
    const std::string folder = url_.substr(0, url_.size() - 6);
    fail(2, "info " + folder + "none.tess", {"none.tess", "404"});
    fail(2, "validate " + folder + "none.tess", {"404"});
    fail(1, "info " + folder + "x.exr", {"only .tess"});
    fail(1, "encode " + folder + "x.rgb -o x.tess", {"only .tess"});
    fail(1, "decode a.tess -o " + folder + "x.rgb", {"x.rgb"});
    fail(1, "encode a.tess -o " + folder + "x.tess", {"cannot write to a URL"});
    fail(1, "info ftp://127.0.0.1/a.tess", {"http"});
    fail(2, "serve none", {"none"});
    fail(1, "serve . --port 99999", {"--port"});
    const std::string port = url_.substr(17, url_.rfind('/') - 17);
    fail(2, "serve . --port " + port, {port});
    EXPECT_EQ(stop(), 0);
    fail(2, "info " + url_, {"a.tess", "onnect", "attempts"});
}

// The server never answers, and Ctrl-C does not wait for the timeout.
TEST_F(HttpCli, StopsWhenInterrupted) {
    const RawServer server([](const std::string&, unsigned) {
        RawServer::Answer answer;
        answer.pause_at = 0;
        return answer;
    });
    const auto start = std::chrono::steady_clock::now();
    for (const std::string verb : {"info ", "decode -o x.rgb ", "validate "}) {
        const Outcome o = run(verb + server.url(), "timeout --signal=INT --preserve-status 0.5");
        EXPECT_EQ(o.code, 128 + SIGINT) << o.err;
        EXPECT_NE(o.err.find("interrupted"), std::string::npos) << o.err;
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    EXPECT_FALSE(fs::exists(at("x.rgb")));
}

// Replacing a file during reading gives an error, not a mixture of both.
TEST_F(HttpCli, DetectsAReplacedFile) {
    const std::string file = slurp(at("a.tess"));
    const RawServer server([&](const std::string& head, unsigned number) {
        PartAnswer answer(head, file);
        answer.etag = number == 0 ? "\"one\"" : "\"two\"";
        return RawServer::Answer{answer.text()};
    });
    ASSERT_GT(file.size(), 16384u);
    fail(2, "decode -q -o x.rgb " + server.url(), {"changed on the server"});
    EXPECT_FALSE(fs::exists(at("x.rgb")));
}

} // namespace
