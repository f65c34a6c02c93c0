// One attempt at an HTTP request: a libcurl handle, what it hears, and what became of it.
#pragma once

#include "tools/http/http_transfers.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <curl/curl.h>
#include <memory>
#include <string>

namespace tessera {

// Lives on the thread of the transfers. Must stay where it is: libcurl knows its address.
class HttpAttempt {
public:
    // `received` counts the bytes of bodies; it must outlive the attempt.
    static Result<std::unique_ptr<HttpAttempt>> create(const std::string& url,
                                                       const std::vector<std::string>& fields,
                                                       const HttpOptions& options,
                                                       const HttpRequest& request,
                                                       std::atomic<std::uint64_t>& received);
    ~HttpAttempt();
    HttpAttempt(const HttpAttempt&) = delete;
    HttpAttempt& operator=(const HttpAttempt&) = delete;

    CURL* handle() const { return handle_; }

    struct Outcome {
        Status status;
        bool may_pass = false;                    // an error that another attempt may not meet
        std::chrono::milliseconds asked_pause{0}; // by Retry-After
    };
    // Call once, after libcurl has ended the transfer with `code`.
    Outcome finish(CURLcode code);

private:
    HttpAttempt(const HttpRequest& request, std::atomic<std::uint64_t>& received)
        : request_(request), received_(received) {}
    bool configure(const std::string& url, const std::vector<std::string>& fields,
                   const HttpOptions& options);
    // What libcurl calls. 0 ends the transfer.
    static std::size_t on_head(char* data, std::size_t size, std::size_t count, void* self);
    static std::size_t on_body(char* data, std::size_t size, std::size_t count, void* self);
    Status take_head(std::string_view line);
    Status take_body(std::span<const std::byte> bytes);
    Status begin();
    template <class Take> std::size_t guard(std::size_t bytes, const Take& take);

    HttpRequest request_;
    std::atomic<std::uint64_t>& received_;
    CURL* handle_ = nullptr;
    curl_slist* fields_ = nullptr;
    char error_[CURL_ERROR_SIZE] = {};
    HttpHead head_;
    std::uint64_t head_bytes_ = 0, discarded_ = 0;
    bool begun_ = false;
    unsigned redirects_ = 0; // most
    Status refused_;         // by us, final
};

} // namespace tessera
