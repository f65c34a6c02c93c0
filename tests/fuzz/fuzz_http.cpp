// Text from HTTP servers and clients. The first line of the input is a requested path, the second a
// range or a Content-Range, and the rest is the head of a response and its body.
#include "tests/fuzz/fuzz_target.h"
#include "tools/http/http_receivers.h"
#include "tools/http/http_response.h"
#include "tools/server/file_server_paths.h"
#include "tools/server/file_server_ranges.h"

#include <cstring>

namespace tessera::fuzz::http {
namespace {

constexpr std::uint64_t file_bytes = 1000;

std::string_view take_line(std::string_view& text) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    return line;
}

void check_content_range(std::string_view text) {
    const auto range = parse_content_range(text);
    if (range && range->has_range)
        require(range->first <= range->last, "a range that ends before it begins");
}

// For any head a receiver must refuse the body or stay within its buffer.
void receive(const HttpHead& head, std::span<const std::byte> body) {
    const HttpVersion version{file_bytes, "\"v\"", ""};
    Bytes out(10);
    PartReceiver part(version, 20, out);
    if (part.begin(head).ok() && part.receive(body).ok())
        (void)part.end();
    OpeningReceiver opening(8192, 4096);
    if (opening.begin(head).ok() && opening.receive(body).ok() && opening.end().ok())
        require(opening.bytes.size() <= opening.version.size, "more bytes than the file has");
}

void check_ranges(std::string_view text) {
    std::vector<std::pair<std::int64_t, std::int64_t>> ranges;
    for (; text.size() >= 16; text.remove_prefix(16)) {
        std::int64_t two[2];
        std::memcpy(two, text.data(), sizeof two);
        ranges.emplace_back(std::max<std::int64_t>(two[0], -1), std::max<std::int64_t>(two[1], -1));
    }
    for (const FilePart& part : parts_of(ranges, file_bytes))
        require(part.first <= part.last && part.last < file_bytes, "a part outside the file");
}

} // namespace

std::vector<Bytes> seeds() {
    return {bytes_of("/a/b.tess\nbytes 0-99/1000\nHTTP/1.1 206 Partial Content\r\nETag: \"v\"\r\n"
                     "Content-Range: bytes 20-29/1000\r\nContent-Length: 10\r\n\r\n0123456789"),
            bytes_of("/%2e%2e/x\nbytes */1000\nHTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\n12345"),
            bytes_of(std::string("/\n") + std::string("\0\0\0\0\0\0\0\0\5\0\0\0\0\0\0\0", 16) +
                     "\nHTTP/1.1 416 x\r\nContent-Range: bytes */0\r\n\r\n")};
}

void run(const std::uint8_t* data, std::size_t size) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    static const std::filesystem::path root = "/usr/include/linux";
    const std::string path(take_line(text));
    if (const auto found = find_served(root, path))
        require(found->string().starts_with(root.string()), "a path outside the folder");
    const std::string_view range = take_line(text);
    check_content_range(range);
    check_ranges(range);
    (void)parse_decimal(range);
    HttpHead head;
    while (!text.empty()) {
        const std::string_view line = take_line(text);
        if (line.empty() || line == "\r")
            break;
        add_head_line(head, line);
    }
    check_content_range(head.field("content-range"));
    receive(head, std::as_bytes(std::span(text)));
}

const Registered registered({.name = "fuzz_http", .seeds = seeds, .run = run});

} // namespace tessera::fuzz::http
