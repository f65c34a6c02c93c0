// Where the names of lines stand in a plot, so that none covers another.
#pragma once

#include <string>
#include <vector>

namespace tessera {

struct PlotPoint {
    double x = 0, y = 0;
};

struct PlotBox {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0; // y grows downwards
};

struct LabelledLine {
    std::string name;
    std::vector<PlotPoint> points; // by ascending x, at least one
};

struct LabelPlace {
    PlotBox box;
    bool leader = false; // far from its line: draw a thin line from `from`
    PlotPoint from;
};

// One place per line, inside `plot`. Names stand at an end of their line where there is room, else
// beside another of its points, else in a free place of the plot with a leader.
std::vector<LabelPlace> place_labels(const std::vector<LabelledLine>& lines, const PlotBox& plot);

} // namespace tessera
