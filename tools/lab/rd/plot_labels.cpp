#include "tools/lab/rd/plot_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr double letter_width = 7.4, line_height = 17; // for a semi-bold font of 13 pixels
constexpr double label_gap = 8;                        // between a point and its name

bool overlap(const PlotBox& a, const PlotBox& b) {
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

bool is_inside(const PlotBox& box, const PlotBox& plot) {
    return box.x0 >= plot.x0 && box.x1 <= plot.x1 && box.y0 >= plot.y0 && box.y1 <= plot.y1;
}

bool holds(const PlotBox& box, PlotPoint p) {
    return p.x > box.x0 && p.x < box.x1 && p.y > box.y0 && p.y < box.y1;
}

// Samples the line every few pixels and returns how many samples lie inside the box.
int run_inside(const LabelledLine& line, const PlotBox& box) {
    int steps = 0;
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
        const PlotPoint a = line.points[i], b = line.points[i + 1];
        const int count = static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / 4) + 1;
        for (int k = 0; k <= count; ++k)
            steps += holds(box, {a.x + (b.x - a.x) * k / count, a.y + (b.y - a.y) * k / count});
    }
    return steps;
}

class Placer {
public:
    Placer(const std::vector<LabelledLine>& lines, const PlotBox& plot)
        : lines_(lines), plot_(plot) {}

    LabelPlace place(std::size_t index) {
        best_ = {};
        best_cost_ = std::numeric_limits<double>::infinity();
        const LabelledLine& line = lines_[index];
        const std::size_t last = line.points.size() - 1;
        // Starts at the upper end, where the lines of the codecs fan out.
        for (std::size_t back = 0; back <= last; ++back) {
            const std::size_t i = last - back;
            try_around(line, line.points[i], i == last ? 0 : i == 0 ? 2 : 5);
        }
        if (best_cost_ > 40)
            try_anywhere(line, line.points[last]);
        taken_.push_back(best_.box);
        return best_;
    }

private:
    static PlotBox box_at(const LabelledLine& line, double x0, double y0) {
        const double width = static_cast<double>(line.name.size()) * letter_width;
        return {x0, y0, x0 + width, y0 + line_height};
    }

    double cost_of(const PlotBox& box) const {
        if (!is_inside(box, plot_))
            return std::numeric_limits<double>::infinity();
        for (const PlotBox& other : taken_)
            if (overlap(box, other))
                return std::numeric_limits<double>::infinity();
        double cost = 0;
        const PlotBox near{box.x0 - 4, box.y0 - 2, box.x1 + 4, box.y1 + 2};
        for (const LabelledLine& line : lines_) {
            for (const PlotPoint p : line.points)
                cost += holds(near, p) ? 30 : 0;
            cost += 3.0 * run_inside(line, box);
        }
        return cost;
    }

    void consider(const PlotBox& box, double preference, bool leader, PlotPoint from) {
        const double cost = cost_of(box) + preference;
        if (cost >= best_cost_)
            return;
        best_cost_ = cost;
        best_ = {box, leader, from};
    }

    void try_around(const LabelledLine& line, PlotPoint p, double preference) {
        const double w = static_cast<double>(line.name.size()) * letter_width, h = line_height;
        const PlotPoint corners[] = {
            {p.x + label_gap, p.y - h / 2},         {p.x - w / 2, p.y - h - label_gap},
            {p.x + label_gap - 2, p.y - h - 2},     {p.x - w - label_gap, p.y - h / 2},
            {p.x - w - label_gap + 2, p.y - h - 2}, {p.x + label_gap - 2, p.y + 2},
            {p.x - w / 2, p.y + label_gap},         {p.x - w - label_gap + 2, p.y + 2}};
        double extra = 0;
        for (const PlotPoint corner : corners)
            consider(box_at(line, corner.x, corner.y), preference + (extra += 0.5), false, p);
    }

    // Tries rings of growing radius around the point.
    void try_anywhere(const LabelledLine& line, PlotPoint p) {
        for (double radius = 24; radius < 400; radius += 12)
            for (int angle = 0; angle < 24; ++angle) {
                const double a = angle * 3.14159265358979 / 12;
                consider(box_at(line, p.x + radius * std::cos(a),
                                p.y + radius * std::sin(a) - line_height / 2),
                         20 + radius / 10, true, p);
            }
        if (!std::isfinite(best_cost_)) // no free area is left
            best_ = {box_at(line, plot_.x0, plot_.y0), false, p};
    }

    const std::vector<LabelledLine>& lines_;
    PlotBox plot_;
    std::vector<PlotBox> taken_;
    LabelPlace best_;
    double best_cost_ = 0;
};

} // namespace

std::vector<LabelPlace> place_labels(const std::vector<LabelledLine>& lines, const PlotBox& plot) {
    Placer placer(lines, plot);
    std::vector<LabelPlace> places;
    for (std::size_t i = 0; i < lines.size(); ++i)
        places.push_back(placer.place(i));
    return places;
}

} // namespace tessera
