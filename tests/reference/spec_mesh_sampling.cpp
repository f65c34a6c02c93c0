#include "tests/reference/spec_mesh_sampling.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace tessera_reference {

namespace {

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// a * x + b * y
Vector sum(double a, const Vector& x, double b, const Vector& y) {
    return {a * x[0] + b * y[0], a * x[1] + b * y[1], a * x[2] + b * y[2]};
}

Vector unit(const Vector& x) {
    const double length = std::sqrt(dot(x, x));
    return {x[0] / length, x[1] / length, x[2] / length};
}

double sign(double x) {
    return x >= 0 ? 1 : -1;
}

void fold(double& p, double& q) {
    const double new_p = (1 - std::fabs(q)) * sign(p);
    const double new_q = (1 - std::fabs(p)) * sign(q);
    p = new_p;
    q = new_q;
}

// "d is first replaced by a direction that leaves the surface"
Vector leaving(const Vector& d, const Vector& ez) {
    const Vector flat = sum(1, d, -std::min(0.0, dot(d, ez)), ez);
    return std::sqrt(dot(flat, flat)) < 1e-12 ? ez : unit(flat);
}

// Texels `first` and `first` + 1, and the weight of the second.
struct Pair {
    long first;
    double second_weight;
};

Pair pair_at(double x, std::uint32_t n) {
    const double i = std::floor(x * n - 0.5);
    return {static_cast<long>(i), x * n - 0.5 - i};
}

long ended(long i, std::uint32_t n) {
    if (i == -1)
        return 0;
    return i == static_cast<long>(n) ? i - 1 : i;
}

} // namespace

std::array<double, 2> place_of_direction(int angular_map, const Frame& frame, const Vector& d) {
    const Vector out = leaving(d, frame.ez);
    if (angular_map == 3) {
        const double x = dot(out, frame.ex), y = dot(out, frame.ey), z = dot(out, frame.ez);
        const double n = std::fabs(x) + std::fabs(y) + z;
        return {((x + y) / n + 1) / 2, ((x - y) / n + 1) / 2};
    }
    const Vector r = sum(2 * dot(frame.ez, out), frame.ez, -1, out);
    const double n = std::fabs(r[0]) + std::fabs(r[1]) + std::fabs(r[2]);
    double p = r[0] / n, q = r[2] / n;
    if (r[1] < 0)
        fold(p, q);
    return {(p + 1) / 2, (q + 1) / 2};
}

Vector direction_of_place(int angular_map, const Frame& frame, double s, double t) {
    if (angular_map == 3) {
        const double x = s + t - 1, y = s - t, z = 1 - std::fabs(x) - std::fabs(y);
        return unit(sum(1, sum(x, frame.ex, y, frame.ey), z, frame.ez));
    }
    double p = 2 * s - 1, q = 2 * t - 1;
    const double y = 1 - std::fabs(p) - std::fabs(q);
    if (y < 0)
        fold(p, q);
    const Vector r = unit({p, y, q});
    return sum(2 * dot(frame.ez, r), frame.ez, -1, r);
}

std::array<Tap, 16> mesh_taps(const std::uint32_t size[4], int angular_map, const Frame& frame,
                              double u, double v, const Vector& d) {
    const std::array<double, 2> st = place_of_direction(angular_map, frame, d);
    const double place[4] = {u, v, st[0], st[1]};
    Pair pairs[4];
    for (int axis = 0; axis < 4; ++axis)
        pairs[axis] = pair_at(place[axis], size[axis]);
    std::array<Tap, 16> taps{};
    for (unsigned number = 0; number < 16; ++number) {
        long i[4];
        double weight = 1;
        for (int axis = 0; axis < 4; ++axis) {
            const bool second = (number >> axis & 1) != 0;
            i[axis] = pairs[axis].first + (second ? 1 : 0);
            weight *= second ? pairs[axis].second_weight : 1 - pairs[axis].second_weight;
        }
        i[0] = ended(i[0], size[0]);
        i[1] = ended(i[1], size[1]);
        const auto s_end = static_cast<long>(size[2]), t_end = static_cast<long>(size[3]);
        if (angular_map == 4) {
            if (i[2] == -1 || i[2] == s_end) {
                i[2] = i[2] == -1 ? 0 : s_end - 1;
                i[3] = t_end - 1 - i[3];
            }
            if (i[3] == -1 || i[3] == t_end) {
                i[3] = i[3] == -1 ? 0 : t_end - 1;
                i[2] = s_end - 1 - i[2];
            }
        } else {
            i[2] = ended(i[2], size[2]);
            i[3] = ended(i[3], size[3]);
        }
        for (int axis = 0; axis < 4; ++axis)
            taps[number].texel[axis] = static_cast<std::uint32_t>(i[axis]);
        taps[number].weight = weight;
    }
    return taps;
}

