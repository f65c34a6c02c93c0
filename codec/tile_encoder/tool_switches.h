// Coding tools that experiments switch on or off on top of an effort. What each tool is worth:
// tests/regression/ablation.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

enum class CodingTool : std::uint8_t {
    copies,         // blocks copy from other views
    half,           // copies may be displaced by half texels
    rotation,       // blocks choose their colour axes
    ycocg,          // YCoCg instead of RGB; without it there is no rotation either
    rotated_search, // the block search considers rotated colours
    dependent,      // two quantisers in turn, chosen by a trellis
    rdo,            // levels by rate and distortion; without it there is no dependent quantisation
    fitted_tables,  // tables fitted to the file
    dense_tables,   // tables are also learnt from a dense start, if a trial finds that better
    grids,          // blocks of all shapes instead of three that halve all sides
    smooth,         // smoothed copies, if a trial finds that they pay
    base,           // base pictures that all views copy, if a trial finds that they pay
    align,          // views of camera grids are moved so that most of what they show stands still
    filter,         // decoded tiles are filtered
    refine,         // blocks are split and merged where coding them shows that it pays
    balance,        // tiles keep their mean colours
    borders,        // blocks of pictures are predicted from the texels beside them
    picture_splits, // blocks of pictures are also cut into halves and quarters along u or v
    chroma_from_luma, // Co and Cg of a block are predicted from its luma
    sines,            // residuals in pictures are transformed with sines or cosines
    no_transform,     // residuals in pictures are coded as they are along one axis or both
    plane_trees,      // each of two channels of a picture may have a tree of its own
    planar,           // borders may be continued as a plane
    directions,       // borders may be continued along 32 directions
};

inline constexpr std::array coding_tool_names = {"copies",
                                                 "half",
                                                 "rotation",
                                                 "ycocg",
                                                 "rotated-search",
                                                 "dependent",
                                                 "rdo",
                                                 "fitted-tables",
                                                 "dense-tables",
                                                 "grids",
                                                 "smooth",
                                                 "base",
                                                 "align",
                                                 "filter",
                                                 "refine",
                                                 "balance",
                                                 "borders",
                                                 "picture-splits",
                                                 "chroma-from-luma",
                                                 "sines",
                                                 "no-transform",
                                                 "plane-trees",
                                                 "planar",
                                                 "directions"};

// Overrides of an effort's choice; without any, the effort decides.
class ToolSwitches {
public:
    void set(CodingTool tool, bool on) {
        (on ? on_ : off_) |= bit(tool);
        (on ? off_ : on_) &= ~bit(tool);
    }
    void set_all(bool on) {
        for (std::size_t tool = 0; tool < coding_tool_names.size(); ++tool)
            set(static_cast<CodingTool>(tool), on);
    }
    bool is_on(CodingTool tool, bool effort_has_it) const {
        return (effort_has_it || (on_ & bit(tool)) != 0) && (off_ & bit(tool)) == 0;
    }

private:
    static std::uint32_t bit(CodingTool tool) {
        return std::uint32_t{1} << static_cast<unsigned>(tool);
    }
    std::uint32_t on_ = 0, off_ = 0;
};

} // namespace tessera
