// In which order the views of a grid of cameras are numbered: how folders and quilts that others
// made become texels (s, t), and back.
#pragma once

#include "format/status.h"

#include <cstdint>
#include <string>

namespace tessera {

// Cameras of a grid, `s` of them side by side and `t` one below the other.
struct ViewGrid {
    std::uint32_t s = 1, t = 1;
    std::uint64_t count() const { return std::uint64_t{s} * t; }
    bool operator==(const ViewGrid&) const = default;
};

struct ViewPlace {
    std::uint32_t s = 0, t = 0; // from the left, from the top
    auto operator<=>(const ViewPlace&) const = default;
};

// Usual is line by line from the top left: the first line holds the cameras at t = 0.
struct ViewOrder {
    bool columns = false;    // a line is a column, and the first of two numbers counts columns
    bool serpentine = false; // every other line runs backwards
    bool bottom_up = false;  // the first row is the lowest
    bool right_left = false; // the first column is the one on the right
    bool operator==(const ViewOrder&) const = default;
};

// Words joined by commas: rows, columns, serpentine, bottom-up, right-left. Errors: bad_argument.
Result<ViewOrder> parse_view_order(const std::string& text);
// The same words; "" for the usual order.
std::string to_string(const ViewOrder& order);

// The place of view `step` of line `line`, and what it was. Preconditions: inside the grid.
ViewPlace place_in(const ViewGrid& grid, const ViewOrder& order, std::uint32_t line,
                   std::uint32_t step);
struct ViewStep {
    std::uint32_t line = 0, step = 0;
};
ViewStep step_of(const ViewGrid& grid, const ViewOrder& order, const ViewPlace& place);
// How many views a line holds.
inline std::uint32_t line_length(const ViewGrid& grid, const ViewOrder& order) {
    return order.columns ? grid.t : grid.s;
}

// "17x5": 17 side by side, 5 one below the other; each 1..2^20, at most 2^20 together. Errors: bad_argument.
Result<ViewGrid> parse_view_grid(const std::string& text);
std::string to_string(const ViewGrid& grid);

} // namespace tessera
