// HTTP requests for one URL, several at a time, by libcurl on one thread.
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

// The defaults suit files on the internet.
struct HttpOptions {
    std::chrono::milliseconds connect_timeout{10000};
    // A transfer slower than `stall_bytes` a second for `stall_timeout` (>= 1 s) has failed.
    std::chrono::seconds stall_timeout{20};
    unsigned stall_bytes = 100;
    // Temporary failures (no connection, broken off, stalled, 408, 429, 500, 502, 503, 504) are
    // retried this many times, after back_off, 2 back_off, 4 back_off ..., or after the server's
    // Retry-After, at most 10 s.
    unsigned retries = 4;
    std::chrono::milliseconds back_off{200};
    unsigned in_flight = 6; // requests at a time, for all threads together; 1..64
    unsigned redirects = 5; // most to follow for one request; only to http and https, never from
                            // https to http
    // After this time all requests fail and are not retried.
    std::optional<std::chrono::steady_clock::time_point> deadline;
    // Called on the transfers' thread several times a second while requests are in flight, with the
    // bytes of bodies so far; and once with nothing when all have ended.
    std::function<void(std::optional<std::uint64_t> bytes)> waiting;
    // A PEM file with the trusted certificates for https://. Empty: those of the system.
    std::string ca_file;
    // A server without range requests sends the whole file. Longer ones are refused.
    std::uint64_t max_whole_bytes = std::uint64_t{64} << 20;
};

struct HttpStatistics {
    std::uint64_t requests = 0; // sent, retries included; redirects are followed within one
    std::uint64_t bytes = 0;    // of bodies, failed attempts included
    std::uint64_t retries = 0;
};

// Receives one response. Called by one thread at a time, and not after run() has returned.
class HttpReceiver {
public:
    virtual ~HttpReceiver() = default;
    // The complete head. Every attempt calls this first. After an error the request is not retried.
    virtual Status begin(const HttpHead& head) = 0;
    // Bytes of the body. After an error the request is not retried.
    virtual Status receive(std::span<const std::byte> bytes) = 0;
    // The end of the body. After an error the request is retried.
    virtual Status end() = 0;
};

struct HttpRequest {
    std::uint64_t first = 0, last = 0; // bytes, both included
    std::uint64_t longest = 0;         // longest body that the receiver accepts, bytes
    HttpReceiver* receiver = nullptr;
};

// All members except set_fields() are thread-safe. Connections are kept and reused.
class HttpTransfers {
public:
    // `name` stands for the URL in messages. Sends nothing yet. Errors: runtime.
    static Result<std::unique_ptr<HttpTransfers>>
    create(const std::string& url, const std::string& name, const HttpOptions& options);
    ~HttpTransfers();

    // Field lines such as "If-Match: ..." for all later requests. Not thread-safe.
    void set_fields(std::vector<std::string> fields);

    // Runs all requests; the first error stops the others. Errors, with the name: those of the
    // receivers; io (the network, after all retries); runtime (interrupted, see
    // tools/support/interrupt.h).
    Status run(std::span<const HttpRequest> requests);

    HttpStatistics statistics() const;

private:
    class Worker;
    explicit HttpTransfers(std::unique_ptr<Worker> worker);
    std::unique_ptr<Worker> worker_;
};

} // namespace tessera