namespace {

using Points = std::vector<std::array<double, 2>>;

// The part of a polygon on one side of a vertical or horizontal line: sign * (x - at) >= 0.
Points cut(const Points& polygon, int axis, double sign, double at) {
    Points left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const double a = sign * (p[axis] - at), b = sign * (q[axis] - at);
        if (a >= 0)
            left.push_back(p);
        if (a * b < 0)
            left.push_back(
                {p[0] + (q[0] - p[0]) * a / (a - b), p[1] + (q[1] - p[1]) * a / (a - b)});
    }
    return left;
}

} // namespace

Charts::Charts(const std::vector<AtlasTriangle>& triangles, std::uint32_t width,
               std::uint32_t height)
    : width_(width), height_(height), texels_(std::size_t{width} * height, -1) {
    std::vector<long> chart(triangles.size());
    for (std::size_t i = 0; i < chart.size(); ++i)
        chart[i] = static_cast<long>(i);
    for (bool changed = true; changed;) { // until all connected triangles have the same number
        changed = false;
        for (std::size_t i = 0; i < triangles.size(); ++i)
            for (std::size_t j = 0; j < triangles.size(); ++j)
                for (const std::uint32_t a : triangles[i].vertices)
                    for (const std::uint32_t b : triangles[j].vertices)
                        if (a == b && chart[j] < chart[i]) {
                            chart[i] = chart[j];
                            changed = true;
                        }
    }
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::size_t i = 0; i < triangles.size() && texels_[std::size_t{y} * width + x] < 0;
                 ++i) {
                Points corners;
                for (const auto& uv : triangles[i].uv)
                    corners.push_back({uv[0] * width, uv[1] * height});
                const auto &a = corners[0], &b = corners[1], &c = corners[2];
                if ((b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0]))
                    continue;
                const Points in =
                    cut(cut(cut(cut(corners, 0, 1, x), 0, -1, x + 1.0), 1, 1, y), 1, -1, y + 1.0);
                if (!in.empty())
                    texels_[std::size_t{y} * width + x] = chart[i];
            }
}

std::array<std::uint32_t, 2> Charts::size(unsigned mip) const {
    const std::uint32_t side = 1u << mip;
    return {(width_ + side - 1) / side, (height_ + side - 1) / side};
}

long Charts::shown_by(unsigned mip, std::uint32_t x, std::uint32_t y) const {
    std::map<long, int> votes;
    for (std::uint32_t j = 0; j < height_; ++j)
        for (std::uint32_t i = 0; i < width_; ++i)
            if (i >> mip == x && j >> mip == y && texels_[std::size_t{j} * width_ + i] >= 0)
                ++votes[texels_[std::size_t{j} * width_ + i]];
    long best = -1;
    for (const auto& [chart, count] : votes) // ascending
        if (best < 0 || count > votes[best])
            best = chart;
    return best;
}

MipTaps mip_taps(const Charts& charts, const std::uint32_t size[4], int angular_map,
                 const Frame& frame, double u, double v, const Vector& d, unsigned mip) {
    const std::uint32_t x = std::min(static_cast<std::uint32_t>(u * size[0]), size[0] - 1);
    const std::uint32_t y = std::min(static_cast<std::uint32_t>(v * size[1]), size[1] - 1);
    const long own = charts.shown_by(0, x, y);
    if (mip > 0 && own >= 0) {
        const auto sides = charts.size(mip);
        const std::uint32_t of_mip[4] = {sides[0], sides[1], size[2], size[3]};
        const double scale = std::pow(2.0, mip);
        auto taps = mesh_taps(of_mip, angular_map, frame, u * size[0] / scale / sides[0],
                              v * size[1] / scale / sides[1], d);
        double sum = 0;
        for (Tap& tap : taps) {
            if (charts.shown_by(mip, tap.texel[0], tap.texel[1]) != own)
                tap.weight = 0;
            sum += tap.weight;
        }
        for (Tap& tap : taps)
            tap.weight /= sum;
        if (sum > 0)
            return {mip, taps};
    }
    return {0, mesh_taps(size, angular_map, frame, u, v, d)};
}

unsigned mips_of(const std::vector<std::uint32_t>& begins) {
    for (unsigned mips = 4;; --mips) {
        bool all = true;
        for (const std::uint32_t begin : begins)
            all = all && begin % (1u << mips) == 0;
        if (all)
            return mips;
    }
}

double mip_of_pixel(double a, double b, unsigned mips) {
    const double m = std::max(std::min(a, b) * std::sqrt(0.5), std::max(a, b) / 4);
    return m <= 1 ? 0 : std::min(std::log2(m), static_cast<double>(mips));
}

} // namespace tessera_reference
