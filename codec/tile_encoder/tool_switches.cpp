#include "codec/tile_encoder/tool_switches.h"

#include "codec/encoder.h"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera {
namespace {

// Letters to insert, drop or replace to make one word of the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({diagonal + 1, row[j] + 1, replaced});
        }
    }
    return row.back();
}

Status unknown_tool(const std::string& word, std::string_view name) {
    const CodingToolInfo* nearest = &coding_tools[0];
    std::string all;
    for (const CodingToolInfo& info : coding_tools) {
        all += (all.empty() ? "" : ", ") + std::string(info.name);
        if (edit_distance(name, info.name) < edit_distance(name, nearest->name))
            nearest = &info;
    }
    std::string text = "'" + word + "' is no coding tool";
    if (edit_distance(name, nearest->name) < std::min<std::size_t>(4, name.size()))
        text += "; did you mean '" + std::string(nearest->name) + "'?";
    return {ErrorCode::bad_argument, text + " (tools: " + all + ")"};
}

Status set_tool(ToolSwitches& switches, const std::string& word) {
    if (word == "none" || word == "all") {
        switches.set_all(word == "all");
        return {};
    }
    const bool has_sign = word.starts_with('+') || word.starts_with('-');
    const std::string_view name = std::string_view(word).substr(has_sign ? 1 : 0);
    for (const CodingToolInfo& info : coding_tools)
        if (name == info.name) {
            if (!has_sign)
                return {ErrorCode::bad_argument, "'" + word + "' needs a sign: +" + word +
                                                     " switches on, -" + word + " off"};
            switches.set(info.tool, word[0] == '+');
            return {};
        }
    return unknown_tool(word, name);
}

} // namespace

Result<ToolSwitches> parse_tool_switches(const std::string& text) {
    ToolSwitches switches;
    for (std::string_view left = text; !left.empty();) {
        const std::size_t comma = left.find(',');
        TESSERA_TRY(set_tool(switches, std::string(left.substr(0, comma))));
        left = comma == std::string_view::npos ? std::string_view() : left.substr(comma + 1);
    }
    return switches;
}

Status check_coding_tools(const std::string& tools) {
    TESSERA_TRY(parse_tool_switches(tools));
    return {};
}

std::string coding_tools_help() {
    std::string text;
    for (const CodingToolInfo& info : coding_tools)
        text += std::string(text.empty() ? "" : "\n") + info.name + ": " + info.help;
    return text;
}

} // namespace tessera
