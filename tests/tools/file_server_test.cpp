// Tests the responses of `tessera serve` to plain HTTP requests and to HttpSource.
#include "tests/support/test_folder.h"
#include "tools/http/http_source.h"
#include "tools/server/file_server.h"
#include "tools/server/file_server_paths.h"
#include "tools/server/file_server_ranges.h"

#include <arpa/inet.h>
#include <chrono>
#include <fstream>
#include <mutex>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

class Serve : public testing::Test {
protected:
    void SetUp() override {
        ::setenv("no_proxy", "127.0.0.1", 1);
        base_ = test::make_test_folder("serve");
        fs::create_directories(base_ / "root" / "inner");
        spit("root/a.tess", "0123456789");
        spit("root/inner/b <1>.tess", "inner");
        spit("root/.hidden.tess", "hidden");
        spit("root/notes.txt", "notes");
        spit("root/empty.tess", "");
        spit("outside.tess", "outside");
        fs::create_symlink(base_ / "outside.tess", base_ / "root" / "link.tess");
        FileServerOptions options;
        options.folder = (base_ / "root").string();
        options.log = [this](const ServedRequest& request) {
            const std::lock_guard lock(mutex_);
            log_.push_back(request);
        };
        auto server = FileServer::start(options);
        ASSERT_TRUE(server.ok()) << server.status().message();
        server_ = std::move(*server);
    }
    void TearDown() override {
        server_.reset();
        fs::remove_all(base_);
    }

    void spit(const std::string& name, const std::string& bytes) const {
        test::spit(base_ / name, bytes);
    }

    int connect() const {
        const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in address = {};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(server_->port()));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(::connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
        return connection;
    }
    static void say(int connection, const std::string& text) {
        ::send(connection, text.data(), text.size(),
               MSG_NOSIGNAL); // the server may have closed it
    }
    // All bytes until the connection ends.
    static std::string hear(int connection) {
        std::string answer;
        char buffer[4096];
        for (ssize_t got; (got = ::recv(connection, buffer, sizeof buffer, 0)) > 0;)
            answer.append(buffer, static_cast<std::size_t>(got));
        ::close(connection);
        return answer;
    }
    // Sends a request with the given fields and returns all bytes until the connection ends.
    std::string ask(const std::string& method, const std::string& target,
                    const std::string& fields = "") const {
        const int connection = connect();
        say(connection, method + " " + target + " HTTP/1.1\r\nHost: x\r\n" + fields +
                            "Connection: close\r\n\r\n");
        return hear(connection);
    }

    static std::string status(const std::string& answer) { return answer.substr(9, 3); }
    static std::string body(const std::string& answer) {
        return answer.substr(answer.find("\r\n\r\n") + 4);
    }
    static std::string field(const std::string& answer, const std::string& name) {
        const std::size_t at = answer.find("\r\n" + name + ": ") + name.size() + 4;
        return answer.find("\r\n" + name + ": ") == answer.npos
                   ? ""
                   : answer.substr(at, answer.find("\r\n", at) - at);
    }

    fs::path base_;
    std::unique_ptr<FileServer> server_;
    std::mutex mutex_;
    std::vector<ServedRequest> log_;
};

TEST_F(Serve, SendsWholeFilesAndParts) {
    const std::string whole = ask("GET", "/a.tess");
    EXPECT_EQ(status(whole), "200");
    EXPECT_EQ(body(whole), "0123456789");
    EXPECT_EQ(field(whole, "Accept-Ranges"), "bytes");
    EXPECT_EQ(field(whole, "Content-Length"), "10");
    const auto part = [&](const std::string& range) {
        const std::string answer = ask("GET", "/a.tess", "Range: bytes=" + range + "\r\n");
        return status(answer) + " " + field(answer, "Content-Range") + " " + body(answer);
    };
    EXPECT_EQ(part("2-4"), "206 bytes 2-4/10 234");
    EXPECT_EQ(part("7-"), "206 bytes 7-9/10 789");
    EXPECT_EQ(part("-2"), "206 bytes 8-9/10 89");
    EXPECT_EQ(part("0-99"), "206 bytes 0-9/10 0123456789");
    EXPECT_EQ(part("-99"), "206 bytes 0-9/10 0123456789");
    EXPECT_EQ(part("10-"), "416 bytes */10 ");
    EXPECT_EQ(part("-0").substr(0, 3), "416");
    EXPECT_EQ(part("99999999999999999999-").substr(0, 3), "416");
    std::string many = "0-0";
    for (int i = 0; i < 100; ++i)
        many += ",0-9";
    EXPECT_EQ(part(many).substr(0, 3), "416");
    const std::string head = ask("HEAD", "/a.tess", "Range: bytes=0-1\r\n");
    EXPECT_EQ(status(head), "200");
    EXPECT_EQ(field(head, "Content-Length"), "10");
    EXPECT_EQ(body(head), "");
    EXPECT_EQ(status(ask("GET", "/empty.tess")), "200");
    EXPECT_EQ(status(ask("GET", "/empty.tess", "Range: bytes=0-5\r\n")), "416");
    EXPECT_EQ(status(ask("POST", "/a.tess", "Content-Length: 0\r\n")), "405");
}

