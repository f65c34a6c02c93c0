// The head of an HTTP response. It comes from an untrusted server.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

struct HttpHead {
    int status = 0;                            // 0: none was received
    std::map<std::string, std::string> fields; // names in lower case; the last one of a name

    // "" if there is no such field.
    const std::string& field(const std::string& name) const;
};

// Adds one received line to the head. A status line starts a new head, so that after redirects the
// last head remains.
void add_head_line(HttpHead& head, std::string_view line);

// The value of Content-Range: "bytes 0-99/1000", or "bytes */1000" without a range.
struct ContentRange {
    bool has_range = false;
    std::uint64_t first = 0, last = 0;  // bytes, both included, first <= last
    std::optional<std::uint64_t> total; // bytes of the file; none for "*"
};
// Nothing if the text has another form, or a number does not fit into 64 bits.
std::optional<ContentRange> parse_content_range(std::string_view text);

// Parses digits only; nothing if the number does not fit into 64 bits.
std::optional<std::uint64_t> parse_decimal(std::string_view text);

// "404 (Not Found)". The reason is not the server's, which could be any text.
std::string describe_status(int status);

} // namespace tessera
