// Tests reading ranges over HTTP with few requests. A server that misbehaves must give either the
// right bytes or a clear error.
#include "format/byte_source.h"
#include "format/container/syntax.h"
#include "tests/support/raw_server.h"
#include "tools/http/http_source.h"
#include "tools/http/open_bytes.h"
#include "tools/texture_io/texture_io.h"

#include <chrono>
#include <cstdlib>
#include <random>

namespace tessera {
namespace {

using test::PartAnswer;
using test::RawServer;
using Bytes = std::vector<std::byte>;
using Answer = RawServer::Answer;

// Prevents a proxy of this machine from interfering.
const bool no_proxy = ::setenv("no_proxy", "127.0.0.1", 1) == 0;

std::string random_file(std::size_t size) {
    std::mt19937 random(7);
    std::string bytes(size, ' ');
    for (char& c : bytes)
        c = static_cast<char>(random());
    return bytes;
}
const std::string file = random_file(300'000);
constexpr std::size_t first_bytes = first_read_bytes; // read when the file is opened
const std::string first_text = std::to_string(first_bytes);
const std::string last_text = std::to_string(first_bytes - 1);

HttpOptions quick() {
    HttpOptions options;
    options.connect_timeout = std::chrono::milliseconds(2000);
    options.stall_timeout = std::chrono::seconds(1);
    options.retries = 2;
    options.back_off = std::chrono::milliseconds(5);
    return options;
}

Answer good(const std::string& head, unsigned) {
    return {PartAnswer(head, file).text()};
}

// Answers the first request correctly and all others with `spoiled`.
RawServer::Handler opens_then(RawServer::Handler spoiled) {
    return [spoiled = std::move(spoiled)](const std::string& head, unsigned number) {
        return number == 0 ? good(head, number) : spoiled(head, number);
    };
}

Status read_at(ByteSource& source, std::uint64_t offset, std::size_t length) {
    Bytes out(length);
    TESSERA_TRY(source.read(offset, out));
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(out.data()), out.size()),
              file.substr(offset, length));
    return {};
}

void expect_error(const Status& status, ErrorCode code, const std::string& words) {
    EXPECT_EQ(status.code(), code) << status.message();
    EXPECT_NE(status.message().find(words), std::string::npos) << status.message();
    EXPECT_NE(status.message().find("http://127.0.0.1"), std::string::npos) << status.message();
}

// Expects that opening fails.
void expect_no_opening(const RawServer::Handler& handler, ErrorCode code, const std::string& words,
                       unsigned requests, const HttpOptions& options = quick()) {
    const RawServer server(handler);
    expect_error(HttpSource::open(server.url(), options).status(), code, words);
    EXPECT_EQ(server.requests(), requests);
}

// Expects that opening succeeds and reading fails.
void expect_no_reading(const RawServer::Handler& handler, ErrorCode code, const std::string& words,
                       unsigned requests, const HttpOptions& options = quick()) {
    const RawServer server(opens_then(handler));
    const auto source = HttpSource::open(server.url(), options);
    ASSERT_TRUE(source.ok()) << source.status().message();
    expect_error(read_at(**source, 100'000, 5000), code, words);
    EXPECT_EQ(server.requests(), 1 + requests);
}

// Expects that opening succeeds and that reading succeeds despite the handler.
void expect_reading(const RawServer::Handler& handler, unsigned requests, std::uint64_t retries) {
    const RawServer server(opens_then(handler));
    const auto source = HttpSource::open(server.url(), quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_TRUE(read_at(**source, 100'000, 5000).ok());
    EXPECT_EQ(server.requests(), 1 + requests);
    EXPECT_EQ((*source)->statistics().retries, retries);
}

// ---------------------------------------------------------------- correct servers

TEST(Http, OpensWithOneRequest) {
    const RawServer server(good);
    const auto source = HttpSource::open(server.url(), quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ(server.requests(), 1u);
    EXPECT_EQ((*source)->size(), file.size());
    EXPECT_TRUE((*source)->wants_prefetch());
    EXPECT_TRUE(read_at(**source, 0, first_bytes).ok());
    EXPECT_TRUE(read_at(**source, 300'000, 0).ok());
    EXPECT_EQ(server.requests(), 1u) << "the first bytes are read again";
    EXPECT_TRUE(read_at(**source, 16'000, 1000).ok());
    EXPECT_TRUE(read_at(**source, 299'999, 1).ok());
    EXPECT_EQ(server.requests(), 3u);
    const HttpStatistics sum = (*source)->statistics();
    EXPECT_EQ(sum.requests, 3u);
    EXPECT_EQ(sum.bytes, first_bytes + 1000 + 1);
    EXPECT_EQ(sum.retries, 0u);
    EXPECT_EQ(read_at(**source, 299'999, 2).code(), ErrorCode::io);
    EXPECT_EQ(read_at(**source, ~0ull, 2).code(), ErrorCode::io);
    EXPECT_EQ(server.requests(), 3u);
}

TEST(Http, OpensFilesShorterThanTheFirstRequest) {
    const std::string tiny = file.substr(0, 100);
    const RawServer server(
        [&](const std::string& head, unsigned) { return Answer{PartAnswer(head, tiny).text()}; });
    const auto source = HttpSource::open(server.url(), quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ((*source)->size(), 100u);
    EXPECT_TRUE(read_at(**source, 10, 90).ok());
    EXPECT_FALSE((*source)->wants_prefetch());
    EXPECT_EQ(server.requests(), 1u);
    const RawServer empty([](const std::string&, unsigned) {
        return Answer{
            "HTTP/1.1 416 x\r\nContent-Range: bytes */0\r\nContent-Length: 3\r\n\r\nno\n"};
    });
    const auto nothing = HttpSource::open(empty.url(), quick());
    ASSERT_TRUE(nothing.ok()) << nothing.status().message();
    EXPECT_EQ((*nothing)->size(), 0u);
}

TEST(Http, MergesRangesAndKeepsRequestsInFlight) {
    const RawServer server([](const std::string& head, unsigned number) {
        if (number > 0) // long enough for the other requests to arrive
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        return good(head, number);
    });
    HttpOptions options = quick();
    options.in_flight = 3;
    const auto source = HttpSource::open(server.url(), options);
    ASSERT_TRUE(source.ok()) << source.status().message();
    // Four regions of many unordered ranges, some of which overlap or are empty.
    std::vector<Bytes> buffers;
    std::vector<std::uint64_t> offsets;
    for (std::size_t i = 0; i < 4000; ++i) {
        offsets.push_back(20'000 + (i % 4) * 70'000 + i * 7919 % 20'000);
        buffers.emplace_back(i % 50);
    }
    std::vector<ReadRequest> requests;
    for (std::size_t i = 0; i < buffers.size(); ++i)
        requests.push_back({offsets[i], buffers[i]});
    ASSERT_TRUE((*source)->read_many(requests).ok());
    for (std::size_t i = 0; i < buffers.size(); ++i)
        ASSERT_EQ(std::string(reinterpret_cast<const char*>(buffers[i].data()), buffers[i].size()),
                  file.substr(offsets[i], buffers[i].size()));
    EXPECT_EQ(server.requests(), 1 + 4u);
    EXPECT_EQ(server.requests(), 1 + merge_reads(requests).size());
    EXPECT_EQ(server.most_at_once(), 3u);
    EXPECT_TRUE((*source)->read_many({}).ok());
    EXPECT_EQ(server.requests(), 1 + 4u);
}

TEST(Http, ServesManyThreads) {
    const RawServer server(good);
    HttpOptions options = quick();
    options.in_flight = 4;
    const auto source = HttpSource::open(server.url(), options);
    ASSERT_TRUE(source.ok()) << source.status().message();
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 8; ++t)
        threads.emplace_back([&, t] {
            for (unsigned i = 0; i < 40; ++i) {
                Bytes a(500), b(700);
                const std::uint64_t at = 17'000 + t * 31'000 + i * 600;
                const ReadRequest both[] = {{at, a}, {(at + 150'000) % 290'000, b}};
                wrong += !(*source)->read_many(both).ok();
                wrong += std::string(reinterpret_cast<const char*>(a.data()), a.size()) !=
                         file.substr(at, a.size());
                wrong += std::string(reinterpret_cast<const char*>(b.data()), b.size()) !=
                         file.substr((at + 150'000) % 290'000, b.size());
            }
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_LE(server.most_at_once(), 4u);
    EXPECT_EQ((*source)->statistics().requests, server.requests());
}

TEST(Http, FollowsRedirects) {
    const RawServer target(good);
    const RawServer server([&](const std::string&, unsigned) {
        return Answer{"HTTP/1.1 302 Found\r\nLocation: " + target.url() +
                      "\r\nContent-Length: 0\r\nETag: \"of the redirect\"\r\n\r\n"};
    });
    const auto source = HttpSource::open(server.url(), quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_TRUE(read_at(**source, 50'000, 100).ok());
    EXPECT_EQ(target.requests(), 2u);
    EXPECT_EQ((*source)->name(), server.url());
}

TEST(Http, HidesPasswords) {
    std::string said;
    const RawServer server([&](const std::string& head, unsigned number) {
        said = test::field_of(head, "Authorization");
        return good(head, number);
    });
    std::string url = server.url();
    url.insert(7, "me:secret@");
    const auto source = HttpSource::open(url, quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ(said, "Basic bWU6c2VjcmV0");
    EXPECT_EQ((*source)->name().find("secret"), std::string::npos) << (*source)->name();
}

// ---------------------------------------------------------------- servers without ranges

TEST(Http, KeepsSmallFilesOfServersWithoutRanges) {
    const RawServer server([](const std::string&, unsigned) {
        return Answer{"HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(file.size()) +
                      "\r\n\r\n" + file};
    });
    const auto source = HttpSource::open(server.url(), quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_EQ((*source)->size(), file.size());
    EXPECT_TRUE(read_at(**source, 0, file.size()).ok());
    EXPECT_FALSE((*source)->wants_prefetch());
    EXPECT_EQ(server.requests(), 1u);
}

TEST(Http, RefusesLongFilesOfServersWithoutRanges) {
    HttpOptions options = quick();
    options.max_whole_bytes = file.size() - 1;
    const auto whole = [](const std::string& length) {
        return [length](const std::string&, unsigned) {
            return Answer{"HTTP/1.1 200 OK\r\n" + length + "\r\n" + file, false};
        };
    };
    expect_no_opening(whole("Content-Length: 300000\r\n"), ErrorCode::unsupported,
                      "the file has 300000 bytes", 1, options);
    expect_no_opening(whole(""), ErrorCode::unsupported, "more than the 299999", 1, options);
    options.max_whole_bytes = file.size();
    const RawServer server(whole("")); // the body ends with the connection
    EXPECT_TRUE(HttpSource::open(server.url(), options).ok());
    expect_no_reading(whole("Content-Length: 300000\r\n"), ErrorCode::io, "whole file instead", 1);
}

// ---------------------------------------------------------------- wrong responses

TEST(Http, RefusesWrongRanges) {
    const auto shifted = [](const std::string& head, unsigned) {
        PartAnswer answer(head, file);
        ++answer.first;
        ++answer.last;
        return Answer{answer.text()};
    };
    expect_no_opening(shifted, ErrorCode::io,
                      "sends bytes 1-" + first_text + " instead of bytes 0-" + last_text, 1);
    expect_no_reading(shifted, ErrorCode::io,
                      "sends bytes 100001-105000 instead of bytes 100000-104999", 1);
    for (const char* range :
         {"bytes */300000", "bytes 5-4/300000", "bytes 0-16383/16383", "", "bytes 0-16383",
          "octets 0-16383/300000", "bytes 0-/300000",
          "bytes 0-99999999999999999999/999999999999999999999", "bytes -16383-0/300000"}) {
        const std::string text = "HTTP/1.1 206 OK\r\nContent-Length: " + first_text + "\r\n" +
                                 "Content-Range: " + range + "\r\n\r\n" +
                                 file.substr(0, first_bytes);
        expect_no_opening([&](const std::string&, unsigned) { return Answer{text}; }, ErrorCode::io,
                          "Content-Range", 1);
    }
    expect_no_opening(
        [](const std::string&, unsigned) {
            return Answer{"HTTP/1.1 206 OK\r\nContent-Range: bytes 0-3/*\r\n"
                          "Content-Length: 4\r\n\r\nabcd"};
        },
        ErrorCode::io, "how long the file is", 1);
}

TEST(Http, RefusesBodiesOfTheWrongLength) {
    const auto shorter = [](const std::string& head, unsigned) {
        PartAnswer answer(head, file);
        answer.body.pop_back();
        return Answer{answer.text()};
    };
    expect_no_opening(shorter, ErrorCode::io,
                      "only " + last_text + " of " + first_text + " bytes (3 attempts)", 3);
    expect_no_reading(shorter, ErrorCode::io, "only 4999 of 5000 bytes (3 attempts)", 3);
    const auto longer = [](const std::string& head, unsigned) {
        PartAnswer answer(head, file);
        answer.body += "x";
        return Answer{answer.text()};
    };
    expect_no_opening(longer, ErrorCode::io, "more than the " + first_text + " bytes", 1);
    expect_no_reading(longer, ErrorCode::io, "more than the 5000 bytes", 1);
}

TEST(Http, DetectsAChangedFile) {
    const std::string words = "changed on the server while it was being read";
    expect_no_reading(
        [](const std::string& head, unsigned) {
            EXPECT_EQ(test::field_of(head, "If-Match"), "\"v1\"");
            return Answer{"HTTP/1.1 412 Precondition Failed\r\nContent-Length: 0\r\n\r\n"};
        },
        ErrorCode::io, words, 1);
    const auto spoiled = [](const std::function<void(PartAnswer&)>& spoil) {
        return [spoil](const std::string& head, unsigned) {
            PartAnswer answer(head, file);
            spoil(answer);
            return Answer{answer.text()};
        };
    };
    expect_no_reading(spoiled([](PartAnswer& a) { a.etag = "\"v2\""; }), ErrorCode::io, words, 1);
    expect_no_reading(spoiled([](PartAnswer& a) { a.etag = ""; }), ErrorCode::io, words, 1);
    expect_no_reading(spoiled([](PartAnswer& a) { a.total += 1; }), ErrorCode::io, words, 1);
    expect_no_reading(spoiled([](PartAnswer& a) { a.more = {"Last-Modified: today"}; }),
                      ErrorCode::io, words, 1);
    expect_no_reading(
        [](const std::string&, unsigned) {
            return Answer{
                "HTTP/1.1 416 x\r\nContent-Range: bytes */50\r\nContent-Length: 0\r\n\r\n"};
        },
        ErrorCode::io, words, 1);
    // Without a strong ETag, requests are conditional on the date.
    std::string asked;
    const RawServer server([&](const std::string& head, unsigned) {
        PartAnswer answer(head, file);
        answer.etag = "W/\"weak\"";
        answer.more = {"Last-Modified: Sat, 21 Nov 2026 19:45:07 GMT"};
        asked = test::field_of(head, "If-Unmodified-Since");
        return Answer{answer.text()};
    });
    const auto source = HttpSource::open(server.url(), quick());
    ASSERT_TRUE(source.ok()) << source.status().message();
    EXPECT_TRUE(read_at(**source, 20'000, 5).ok());
    EXPECT_EQ(asked, "Sat, 21 Nov 2026 19:45:07 GMT");
}

TEST(Http, RefusesCompressedResponses) {
    expect_no_opening(
        [](const std::string& head, unsigned) {
            PartAnswer answer(head, file);
            answer.more = {"Content-Encoding: gzip"};
            return Answer{answer.text()};
        },
        ErrorCode::unsupported, "compressed", 1);
}

// ---------------------------------------------------------------- temporary and permanent failures

TEST(Http, RepeatsRequestsThatAreCutOff) {
    const auto cut = [](const std::string& head, unsigned number) {
        Answer answer{PartAnswer(head, file).text()};
        if (number <= 2) {
            answer.bytes.resize(answer.bytes.size() - 2000);
            answer.keep = false;
        }
        return answer;
    };
    expect_reading(cut, 3, 2);
    expect_no_reading([&](const std::string& head, unsigned) { return cut(head, 0); },
                      ErrorCode::io, "(3 attempts)", 3);
    // The server sends nothing.
    expect_no_reading(
        [](const std::string&, unsigned) {
            return Answer{"", false};
        },
        ErrorCode::io, "(3 attempts)",
        4); // libcurl repeats the request once if a kept connection is dead
}

TEST(Http, RepeatsRequestsWhenTheServerIsBusy) {
    const std::string busy =
        "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 0\r\nContent-Length: 5\r\n\r\nbusy\n";
    expect_reading([&](const std::string& head,
                       unsigned number) { return number <= 2 ? Answer{busy} : good(head, number); },
                   3, 2);
    for (const char* status : {"408", "429", "500", "502", "503", "504"})
        expect_no_opening(
            [&](const std::string&, unsigned) {
                return Answer{std::string("HTTP/1.1 ") + status +
                              " \x1b[31mred\r\nContent-Length: 0\r\n\r\n"};
            },
            ErrorCode::io, std::string("the server answers ") + status, 3);
    HttpOptions once = quick();
    once.retries = 0;
    expect_no_opening([&](const std::string&, unsigned) { return Answer{busy}; }, ErrorCode::io,
                      "answers 503 (Service Unavailable)", 1, once);
}

TEST(Http, WaitsAsLongAsTheServerAsks) {
    const auto start = std::chrono::steady_clock::now();
    expect_reading(
        [](const std::string& head, unsigned number) {
            return number == 1 ? Answer{"HTTP/1.1 429 Slow down\r\nRetry-After: 1\r\n"
                                        "Content-Length: 0\r\n\r\n"}
                               : good(head, number);
        },
        2, 1);
    EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(990));
}

TEST(Http, DoesNotRepeatPermanentFailures) {
    for (const char* status : {"400", "401", "403", "404", "410", "304", "999"})
        expect_no_opening(
            [&](const std::string&, unsigned) {
                return Answer{std::string("HTTP/1.1 ") + status +
                              " x\r\nContent-Length: 0\r\n\r\n"};
            },
            ErrorCode::io, std::string("the server answers ") + status, 1);
}

TEST(Http, DetectsAStall) {
    HttpOptions options = quick();
    options.retries = 0;
    const auto start = std::chrono::steady_clock::now();
    // The server stalls before the response and in the middle of its body.
    for (const std::size_t place : {std::size_t{0}, std::size_t{2000}})
        expect_no_opening(
            [&](const std::string& head, unsigned number) {
                Answer answer = good(head, number);
                answer.pause_at = place;
                return answer;
            },
            ErrorCode::io, "Operation too slow", 1, options);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Http, RefusesEndlessRedirects) {
    std::string self;
    const auto loop = [&](const std::string&, unsigned) {
        return Answer{"HTTP/1.1 302 Found\r\nLocation: " + self + "\r\nContent-Length: 0\r\n\r\n"};
    };
    const RawServer server(loop);
    self = server.url();
    expect_error(HttpSource::open(self, quick()).status(), ErrorCode::io,
                 "redirects more than 5 times");
    EXPECT_EQ(server.requests(), 6u);
    for (const char* target : {"file:///etc/passwd", "ftp://127.0.0.1/x.tess", "gopher://x/"}) {
        self = target;
        expect_error(HttpSource::open(server.url(), quick()).status(), ErrorCode::io, "rotocol");
    }
}

TEST(Http, RefusesGarbage) {
    const auto says = [](std::string text) {
        return [text = std::move(text)](const std::string&, unsigned) {
            return Answer{text, false};
        };
    };
    expect_no_opening(says(file), ErrorCode::io, "HTTP/0.9", 1);
    expect_no_opening(says("HTTP/1.1 abc\r\n\r\n"), ErrorCode::io, "", 1);
    std::string endless = "HTTP/1.1 206 OK\r\n";
    for (int i = 0; i < 20'000; ++i)
        endless += "X-" + std::to_string(i) + ": 0123456789012345678901234567890123456789\r\n";
    expect_no_opening(says(endless), ErrorCode::io, "too long", 1);
    expect_no_opening(says("HTTP/1.1 503 Busy\r\n\r\n" + file), ErrorCode::io, "too long", 1);
}

TEST(Http, ReportsRefusedConnections) {
    std::string url;
    {
        const RawServer server(good);
        url = server.url();
    }
    const auto source = HttpSource::open(url, quick());
    expect_error(source.status(), ErrorCode::io, "onnect");
    EXPECT_NE(source.status().message().find("(3 attempts)"), std::string::npos);
}

// The first error among parallel requests ends all of them.
TEST(Http, OneFailureEndsABatch) {
    const RawServer server(opens_then([](const std::string& head, unsigned number) {
        if (test::range_of(head)->first == 250'000)
            return Answer{"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n"};
        Answer answer = good(head, number);
        answer.pause_at = 50;
        return answer;
    }));
    HttpOptions options = quick();
    options.stall_timeout = std::chrono::seconds(60);
    const auto source = HttpSource::open(server.url(), options);
    ASSERT_TRUE(source.ok()) << source.status().message();
    Bytes a(100), b(100), c(100);
    const ReadRequest three[] = {{20'000, a}, {250'000, b}, {100'000, c}};
    const auto start = std::chrono::steady_clock::now();
    expect_error((*source)->read_many(three), ErrorCode::io, "404");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    EXPECT_TRUE(read_at(**source, 0, 10).ok());
}

// The total time is limited, even if bytes keep arriving slowly.
TEST(Http, TimeEndsSlowTransfers) {
    const RawServer server(opens_then([](const std::string& head, unsigned number) {
        Answer answer = good(head, number);
        answer.pause_at = answer.bytes.size() - 1;
        return answer;
    }));
    HttpOptions options = quick();
    options.stall_timeout = std::chrono::seconds(60);
    options.deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(400);
    unsigned told = 0;
    bool over = false;
    options.waiting = [&](std::optional<std::uint64_t> bytes) {
        told += bytes.has_value();
        over = !bytes;
    };
    const auto source = HttpSource::open(server.url(), options);
    ASSERT_TRUE(source.ok()) << source.status().message();
    Bytes a(100);
    expect_error((*source)->read(20'000, a), ErrorCode::io, "time limit");
    EXPECT_GT(told, 1u);
    EXPECT_TRUE(over);
}

// ---------------------------------------------------------------- URLs

TEST(Http, RecognisesUrls) {
    EXPECT_TRUE(is_url("http://a/b.tess"));
    EXPECT_TRUE(is_url("HTTPS://a/b.tess"));
    EXPECT_TRUE(is_url("ftp://a"));
    EXPECT_FALSE(is_url("a/b.tess"));
    EXPECT_FALSE(is_url("://x"));
    EXPECT_FALSE(is_url("./http://x"));
    EXPECT_EQ(kind_of("http://a/b.tess?key=1/x.png#c.exr"), TextureKind::tess);
    EXPECT_EQ(kind_of("http://a/b.png?x.tess"), TextureKind::unknown);
    EXPECT_EQ(kind_of("http://a/b.exr"), TextureKind::unknown);
    EXPECT_EQ(kind_of("http://a/b/"), TextureKind::unknown);
    EXPECT_EQ(open_bytes("ftp://127.0.0.1/a.tess").status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(open_bytes("http://127.0.0.1:99999/a.tess").status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(open_bytes("http://").status().code(), ErrorCode::bad_argument);
    EXPECT_EQ(open_bytes("none.tess").status().code(), ErrorCode::io);
}

} // namespace
} // namespace tessera
