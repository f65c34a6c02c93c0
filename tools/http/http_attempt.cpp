#include "tools/http/http_attempt.h"

#include "format/metadata.h"
#include "tools/support/parse.h"

#include <algorithm>
#include <exception>

namespace tessera {
namespace {

constexpr std::uint64_t max_head_bytes = 256 << 10; // all heads of one request together
// The body of an error is read up to this length, so that its connection can be used again.
constexpr std::uint64_t max_discarded_bytes = 64 << 10;
constexpr std::chrono::seconds longest_retry_after{10};

// The server, or a proxy, is busy or restarting.
bool is_temporary(int status) {
    for (const int temporary : {408, 429, 500, 502, 503, 504})
        if (status == temporary)
            return true;
    return false;
}

bool is_temporary(CURLcode code) {
    switch (code) {
    case CURLE_COULDNT_CONNECT:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_PARTIAL_FILE:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
        return true;
    default:
        return false;
    }
}

} // namespace

Result<std::unique_ptr<HttpAttempt>> HttpAttempt::create(const std::string& url,
                                                         const std::vector<std::string>& fields,
                                                         const HttpOptions& options,
                                                         const HttpRequest& request,
                                                         std::atomic<std::uint64_t>& received) {
    std::unique_ptr<HttpAttempt> attempt(new HttpAttempt(request, received));
    if (!attempt->configure(url, fields, options))
        return Status(ErrorCode::runtime, "libcurl cannot prepare a request");
    return attempt;
}

HttpAttempt::~HttpAttempt() {
    curl_easy_cleanup(handle_);
    curl_slist_free_all(fields_);
}

bool HttpAttempt::configure(const std::string& url, const std::vector<std::string>& fields,
                            const HttpOptions& options) {
    handle_ = curl_easy_init();
    if (handle_ == nullptr)
        return false;
    for (const std::string& field : fields) {
        curl_slist* longer = curl_slist_append(fields_, field.c_str());
        if (longer == nullptr)
            return false;
        fields_ = longer;
    }
    redirects_ = options.redirects;
    bool good = true;
    const auto set = [&](CURLoption option, auto value) {
        good = curl_easy_setopt(handle_, option, value) == CURLE_OK && good;
    };
    const std::string range = std::to_string(request_.first) + "-" + std::to_string(request_.last);
    const bool secure = url.size() > 5 && (url[4] == 's' || url[4] == 'S');
    const std::string agent = std::string("tessera/") + library_version;
    // The time that the slowest accepted transfer takes, so that no transfer lasts for ever.
    const std::uint64_t longest_seconds = 60 + request_.longest / std::max(1u, options.stall_bytes);
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_REDIR_PROTOCOLS_STR, secure ? "https" : "http,https");
    set(CURLOPT_FOLLOWLOCATION, 1L);
    set(CURLOPT_MAXREDIRS, static_cast<long>(options.redirects));
    set(CURLOPT_RANGE, range.c_str());
    set(CURLOPT_HTTPHEADER, fields_);
    set(CURLOPT_USERAGENT, agent.c_str());
    if (!options.ca_file.empty())
        set(CURLOPT_CAINFO, options.ca_file.c_str());
    set(CURLOPT_NOSIGNAL, 1L); // the tool handles signals, see interrupt.h
    set(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(options.connect_timeout.count()));
    set(CURLOPT_LOW_SPEED_LIMIT, static_cast<long>(options.stall_bytes));
    set(CURLOPT_LOW_SPEED_TIME, static_cast<long>(options.stall_timeout.count()));
    set(CURLOPT_TIMEOUT, static_cast<long>(std::min<std::uint64_t>(longest_seconds, 1 << 30)));
    set(CURLOPT_BUFFERSIZE, 128L << 10);
    set(CURLOPT_ERRORBUFFER, error_);
    set(CURLOPT_PRIVATE, static_cast<void*>(this));
    set(CURLOPT_HEADERFUNCTION, &HttpAttempt::on_head);
    set(CURLOPT_HEADERDATA, static_cast<void*>(this));
    set(CURLOPT_WRITEFUNCTION, &HttpAttempt::on_body);
    set(CURLOPT_WRITEDATA, static_cast<void*>(this));
    return good;
}

// No exception may pass through libcurl, which is written in C.
template <class Take> std::size_t HttpAttempt::guard(std::size_t bytes, const Take& take) {
    try {
        refused_ = take();
    } catch (const std::exception& e) { // bad_alloc above all
        refused_ = {ErrorCode::runtime, e.what()};
    }
    return refused_.ok() ? bytes : 0;
}

std::size_t HttpAttempt::on_head(char* data, std::size_t size, std::size_t count, void* self) {
    auto& attempt = *static_cast<HttpAttempt*>(self);
    return attempt.guard(size * count, [&] { return attempt.take_head({data, size * count}); });
}

std::size_t HttpAttempt::on_body(char* data, std::size_t size, std::size_t count, void* self) {
    auto& attempt = *static_cast<HttpAttempt*>(self);
    const std::size_t bytes = size * count;
    return attempt.guard(bytes,
                         [&] { return attempt.take_body(std::as_bytes(std::span(data, bytes))); });
}

Status HttpAttempt::take_head(std::string_view line) {
    head_bytes_ += line.size();
    if (head_bytes_ > max_head_bytes)
        return {ErrorCode::io, "the head of the server's response is too long"};
    add_head_line(head_, line);
    return {};
}

Status HttpAttempt::begin() {
    begun_ = true;
    if (!head_.field("content-encoding").empty() && head_.field("content-encoding") != "identity")
        return {ErrorCode::unsupported,
                "the server sends the file compressed, so that byte ranges are impossible"};
    return request_.receiver->begin(head_);
}

Status HttpAttempt::take_body(std::span<const std::byte> bytes) {
    received_ += bytes.size();
    if (is_temporary(head_.status)) {
        discarded_ += bytes.size();
        if (discarded_ > max_discarded_bytes)
            return {ErrorCode::io, "the server answers " + describe_status(head_.status) +
                                       " with a body that is too long"};
        return {};
    }
    if (!begun_)
        TESSERA_TRY(begin());
    return request_.receiver->receive(bytes);
}

HttpAttempt::Outcome HttpAttempt::finish(CURLcode code) {
    if (!refused_.ok())
        return {refused_, false, {}};
    if (code == CURLE_TOO_MANY_REDIRECTS)
        return {{ErrorCode::io,
                 "the server redirects more than " + std::to_string(redirects_) + " times"},
                false,
                {}};
    if (code != CURLE_OK) {
        const std::string said = error_[0] != 0 ? error_ : curl_easy_strerror(code);
        return {{ErrorCode::io, printable(said)}, is_temporary(code), {}};
    }
    if (is_temporary(head_.status)) {
        curl_off_t seconds = 0;
        curl_easy_getinfo(handle_, CURLINFO_RETRY_AFTER, &seconds);
        const auto most = static_cast<curl_off_t>(longest_retry_after.count());
        return {{ErrorCode::io, "the server answers " + describe_status(head_.status)},
                true,
                std::chrono::seconds(std::clamp<curl_off_t>(seconds, 0, most))};
    }
    if (!begun_)
        if (Status status = begin(); !status.ok())
            return {status, false, {}};
    return {request_.receiver->end(), true, {}};
}

} // namespace tessera
