#include "tools/http/http_source.h"

#include "format/byte_source.h"

#include <algorithm>
#include <curl/curl.h>
#include <list>

namespace tessera {
namespace {

// The URL without user and password, for messages.
Result<std::string> name_of_url(const std::string& url) {
    const std::unique_ptr<CURLU, void (*)(CURLU*)> parsed(curl_url(), curl_url_cleanup);
    if (parsed == nullptr)
        return Status(ErrorCode::runtime, url + ": out of memory");
    if (const CURLUcode code = curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0);
        code != CURLUE_OK)
        return Status(ErrorCode::bad_argument,
                      url + ": is not a URL: " + std::string(curl_url_strerror(code)));
    char* text = nullptr;
    curl_url_set(parsed.get(), CURLUPART_USER, nullptr, 0);
    curl_url_set(parsed.get(), CURLUPART_PASSWORD, nullptr, 0);
    if (curl_url_get(parsed.get(), CURLUPART_URL, &text, 0) != CURLUE_OK)
        return Status(ErrorCode::bad_argument, "the URL cannot be read");
    const std::string name = text;
    curl_free(text);
    return name;
}

// Fields that make a server refuse to send parts of another version. A weak ETag never matches.
std::vector<std::string> conditions(const HttpVersion& version) {
    if (version.etag.starts_with('"'))
        return {"If-Match: " + version.etag};
    if (!version.last_modified.empty())
        return {"If-Unmodified-Since: " + version.last_modified};
    return {};
}

// One merged request. It writes into the buffer of its reader if that is the only one, else into
// its own.
struct Part {
    Part(const HttpVersion& version, const MergedRead& merged,
         std::span<const ReadRequest> requests)
        : own(merged.requests.size() > 1 ? static_cast<std::size_t>(merged.length) : 0),
          receiver(version, merged.offset,
                   own.empty() ? requests[merged.requests.front()].out : std::span(own)) {}
    std::vector<std::byte> own;
    PartReceiver receiver;
};

} // namespace

Result<std::unique_ptr<HttpSource>> HttpSource::open(const std::string& url,
                                                     const HttpOptions& options) {
    TESSERA_TRY_ASSIGN(const std::string name, name_of_url(url));
    TESSERA_TRY_ASSIGN(auto transfers, HttpTransfers::create(url, name, options));
    OpeningReceiver first(first_read_bytes, options.max_whole_bytes);
    const HttpRequest request{0, first_read_bytes - 1, options.max_whole_bytes, &first};
    TESSERA_TRY(transfers->run(std::span(&request, 1)));
    transfers->set_fields(conditions(first.version));
    std::unique_ptr<HttpSource> source(new HttpSource);
    source->name_ = name;
    source->transfers_ = std::move(transfers);
    source->version_ = std::move(first.version);
    source->start_ = std::move(first.bytes);
    return source;
}

bool HttpSource::is_at_hand(const ReadRequest& request) const {
    return request.offset + request.out.size() <= start_.size();
}

Status HttpSource::read(std::uint64_t offset, std::span<std::byte> out) {
    const ReadRequest request{offset, out};
    return read_many(std::span(&request, 1));
}

Status HttpSource::read_many(std::span<const ReadRequest> requests) {
    std::vector<ReadRequest> missing;
    for (const ReadRequest& request : requests) {
        TESSERA_TRY(check_range(*this, request.offset, request.out.size()));
        if (!is_at_hand(request))
            missing.push_back(request);
        else if (!request.out.empty())
            std::ranges::copy(std::span(start_).subspan(request.offset, request.out.size()),
                              request.out.begin());
    }
    if (missing.empty())
        return {};
    const std::vector<MergedRead> plan = merge_reads(missing);
    std::list<Part> parts;
    std::vector<HttpRequest> wanted;
    for (const MergedRead& merged : plan) {
        parts.emplace_back(version_, merged, missing);
        wanted.push_back({merged.offset, merged.offset + merged.length - 1, merged.length,
                          &parts.back().receiver});
    }
    TESSERA_TRY(transfers_->run(wanted));
    auto part = parts.begin();
    for (const MergedRead& merged : plan) {
        if (!part->own.empty())
            for (const std::size_t i : merged.requests)
                std::ranges::copy(std::span(part->own).subspan(
                                      static_cast<std::size_t>(missing[i].offset - merged.offset),
                                      missing[i].out.size()),
                                  missing[i].out.begin());
        ++part;
    }
    return {};
}

} // namespace tessera
