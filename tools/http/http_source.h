// A file on an HTTP(S) server as a source of bytes, read by range requests.
#pragma once

#include "format/byte_source.h"
#include "tools/http/http_receivers.h"
#include "tools/http/http_transfers.h"

#include <memory>
#include <string>
#include <vector>

namespace tessera {

// Opening costs one request, which brings the size and the first bytes; those are kept. After that a
// read() is one request, and a read_many() as few as merge_reads() (format/byte_source.h) makes of it,
// in flight together. Every answer must be the part that was asked for, of the file as it was when it
// was opened: same size, ETag and Last-Modified (asked for by If-Match or If-Unmodified-Since, and
// compared). A redirect is followed anew by every request, since its target may expire.
//
// A server without ranges sends the whole file to begin with: it is kept in memory where it is no
// longer than HttpOptions::max_whole_bytes.
//
// Errors: io (the network; a status such as 404; an answer that is not what was asked for; the file
// changed), unsupported (no ranges and too long), runtime (interrupted). All members are thread-safe.
class HttpSource : public ByteSource {
public:
    // `url`: http:// or https://. Errors: also bad_argument (no valid URL).
    static Result<std::unique_ptr<HttpSource>> open(const std::string& url,
                                                    const HttpOptions& options = {});

    std::uint64_t size() const override { return version_.size; }
    Status read(std::uint64_t offset, std::span<std::byte> out) override;
    Status read_many(std::span<const ReadRequest> requests) override;
    std::string name() const override { return name_; } // the URL without name and password
    bool wants_prefetch() const override { return start_.size() < version_.size; }

    HttpStatistics statistics() const { return transfers_->statistics(); }

private:
    HttpSource() = default;
    bool is_at_hand(const ReadRequest& request) const;

    std::string name_;
    std::unique_ptr<HttpTransfers> transfers_;
    HttpVersion version_;          // of all parts
    std::vector<std::byte> start_; // the file's first bytes, or all of it
};

} // namespace tessera
