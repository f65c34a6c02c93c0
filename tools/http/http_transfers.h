// HTTP requests for one URL, several in flight at a time, by libcurl on a thread of their own.
#pragma once

#include "format/status.h"
#include "tools/http/http_response.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// The usual values suit files on the open internet.
struct HttpOptions {
    std::chrono::milliseconds connect_timeout{10000};
    // A transfer slower than `stall_bytes` a second for `stall_timeout` (>= 1 s) has failed.
    std::chrono::seconds stall_timeout{20};
    unsigned stall_bytes = 100;
    // Failures that may pass (no connection, broken off, stalled, 408, 429, 500, 502, 503, 504) are
    // tried again so many times, after back_off, 2 back_off, 4 back_off ... or what the server asks
    // for in Retry-After, at most 10 s.
    unsigned retries = 4;
    std::chrono::milliseconds back_off{200};
    unsigned in_flight = 6; // requests at a time, of all threads together; 1..64
    unsigned redirects = 5; // most to follow for one request; to http and https only, never from
                            // https to http
    // When everything must have come; after that all requests fail, and are not tried again.
    std::optional<std::chrono::steady_clock::time_point> deadline;
    // Called on the transfers' thread some times a second while requests are in flight: bytes of bodies
    // so far; and once with nothing when none is any more.
    std::function<void(std::optional<std::uint64_t> bytes)> waiting;
    // The certificates that https:// trusts, a PEM file; empty: those of the system.
    std::string ca_file;
    // A server that knows no ranges sends the whole file: refused when it is longer than this.
    std::uint64_t max_whole_bytes = std::uint64_t{64} << 20;
};

struct HttpStatistics {
    std::uint64_t requests = 0; // sent, retries included; redirects are followed within one
    std::uint64_t bytes = 0;    // of bodies, those of failed attempts included
    std::uint64_t retries = 0;
};

// Takes in one response. Called by one thread at a time, never again once run() has returned.
class HttpReceiver {
public:
    virtual ~HttpReceiver() = default;
    // A complete head; every attempt begins anew. An error ends the request for good.
    virtual Status begin(const HttpHead& head) = 0;
    // Bytes of the body. An error ends the request for good.
    virtual Status receive(std::span<const std::byte> bytes) = 0;
    // There are no more. After an error the request is tried again.
    virtual Status end() = 0;
};

struct HttpRequest {
    std::uint64_t first = 0, last = 0; // bytes asked for, both included
    std::uint64_t longest = 0;         // bytes of a body that the receiver would take
    HttpReceiver* receiver = nullptr;
};

// All members are thread-safe. Connections are kept and used again.
class HttpTransfers {
public:
    // `name` stands for the URL in messages. Sends nothing yet. Errors: runtime.
    static Result<std::unique_ptr<HttpTransfers>>
    create(const std::string& url, const std::string& name, const HttpOptions& options);
    ~HttpTransfers();

    // Field lines such as "If-Match: ..." for every request from now on. Not thread-safe.
    void set_fields(std::vector<std::string> fields);

    // Runs them all; the first error stops the others. Errors, with the name: those of the receivers;
    // io (network, or the retries are used up); runtime (interrupted, see tools/support/interrupt.h).
    Status run(std::span<const HttpRequest> requests);

    HttpStatistics statistics() const;

private:
    class Worker;
    explicit HttpTransfers(std::unique_ptr<Worker> worker);
    std::unique_ptr<Worker> worker_;
};

} // namespace tessera
