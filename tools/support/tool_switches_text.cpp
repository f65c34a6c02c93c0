#include "tools/support/tool_switches_text.h"

#include "tools/support/parse.h"

#include <algorithm>

namespace tessera {
namespace {

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

Result<ToolSwitches> parse_tool_switches(std::string_view text) {
    ToolSwitches switches;
    while (!text.empty()) {
        const std::size_t comma = text.find(',');
        TESSERA_TRY(set_tool(switches, std::string(text.substr(0, comma))).with_context("--tools"));
        text = comma == std::string_view::npos ? std::string_view() : text.substr(comma + 1);
    }
    return switches;
}

} // namespace tessera
