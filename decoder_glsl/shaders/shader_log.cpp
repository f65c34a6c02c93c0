#include "decoder_glsl/shaders/shader_log.h"

#include <charconv>
#include <map>
#include <optional>
#include <utility>

namespace tessera {
namespace {

using Place = std::pair<unsigned, unsigned>; // source string, line

std::optional<unsigned> take_number(std::string_view& text) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end == text.data())
        return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

bool take(std::string_view& text, std::string_view word) {
    if (!text.starts_with(word))
        return false;
    text.remove_prefix(word.size());
    return true;
}

std::string_view take_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    return line;
}

std::optional<Place> named_place(std::string_view message) {
    while (take(message, " ") || take(message, "ERROR:") || take(message, "WARNING:"))
        ;
    const auto source = take_number(message);
    if (!source || !(take(message, ":") || take(message, "(")))
        return std::nullopt;
    const auto line = take_number(message);
    if (!line)
        return std::nullopt;
    return Place(*source, *line);
}

struct SourceMap {
    std::map<Place, std::string_view> lines;
    std::map<unsigned, std::string_view> names;
};

SourceMap map_source(std::string_view source) {
    SourceMap map;
    Place next(0, 1);
    while (!source.empty()) {
        const std::string_view line = take_line(source);
        std::string_view rest = line;
        if (take(rest, "// source ")) {
            if (const auto number = take_number(rest); number && take(rest, ": "))
                map.names[*number] = rest;
        } else if (take(rest, "#line ")) {
            if (const auto number = take_number(rest)) {
                next.second = *number;
                if (take(rest, " "))
                    next.first = take_number(rest).value_or(next.first);
                continue;
            }
        }
        map.lines.try_emplace(next, line);
        ++next.second;
    }
    return map;
}

} // namespace

std::string explain_shader_log(std::string_view log, std::string_view source) {
    const SourceMap map = map_source(source);
    std::string text;
    while (!log.empty()) {
        const std::string_view message = take_line(log);
        if (message.find_first_not_of(std::string_view(" \t\r\0", 4)) == std::string_view::npos)
            continue;
        text.append(message).append("\n");
        const auto place = named_place(message);
        if (!place)
            continue;
        const auto line = map.lines.find(*place);
        if (line == map.lines.end())
            continue;
        const auto name = map.names.find(place->first);
        text.append("    ");
        if (name != map.names.end())
            text.append(name->second).append(":");
        text.append(std::to_string(place->second)).append(" | ").append(line->second).append("\n");
    }
    return text;
}

} // namespace tessera
