#include "tools/http/http_receivers.h"

#include <algorithm>

namespace tessera {
namespace {

Status io_error(const std::string& text) {
    return {ErrorCode::io, text};
}

Status changed(const std::string& how) {
    return io_error("the file changed on the server while it was being read (" + how + ")");
}

std::string range_text(std::uint64_t first, std::uint64_t last) {
    return std::to_string(first) + "-" + std::to_string(last);
}

Status wrong_range(const std::string& asked, const ContentRange& got) {
    return io_error("the server sends bytes " + range_text(got.first, got.last) +
                    " instead of bytes " + asked);
}

Status too_much(std::uint64_t expected) {
    return io_error("the server sends more than the " + std::to_string(expected) +
                    " bytes that were requested");
}

Status too_little(std::uint64_t got, std::uint64_t expected) {
    return io_error("the server sends only " + std::to_string(got) + " of " +
                    std::to_string(expected) + " bytes");
}

// The Content-Range of a 206.
Result<ContentRange> range_of(const HttpHead& head) {
    const auto range = parse_content_range(head.field("content-range"));
    if (!range || !range->has_range)
        return io_error("the server does not say which part of the file it sends "
                        "(no valid Content-Range)");
    if (!range->total)
        return io_error("the server does not say how long the file is");
    return *range;
}

} // namespace

// ---------------------------------------------------------------- opening

Status OpeningReceiver::begin(const HttpHead& head) {
    bytes.clear();
    version = {0, head.field("etag"), head.field("last-modified")};
    whole_ = head.status == 200;
    empty_ = false;
    if (whole_)
        return begin_whole(head);
    if (head.status == 206)
        return begin_part(head);
    const auto range = parse_content_range(head.field("content-range"));
    empty_ = head.status == 416 && range && range->total == 0; // the file has no first byte
    if (empty_)
        return {};
    return io_error("the server answers " + describe_status(head.status));
}

Status OpeningReceiver::begin_whole(const HttpHead& head) {
    const auto length = parse_decimal(head.field("content-length"));
    if (length && *length > max_whole_)
        return {ErrorCode::unsupported,
                "the server does not support byte ranges, and the file has " +
                    std::to_string(*length) + " bytes, more than the " +
                    std::to_string(max_whole_) + " that are kept in memory"};
    return {};
}

Status OpeningReceiver::begin_part(const HttpHead& head) {
    TESSERA_TRY_ASSIGN(const ContentRange range, range_of(head));
    version.size = *range.total;
    expected_ = std::min(wanted_, version.size);
    if (range.first != 0 || range.last != expected_ - 1)
        return wrong_range(range_text(0, expected_ - 1), range);
    return {};
}

Status OpeningReceiver::receive(std::span<const std::byte> more) {
    if (empty_)
        return {}; // the text of the error
    if (whole_ && more.size() > max_whole_ - bytes.size())
        return {ErrorCode::unsupported,
                "the server does not support byte ranges, and the file has more than the " +
                    std::to_string(max_whole_) + " bytes that are kept in memory"};
    if (!whole_ && more.size() > expected_ - bytes.size())
        return too_much(expected_);
    bytes.insert(bytes.end(), more.begin(), more.end());
    return {};
}

Status OpeningReceiver::end() {
    if (whole_)
        version.size = bytes.size();
    else if (!empty_ && bytes.size() < expected_)
        return too_little(bytes.size(), expected_);
    return {};
}

// ---------------------------------------------------------------- parts

Status PartReceiver::begin(const HttpHead& head) {
    got_ = 0;
    if (head.status == 412)
        return changed("412, precondition failed");
    if (head.status == 416)
        return changed("416, the range does not exist");
    if (head.status == 200)
        return io_error("the server sends the whole file instead of a part");
    if (head.status != 206)
        return io_error("the server answers " + describe_status(head.status));
    TESSERA_TRY_ASSIGN(const ContentRange range, range_of(head));
    if (*range.total != version_.size)
        return changed("it had " + std::to_string(version_.size) + " bytes and has " +
                       std::to_string(*range.total));
    if (head.field("etag") != version_.etag)
        return changed("another ETag");
    if (head.field("last-modified") != version_.last_modified)
        return changed("another Last-Modified");
    const std::uint64_t last = offset_ + out_.size() - 1;
    if (range.first != offset_ || range.last != last)
        return wrong_range(range_text(offset_, last), range);
    return {};
}

Status PartReceiver::receive(std::span<const std::byte> bytes) {
    if (bytes.size() > out_.size() - got_)
        return too_much(out_.size());
    std::ranges::copy(bytes, out_.begin() + static_cast<std::ptrdiff_t>(got_));
    got_ += bytes.size();
    return {};
}

Status PartReceiver::end() {
    return got_ == out_.size() ? Status() : too_little(got_, out_.size());
}

} // namespace tessera
