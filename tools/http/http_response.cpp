#include "tools/http/http_response.h"

#include <algorithm>
#include <charconv>

namespace tessera {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    return text;
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

} // namespace

const std::string& HttpHead::field(const std::string& name) const {
    static const std::string none;
    const auto found = fields.find(name);
    return found == fields.end() ? none : found->second;
}

void add_head_line(HttpHead& head, std::string_view line) {
    line = trimmed(line);
    if (line.starts_with("HTTP/")) {
        head = {};
        const std::size_t space = line.find(' ');
        if (space != line.npos)
            head.status = static_cast<int>(
                parse_decimal(trimmed(line.substr(space + 1)).substr(0, 3)).value_or(0));
        return;
    }
    if (const std::size_t colon = line.find(':'); colon != line.npos)
        head.fields[lower_case(trimmed(line.substr(0, colon)))] = trimmed(line.substr(colon + 1));
}

std::optional<std::uint64_t> parse_decimal(std::string_view text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

std::optional<ContentRange> parse_content_range(std::string_view text) {
    if (lower_case(text.substr(0, 6)) != "bytes ")
        return std::nullopt;
    text = trimmed(text.substr(6));
    const std::size_t slash = text.find('/');
    if (slash == text.npos)
        return std::nullopt;
    ContentRange range;
    const std::string_view total = text.substr(slash + 1), part = text.substr(0, slash);
    if (total != "*" && !(range.total = parse_decimal(total)))
        return std::nullopt;
    if (part == "*")
        return range;
    const std::size_t dash = part.find('-');
    const auto first = parse_decimal(part.substr(0, dash));
    const auto last = parse_decimal(dash == part.npos ? "" : part.substr(dash + 1));
    if (!first || !last || *first > *last || (range.total && *last >= *range.total))
        return std::nullopt;
    range.has_range = true;
    range.first = *first;
    range.last = *last;
    return range;
}

std::string describe_status(int status) {
    static const std::map<int, const char*> known = {
        {200, "OK"},
        {206, "Partial Content"},
        {301, "Moved Permanently"},
        {302, "Found"},
        {304, "Not Modified"},
        {400, "Bad Request"},
        {401, "Unauthorized"},
        {403, "Forbidden"},
        {404, "Not Found"},
        {408, "Request Timeout"},
        {410, "Gone"},
        {412, "Precondition Failed"},
        {416, "Range Not Satisfiable"},
        {429, "Too Many Requests"},
        {500, "Internal Server Error"},
        {502, "Bad Gateway"},
        {503, "Service Unavailable"},
        {504, "Gateway Timeout"},
    };
    const auto found = known.find(status);
    return std::to_string(status) +
           (found == known.end() ? "" : std::string(" (") + found->second + ")");
}

} // namespace tessera
