// Places the names of lines in a plot so that no name covers another.
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
    bool leader = false; // the name is far from its line: draw a thin line to it from `from`
    PlotPoint from;
};

// Returns one place per line, inside `plot`. A name goes to an end of its line if there is room,
// else beside another of its points, else to a free area of the plot, with a leader.
std::vector<LabelPlace> place_labels(const std::vector<LabelledLine>& lines, const PlotBox& plot);

} // namespace tessera
