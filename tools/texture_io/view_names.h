// From the names of a folder's pictures to a grid of views: which of them are views, what the numbers
// in their names mean, and whether all are there.
#pragma once

#include "tools/support/texture_hints.h"
#include "tools/texture_io/view_pattern.h"

#include <string>
#include <vector>

namespace tessera {

struct NamedViews {
    ViewPattern pattern;
    ViewOrder order;
    ViewGrid grid;
    std::vector<std::string> names; // of view (s, t) at t * grid.s + s
};

// What the names have in common, as a pattern. view_tTTT_sSSS counts as one whatever else is there.
// Else the numbers that differ from name to name say the place: one is a running number, of two the
// first is the row (the column, with order.columns). Numbers with a decimal point say nothing.
// Errors: bad_argument, where names fit several patterns or the numbers could mean anything; they say
// what to ask for. invalid_file, where there are no pictures.
Result<ViewPattern> recognise_view_names(const std::vector<std::string>& names,
                                         const ViewOrder& order);

// Those of `names` that fit hints.pattern, else the pattern that is recognised. `said`: the grid, where
// the texture's size is known. Without it or hints.grid, running numbers need a square count.
// Counting begins at 0 or at the least number. Errors: those above; invalid_file, which name the file:
// one that is missing, two for one view, or one outside the grid.
Result<NamedViews> arrange_views(const std::vector<std::string>& names, const ViewHints& hints,
                                 const std::optional<ViewGrid>& said);

// The name of the view at `place` of a grid whose numbers begin at 0.
std::string view_name(const ViewPattern& pattern, const ViewOrder& order, const ViewGrid& grid,
                      const ViewPlace& place);

} // namespace tessera
