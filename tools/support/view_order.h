// The order in which the views of a grid of cameras are numbered. It maps the views of folders and
// quilts to (s, t) and back.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <string>

namespace tessera {

// A grid of cameras with `s` columns and `t` rows.
struct ViewGrid {
    std::uint32_t s = 1, t = 1;
    std::uint64_t count() const { return std::uint64_t{s} * t; }
    bool operator==(const ViewGrid&) const = default;
};

struct ViewPlace {
    std::uint32_t s = 0, t = 0; // from the left, from the top
    auto operator<=>(const ViewPlace&) const = default;
};

// By default line by line from the top left, where a line is a row; the first line has t = 0.
struct ViewOrder {
    bool columns = false;    // a line is a column, and the first of two numbers counts columns
    bool serpentine = false; // every other line runs backwards
    bool bottom_up = false;  // the first row is the lowest
    bool right_left = false; // the first column is the one on the right
    bool operator==(const ViewOrder&) const = default;
};

// Words joined by commas: rows, columns, serpentine, bottom-up, right-left. Errors: bad_argument.
Result<ViewOrder> parse_view_order(const std::string& text);
// The same words; "" for the default order.
std::string to_string(const ViewOrder& order);

// The camera of view `step` in line `line`, and the inverse. Preconditions: inside the grid.
ViewPlace place_in(const ViewGrid& grid, const ViewOrder& order, std::uint32_t line,
                   std::uint32_t step);
struct ViewStep {
    std::uint32_t line = 0, step = 0;
};
ViewStep step_of(const ViewGrid& grid, const ViewOrder& order, const ViewPlace& place);
// Views per line.
inline std::uint32_t line_length(const ViewGrid& grid, const ViewOrder& order) {
    return order.columns ? grid.t : grid.s;
}

// Parses "17x5", 17 columns and 5 rows; at most 2^20 cameras. Errors: bad_argument.
Result<ViewGrid> parse_view_grid(const std::string& text);
std::string to_string(const ViewGrid& grid);

} // namespace tessera