TEST_F(Serve, SendsSeveralParts) {
    const std::string answer = ask("GET", "/a.tess", "Range: bytes=0-1,4-5, -1\r\n");
    EXPECT_EQ(status(answer), "206");
    const std::string type = field(answer, "Content-Type");
    ASSERT_EQ(type.substr(0, 31), "multipart/byteranges; boundary=");
    const std::string start = "\r\n--" + type.substr(31) + "\r\n" +
                              "Content-Type: application/octet-stream\r\nContent-Range: bytes ";
    EXPECT_EQ(body(answer), start + "0-1/10\r\n\r\n01" + start + "4-5/10\r\n\r\n45" + start +
                                "9-9/10\r\n\r\n9\r\n--" + type.substr(31) + "--\r\n");
    EXPECT_EQ(field(answer, "Content-Length"), std::to_string(body(answer).size()));
}

TEST_F(Serve, HonoursConditionalRequests) {
    const std::string whole = ask("GET", "/a.tess");
    const std::string etag = field(whole, "ETag"), date = field(whole, "Last-Modified");
    EXPECT_EQ(etag.front(), '"');
    const auto asked = [&](const std::string& fields) {
        return status(ask("GET", "/a.tess", "Range: bytes=1-2\r\n" + fields + "\r\n"));
    };
    EXPECT_EQ(asked("If-Match: " + etag), "206");
    EXPECT_EQ(asked("If-Match: \"x\", " + etag), "206");
    EXPECT_EQ(asked("If-Match: *"), "206");
    EXPECT_EQ(asked("If-Match: \"x\""), "412");
    EXPECT_EQ(asked("If-Match: W/" + etag), "412");
    EXPECT_EQ(asked("If-Range: " + etag), "206");
    EXPECT_EQ(asked("If-Range: " + date), "206");
    EXPECT_EQ(asked("If-Range: \"x\""), "200");
    EXPECT_EQ(asked("If-Unmodified-Since: " + date), "206");
    EXPECT_EQ(asked("If-Unmodified-Since: Sat, 01 Jan 2000 00:00:00 GMT"), "412");
    EXPECT_EQ(asked("If-None-Match: " + etag), "304");
    fs::last_write_time(base_ / "root" / "a.tess",
                        fs::file_time_type::clock::now() - std::chrono::hours(3));
    EXPECT_EQ(asked("If-Match: " + etag), "412");
}

TEST_F(Serve, SaysWhenAFileChanged) {
    constexpr std::chrono::seconds since_1970{784111777};
    fs::last_write_time(base_ / "root" / "a.tess",
                        std::chrono::file_clock::from_sys(std::chrono::sys_seconds(since_1970)));
    const std::string answer = ask("GET", "/a.tess");
    EXPECT_EQ(field(answer, "Last-Modified"), "Sun, 06 Nov 1994 08:49:37 GMT");
    EXPECT_EQ(field(answer, "ETag"), "\"a-2ebc98a1-0\"");
}

TEST_F(Serve, StaysInsideItsFolder) {
    EXPECT_EQ(body(ask("GET", "/inner/b%20%3C1%3E.tess")), "inner");
    EXPECT_EQ(body(ask("GET", "//inner//b%20%3C1%3E.tess?x=1")), "inner");
    for (const char* target :
         {"/../outside.tess", "/inner/../../outside.tess", "/%2e%2e/outside.tess",
          "/..%2foutside.tess", "/link.tess", "/.hidden.tess", "/none.tess", "/inner/../a.tess",
          "/a%00.tess", "/./a.tess"}) {
        const std::string answer = ask("GET", target);
        EXPECT_EQ(status(answer), "404") << target << "\n" << answer;
    }
}

