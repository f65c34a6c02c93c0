// A file on an HTTP(S) server as a source of bytes, read with range requests.
#pragma once

#include "format/byte_source.h"
#include "tools/http/http_receivers.h"
#include "tools/http/http_transfers.h"

#include <memory>
#include <string>
#include <vector>

namespace tessera {

// Opening takes one request, which returns the size and the first bytes; those are kept. After that
// a read() is one request, and a read_many() as few requests as merge_reads() finds, which run at
// the same time. Every response must be the requested part of the file as it was at opening: size,
// ETag and Last-Modified must be equal (the requests have If-Match or If-Unmodified-Since, and the
// responses are compared). Every request follows redirects again, since their targets may expire.
//
// A server without range requests sends the whole file at opening. It is kept in memory, up to
// HttpOptions::max_whole_bytes.
//
// Errors: io (the network; a status such as 404; a wrong response; the file changed), unsupported
// (no ranges and too long), runtime (interrupted). All members are thread-safe.
class HttpSource : public ByteSource {
public:
    // `url`: http:// or https://. Errors: also bad_argument (an invalid URL).
    static Result<std::unique_ptr<HttpSource>> open(const std::string& url,
                                                    const HttpOptions& options = {});

    std::uint64_t size() const override { return version_.size; }
    Status read(std::uint64_t offset, std::span<std::byte> out) override;
    Status read_many(std::span<const ReadRequest> requests) override;
    std::string name() const override { return name_; } // the URL without user and password
    bool wants_prefetch() const override { return start_.size() < version_.size; }

    HttpStatistics statistics() const { return transfers_->statistics(); }

private:
    HttpSource() = default;
    bool is_at_hand(const ReadRequest& request) const;

    std::string name_;
    std::unique_ptr<HttpTransfers> transfers_;
    HttpVersion version_;          // of the file at opening
    std::vector<std::byte> start_; // the file's first bytes, or all of it
};

} // namespace tessera
