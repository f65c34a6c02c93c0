// Coding tools that can be switched off one by one, to see what each is worth, or on where an
// effort leaves them out. What they are worth: tests/regression/ablation.md.
#pragma once

#include "format/status.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace tessera {

enum class CodingTool : std::uint8_t {
    copies,
    half,
    rotation,
    ycocg,
    rotated_search,
    dependent,
    rdo,
    fitted_tables,
    grids,
    smooth,
    base,
    refine,
    filter,
    dense_tables,
    balance,
    align,
};

struct CodingToolInfo {
    CodingTool tool;
    const char* name;
    const char* help;
};

inline constexpr std::array<CodingToolInfo, 16> coding_tools = {{
    {CodingTool::copies, "copies", "blocks copy from other views"},
    {CodingTool::half, "half", "... displaced by half texels, not only by whole ones"},
    {CodingTool::rotation, "rotation", "blocks choose their colour axes"},
    {CodingTool::ycocg, "ycocg", "YCoCg, not RGB; without it no rotation either"},
    {CodingTool::rotated_search, "rotated-search",
     "the search for blocks knows of rotated colours"},
    {CodingTool::dependent, "dependent", "two quantisers in turn, chosen by a trellis"},
    {CodingTool::rdo, "rdo",
     "levels by rate and distortion, not rounded with a dead zone; without it not dependent "
     "either"},
    {CodingTool::fitted_tables, "fitted-tables", "tables of the file's own, not the built-in ones"},
    {CodingTool::dense_tables, "dense-tables",
     "... learnt from a dense start, too, where a trial finds it better"},
    {CodingTool::grids, "grids", "blocks of all shapes, not only three that halve all sides"},
    {CodingTool::smooth, "smooth", "copies smoothed, where a trial finds that it pays"},
    {CodingTool::base, "base",
     "base pictures that all views copy, where a trial finds that they pay"},
    {CodingTool::align, "align",
     "views of camera grids moved so that most of what they show stands still in a tile"},
    {CodingTool::filter, "filter", "decoded tiles filtered against the quantiser's traces"},
    {CodingTool::refine, "refine", "blocks split and merged where coding them shows that it pays"},
    {CodingTool::balance, "balance", "tiles keep their mean colours"},
}};

// What was asked for on top of an effort. By itself nothing.
class ToolSwitches {
public:
    void set(CodingTool tool, bool on) {
        (on ? on_ : off_) |= bit(tool);
        (on ? off_ : on_) &= ~bit(tool);
    }
    void set_all(bool on) {
        for (const CodingToolInfo& info : coding_tools)
            set(info.tool, on);
    }
    bool is_on(CodingTool tool, bool of_effort) const {
        return (of_effort || (on_ & bit(tool)) != 0) && (off_ & bit(tool)) == 0;
    }
    bool operator==(const ToolSwitches&) const = default;

private:
    static std::uint32_t bit(CodingTool tool) {
        return std::uint32_t{1} << static_cast<unsigned>(tool);
    }
    std::uint32_t on_ = 0, off_ = 0;
};

// The words of EncodeOptions::tools. Errors: bad_argument, which lists the tools.
Result<ToolSwitches> parse_tool_switches(const std::string& text);

} // namespace tessera
