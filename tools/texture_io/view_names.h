// From the names of a folder's pictures to a grid of views: which pictures are views, what the
// numbers in their names mean, and whether the grid is complete.
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
    // Nothing says whether rows or columns are counted first: neither an option nor a letter such as
    // x and y in the names.
    bool axes_are_guessed = false;
};

// Detects the pattern of the names. view_tTTT_sSSS wins whatever other pictures there are.
// Otherwise the numbers that differ from name to name give the position: one is a running number; of
// two behind x, u, s, c, col or column and y, v, t, r or row, the former is the column; of two others
// the first is the row (the column, with order.columns). Numbers with a decimal point are
// ignored. Errors: bad_argument, where names fit several patterns or none; the message names the
// option that decides.
Result<ViewPattern> recognise_view_names(const std::vector<std::string>& names,
                                         const ViewOrder& order);

// Arranges the `names` that match hints.pattern or, without one, the detected pattern.
// `known_grid`: from the texture's size. Without it and hints.grid, running numbers must form a
// square. Numbers begin at 0 or at the smallest one. Errors: those above; invalid_file, naming the
// file, where a view is missing, occurs twice or is outside the grid.
Result<NamedViews> arrange_views(const std::vector<std::string>& names, const ViewHints& hints,
                                 const std::optional<ViewGrid>& known_grid);

// The name of the view at `place` in a grid whose numbers begin at 0.
std::string view_name(const ViewPattern& pattern, const ViewOrder& order, const ViewGrid& grid,
                      const ViewPlace& place);

} // namespace tessera
