// One attempt at an HTTP request: a libcurl handle and its outcome.
#pragma once

#include "tools/http/http_transfers.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <curl/curl.h>
#include <memory>
#include <string>

namespace tessera {

// Used by the transfers' thread only. It must not move, because libcurl keeps its address.
class HttpAttempt {
public:
    // Adds the bytes of the body to `received`, which must outlive the attempt.
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
        bool is_temporary = false;                // another attempt may succeed
        std::chrono::milliseconds retry_after{0}; // from the field Retry-After
    };
    // Call it once, after libcurl has ended the transfer with `code`.
    Outcome finish(CURLcode code);

private:
    HttpAttempt(const HttpRequest& request, std::atomic<std::uint64_t>& received)
        : request_(request), received_(received) {}
    bool configure(const std::string& url, const std::vector<std::string>& fields,
                   const HttpOptions& options);
    // Callbacks of libcurl. Returning 0 ends the transfer.
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
    unsigned redirects_ = 0; // most to follow
    Status refused_;         // why we ended the transfer; no further attempt
};

} // namespace tessera
