// What an HTTP server says ahead of the bytes. All of it is checked before it is believed.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

struct HttpHead {
    int status = 0;                            // 0: none came
    std::map<std::string, std::string> fields; // names in lower case; the last of a name counts

    // "" where there is no such field.
    const std::string& field(const std::string& name) const;
};

// Takes one line of a head as it comes in. A status line starts a new head, so that after redirects
// the last one stands.
void add_head_line(HttpHead& head, std::string_view line);

// "bytes 0-99/1000"; "bytes */1000" has no range.
struct ContentRange {
    bool has_range = false;
    std::uint64_t first = 0, last = 0;  // bytes, both included, first <= last
    std::optional<std::uint64_t> total; // bytes of the file; none: "*"
};
// Nothing where the text is anything else, or a number does not fit 64 bits.
std::optional<ContentRange> parse_content_range(std::string_view text);

// Digits alone, in 64 bits.
std::optional<std::uint64_t> parse_decimal(std::string_view text);

// "404 (Not Found)". The reason is ours: a server's own words may hold anything.
std::string describe_status(int status);

} // namespace tessera
