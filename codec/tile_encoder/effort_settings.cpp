#include "codec/tile_encoder/effort_settings.h"

#include "codec/encoder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {
namespace {

constexpr std::uint64_t grid(int spatial, int angular) {
    return std::uint64_t{1} << (spatial * 8 + angular);
}

// Halving all four sides together costs 18 % more bits than the free tree (38 dB, composed scene);
// other sets of four grids cost 18 to 32 %. Three more grids reduce that to 11 %.
constexpr std::uint64_t halvings = grid(1, 1) | grid(2, 2) | grid(3, 3);
constexpr std::uint64_t four = halvings | grid(0, 0);
constexpr std::uint64_t seven = four | grid(0, 1) | grid(1, 2) | grid(2, 3);
constexpr std::uint64_t all = ~std::uint64_t{0};

struct EffortRow {
    std::uint64_t grids;
    bool rotation, dependent, recode;
    // The search for copies, see DisplacementRange: in half texels per view. The parallax of most
    // textures is a few texels. 0 rounds: no copies, and no filter either.
    int along, across, likely, rounds;
    bool dense_tables, both_fills;
    int refinements;
    PictureSearch pictures, small_pictures; // small ones take little time however they are searched
};

constexpr bool on = true, off = false;
// Modes coded, transformed; no transform, halves, quarters, crossed halves, plane trees, careful trees
constexpr PictureSearch quick_search{1, 0, off, off, off, off, off, off},
    usual_search{2, 1, on, on, off, off, on, off}, small_search{2, 2, on, on, on, off, on, on},
    careful_search{3, 3, on, on, on, on, on, on};
constexpr std::array<EffortRow, most_effort + 1> effort_rows = {{
    // grids rotation, dependent, recode; copies; dense tables, both fills, refinements, pictures
    {four, off, off, off, 0, 0, 0, 0, off, on, 0, {}, {}},
    {seven, on, off, on, 0, 0, 0, 0, off, on, 0, {}, {}},
    {seven, on, on, on, 8, 4, 24, 1, off, off, 0, quick_search, quick_search},
    {all, on, on, on, 24, 10, 60, 2, on, off, 1, usual_search, small_search},
    {all, on, on, on, 24, 10, 0, 4, on, on, 2, careful_search, careful_search},
}};
// If a tool switch adds copies to an effort that has none.
constexpr DisplacementRange usual_range{8, 4};

} // namespace

EffortSettings EffortSettings::of(int effort, const ToolSwitches& tools, bool is_small_picture) {
    const EffortRow& level = effort_rows[effort];
    const bool level_copies = level.rounds > 0;
    const bool copies = tools.is_on(CodingTool::copies, level_copies);
    const bool grids_asked_for = tools.is_on(CodingTool::grids, false);
    EffortSettings settings;
    settings.search.grids = !tools.is_on(CodingTool::grids, true) ? halvings
                            : grids_asked_for                     ? all
                                                                  : level.grids;
    settings.ycocg = tools.is_on(CodingTool::ycocg, true);
    settings.rotate_colours = settings.ycocg && tools.is_on(CodingTool::rotation, level.rotation);
    settings.chroma_from_luma = tools.is_on(CodingTool::chroma_from_luma, true);
    settings.search.rotated_colours = tools.is_on(CodingTool::rotated_search, level.rotation);
    settings.quantizer.optimise = tools.is_on(CodingTool::rdo, true);
    settings.dependent =
        settings.quantizer.optimise && tools.is_on(CodingTool::dependent, level.dependent);
    settings.fit_tables = tools.is_on(CodingTool::fitted_tables, true);
    settings.recode = tools.is_on(CodingTool::fitted_tables, level.recode);
    settings.try_dense = tools.is_on(CodingTool::dense_tables, level.dense_tables);
    if (copies)
        settings.search.copies =
            level_copies ? DisplacementRange{level.along, level.across, true, level.likely}
                         : usual_range;
    settings.search.copies.half = tools.is_on(CodingTool::half, true);
    settings.quick = settings.search.skip_hollow = !level_copies;
    settings.code_both_fills = level.both_fills;
    settings.copy_rounds = std::max(level.rounds, 1);
    settings.try_smooth = copies && tools.is_on(CodingTool::smooth, level_copies);
    settings.try_base = copies && tools.is_on(CodingTool::base, level.rounds > 1);
    if (copies)
        settings.pictures = !level_copies      ? quick_search
                            : is_small_picture ? level.small_pictures
                                               : level.pictures;
    PictureSearch& pictures = settings.pictures;
    pictures.borders = tools.is_on(CodingTool::borders, true);
    pictures.planar = tools.is_on(CodingTool::planar, true);
    pictures.directions = tools.is_on(CodingTool::directions, true);
    pictures.halves = tools.is_on(CodingTool::picture_splits, pictures.halves);
    pictures.quarters = tools.is_on(CodingTool::picture_splits, pictures.quarters);
    pictures.crossed_halves = tools.is_on(CodingTool::picture_splits, pictures.crossed_halves);
    if (!tools.is_on(CodingTool::sines, pictures.transform_modes > 0))
        pictures.transform_modes = 0;
    else
        pictures.transform_modes = std::max(pictures.transform_modes, 1);
    pictures.no_transform =
        pictures.transform_modes > 0 && tools.is_on(CodingTool::no_transform, true);
    pictures.plane_trees = tools.is_on(CodingTool::plane_trees, pictures.plane_trees);
    settings.try_alignment = tools.is_on(CodingTool::align, level_copies);
    settings.balance = tools.is_on(CodingTool::balance, true);
    settings.filter = tools.is_on(CodingTool::filter, level_copies);
    if (tools.is_on(CodingTool::refine, level.refinements > 0))
        settings.refinements = std::max(level.refinements, 1);
    else
        settings.refinements = 0;
    return settings;
}

PictureSearch EffortSettings::quick_pictures() const {
    PictureSearch quick = pictures;
    quick.coded_modes = std::min(quick.coded_modes, 1);
    quick.transform_modes = 0;
    quick.halves = quick.quarters = quick.crossed_halves = false;
    return quick;
}

EffortSettings EffortSettings::for_samples() const {
    EffortSettings settings = *this;
    settings.refinements = 0;
    settings.balance = false;
    return settings;
}

} // namespace tessera