TEST_F(Serve, ListsTesseraFiles) {
    const std::string page = body(ask("GET", "/"));
    EXPECT_NE(page.find("<a href=\"a.tess\">a.tess</a> 10 bytes"), std::string::npos) << page;
    EXPECT_NE(page.find("<a href=\"inner/\">inner/</a>"), std::string::npos) << page;
    EXPECT_EQ(page.find("notes"), std::string::npos);
    EXPECT_EQ(page.find("hidden"), std::string::npos);
    EXPECT_NE(body(ask("GET", "/inner/")).find("href=\"b%20%3C1%3E.tess\">b &lt;1&gt;.tess"),
              std::string::npos);
    EXPECT_EQ(field(ask("GET", "/inner"), "Location"), "inner/");
}

TEST_F(Serve, PagesOfOtherHostsMayRead) {
    const std::string options = ask("OPTIONS", "/a.tess", "Origin: http://x\r\n");
    EXPECT_EQ(status(options), "204");
    EXPECT_EQ(field(options, "Access-Control-Allow-Origin"), "*");
    EXPECT_NE(field(options, "Access-Control-Allow-Headers").find("Range"), std::string::npos);
    for (const char* target : {"/a.tess", "/", "/none.tess"})
        EXPECT_EQ(field(ask("GET", target), "Access-Control-Allow-Origin"), "*") << target;
}

TEST_F(Serve, SendsContentTypes) {
    const std::pair<const char*, const char*> types[] = {{"tess", "application/vnd.tessera"},
                                                         {"html", "text/html; charset=utf-8"},
                                                         {"wasm", "application/wasm"},
                                                         {"js", "text/javascript"},
                                                         {"txt", "application/octet-stream"}};
    for (const auto& [ending, type] : types) {
        spit(std::string("root/x.") + ending, "x");
        EXPECT_EQ(field(ask("GET", std::string("/x.") + ending), "Content-Type"), type);
    }
}

TEST_F(Serve, ShowsOneFileAlone) {
    FileServerOptions options;
    options.folder = (base_ / "root").string();
    options.only = "a.tess";
    options.viewer = "the viewer";
    auto server = FileServer::start(options);
    ASSERT_TRUE(server.ok());
    server_ = std::move(*server);
    EXPECT_EQ(body(ask("GET", "/?f=a.tess")), "the viewer");
    const std::string answer = ask("GET", "/a.tess");
    EXPECT_EQ(body(answer), "0123456789");
    EXPECT_EQ(field(answer, "Access-Control-Allow-Origin"), "");
    for (const char* target : {"/inner/", "/inner/b%20%3C1%3E.tess", "/empty.tess", "/a.tess/"})
        EXPECT_EQ(status(ask("GET", target)), "404") << target;
}

TEST_F(Serve, ShowsFilesInItsViewer) {
    FileServerOptions options;
    options.folder = (base_ / "root").string();
    options.viewer = "the viewer";
    options.view_data = [](const std::string& path) -> Result<std::vector<std::byte>> {
        if (path.ends_with("a.tess"))
            return std::vector{std::byte{'d'}};
        if (path.ends_with("a.tess#1")) // the second texture of a .glb
            return std::vector{std::byte{'e'}};
        return Status(ErrorCode::invalid_file, "not one");
    };
    auto server = FileServer::start(options);
    ASSERT_TRUE(server.ok());
    server_ = std::move(*server);
    EXPECT_EQ(body(ask("GET", "/?f=a.tess")), "the viewer");
    EXPECT_EQ(body(ask("GET", "/inner/?f=a.tess")), "the viewer");
    const std::string data = ask("GET", "/a.tess?view");
    EXPECT_EQ(body(data), "d");
    EXPECT_EQ(field(data, "Content-Type"), "application/x-tessera-view");
    EXPECT_EQ(body(ask("GET", "/a.tess?view=1")), "e");
    EXPECT_EQ(status(ask("GET", "/empty.tess?view")), "404");
    EXPECT_EQ(status(ask("GET", "/none.tess?view")), "404");
    EXPECT_EQ(body(ask("GET", "/a.tess")), "0123456789");
    const std::string page = body(ask("GET", "/"));
    EXPECT_NE(page.find("<a href=\"?f=a.tess\">a.tess</a> <a href=\"a.tess\">10 bytes</a>"),
              std::string::npos)
        << page;
}

