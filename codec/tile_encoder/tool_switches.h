// Coding tools that can be switched off one by one, to see what each is worth, or on where an
// effort leaves them out. What they are, and are worth: tests/regression/ablation.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

enum class CodingTool : std::uint8_t {
    copies,
    both,
    half,
    rotation,
    ycocg,
    rotated_search,
    dependent,
    rdo,
    fitted_tables,
    grids,
    smooth,
    refine,
    filter,
    dense_tables,
};

struct CodingToolInfo {
    CodingTool tool;
    const char* name;
};

inline constexpr std::array<CodingToolInfo, 14> coding_tools = {{
    {CodingTool::copies, "copies"},
    {CodingTool::both, "both"},
    {CodingTool::half, "half"},
    {CodingTool::rotation, "rotation"},
    {CodingTool::ycocg, "ycocg"},
    {CodingTool::rotated_search, "rotated-search"},
    {CodingTool::dependent, "dependent"},
    {CodingTool::rdo, "rdo"},
    {CodingTool::fitted_tables, "fitted-tables"},
    {CodingTool::dense_tables, "dense-tables"},
    {CodingTool::grids, "grids"},
    {CodingTool::smooth, "smooth"},
    {CodingTool::filter, "filter"},
    {CodingTool::refine, "refine"},
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

} // namespace tessera