TEST_F(Serve, LogsRequests) {
    ask("GET", "/a.tess", "Range: bytes=2-4\r\n");
    ask("GET", "/a%0a%1bb.tess");
    server_.reset(); // waits for the last line of the log
    ASSERT_EQ(log_.size(), 2u);
    EXPECT_EQ(log_[0].client, "127.0.0.1");
    EXPECT_EQ(log_[0].path, "/a.tess");
    EXPECT_EQ(log_[0].range, "bytes=2-4");
    EXPECT_EQ(log_[0].status, 206);
    EXPECT_EQ(log_[0].bytes, 3u);
    EXPECT_EQ(log_[1].path, "/a  b.tess");
    EXPECT_EQ(log_[1].status, 404);
}

TEST_F(Serve, LongFilesAreStreamed) {
    const std::uint64_t size = (std::uint64_t{5} << 30) + 7; // with a hole
    spit("root/long.tess", "begin");
    fs::resize_file(base_ / "root" / "long.tess", size);
    {
        std::fstream out(base_ / "root" / "long.tess",
                         std::ios::binary | std::ios::in | std::ios::out);
        out.seekp(static_cast<std::streamoff>(size - 3));
        out << "end";
    }
    const auto source = HttpSource::open(server_->url() + "long.tess");
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ((*source)->size(), size);
    std::vector<std::byte> tail(3), middle(1 << 20, std::byte{1});
    const ReadRequest both[] = {{size - 3, tail}, {std::uint64_t{9} << 29, middle}};
    ASSERT_TRUE((*source)->read_many(both).ok());
    EXPECT_EQ(tail, (std::vector{std::byte{'e'}, std::byte{'n'}, std::byte{'d'}}));
    EXPECT_EQ(middle, std::vector<std::byte>(1 << 20));
    EXPECT_EQ((*source)->statistics().requests, 3u);
    // A new file with the same name is detected.
    fs::resize_file(base_ / "root" / "long.tess", size + 1);
    const Status changed = (*source)->read(size - 3, tail);
    EXPECT_EQ(changed.code(), ErrorCode::io);
    EXPECT_NE(changed.message().find("changed on the server"), std::string::npos)
        << changed.message();
}

// Silent clients, and clients that stop within a request, occupy all 64 threads, but only for some
// seconds.
TEST_F(Serve, SlowClientsAreDisconnectedAfterSomeSeconds) {
    std::vector<int> slow;
    for (int i = 0; i < 70; ++i) {
        slow.push_back(connect());
        say(slow.back(), i % 2 == 0 ? "GET /a.te" : "");
    }
    EXPECT_EQ(body(ask("GET", "/a.tess")), "0123456789");
    for (const int connection : slow)
        ::close(connection);
}

TEST_F(Serve, RequestsWithABodyAreRefused) {
    const int post = connect(); // the body never arrives
    say(post, "POST /a.tess HTTP/1.1\r\nContent-Length: 1000000000\r\n\r\nbeginning");
    EXPECT_EQ(status(hear(post)), "405");
    const int get = connect(); // the body is not a second request
    say(get, "GET /a.tess HTTP/1.1\r\nContent-Length: 40\r\n\r\nGET /empty.tess HTTP/1.1\r\n\r\n");
    const std::string answer = hear(get);
    EXPECT_EQ(status(answer), "400");
    EXPECT_EQ(answer.find("HTTP", 4), std::string::npos);
}

TEST_F(Serve, ReportsInvalidOptions) {
    FileServerOptions options;
    options.folder = (base_ / "none").string();
    EXPECT_EQ(FileServer::start(options).status().code(), ErrorCode::io);
    options.folder = (base_ / "outside.tess").string();
    EXPECT_EQ(FileServer::start(options).status().code(), ErrorCode::io);
    options.folder = base_.string();
    options.port = server_->port();
    const Status taken = FileServer::start(options).status();
    EXPECT_EQ(taken.code(), ErrorCode::io);
    EXPECT_NE(taken.message().find(std::to_string(options.port)), std::string::npos);
}

} // namespace
} // namespace tessera
