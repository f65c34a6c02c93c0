#include "tools/lab/rd/bd_rate.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// log10 of rate as a function of PSNR, both strictly ascending.
struct Curve {
    std::vector<double> psnr, log_rate, slope;
};

// Returns the points that no other point beats in both rate and PSNR, by ascending PSNR.
std::vector<RatePoint> rising(std::vector<RatePoint> points) {
    std::erase_if(points, [](const RatePoint& p) {
        return !std::isfinite(p.psnr) || !std::isfinite(p.rate) || !(p.rate > 0);
    });
    std::sort(points.begin(), points.end(), [](const RatePoint& a, const RatePoint& b) {
        return a.psnr != b.psnr ? a.psnr > b.psnr : a.rate < b.rate;
    });
    std::vector<RatePoint> kept;
    for (const RatePoint& p : points)
        if (kept.empty() || (p.rate < kept.back().rate && p.psnr < kept.back().psnr))
            kept.push_back(p);
    std::reverse(kept.begin(), kept.end());
    return kept;
}

// The slope at an end of the curve, from the two pieces next to it, limited so that the
// interpolation stays monotone.
double end_slope(double h0, double h1, double d0, double d1) {
    const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (slope * d0 <= 0)
        return 0;
    if (d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0))
        return 3 * d0;
    return slope;
}

// Fritsch and Carlson, "Monotone piecewise cubic interpolation" (1980), with the weighted harmonic
// mean of Fritsch and Butland (1984) at the inner points.
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
    const std::size_t n = x.size();
    std::vector<double> h(n - 1), d(n - 1), slope(n, 0.0);
    for (std::size_t i = 0; i + 1 < n; ++i) {
        h[i] = x[i + 1] - x[i];
        d[i] = (y[i + 1] - y[i]) / h[i];
    }
    if (n == 2)
        return {d[0], d[0]};
    slope[0] = end_slope(h[0], h[1], d[0], d[1]);
    slope[n - 1] = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
    for (std::size_t i = 1; i + 1 < n; ++i) {
        if (d[i - 1] * d[i] <= 0)
            continue;
        const double before = 2 * h[i] + h[i - 1], after = h[i] + 2 * h[i - 1];
        slope[i] = (before + after) / (before / d[i - 1] + after / d[i]);
    }
    return slope;
}

Curve make_curve(const std::vector<RatePoint>& points) {
    Curve curve;
    for (const RatePoint& p : points) {
        curve.psnr.push_back(p.psnr);
        curve.log_rate.push_back(std::log10(p.rate));
    }
    curve.slope = monotone_slopes(curve.psnr, curve.log_rate);
    return curve;
}

// Integral of piece i from its start to the fraction x of its length.
double piece_integral(const Curve& c, std::size_t i, double x) {
    const double h = c.psnr[i + 1] - c.psnr[i];
    const double y0 = c.log_rate[i], y1 = c.log_rate[i + 1];
    const double m0 = c.slope[i] * h, m1 = c.slope[i + 1] * h;
    const double x2 = x * x, x3 = x2 * x, x4 = x2 * x2;
    return h * (y0 * (x - x3 + x4 / 2) + m0 * (x2 / 2 - 2 * x3 / 3 + x4 / 4) + y1 * (x3 - x4 / 2) +
                m1 * (x4 / 4 - x3 / 3));
}

double integral(const Curve& c, double low, double high) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < c.psnr.size(); ++i) {
        const double start = c.psnr[i], length = c.psnr[i + 1] - start;
        const double from = std::clamp((low - start) / length, 0.0, 1.0);
        const double to = std::clamp((high - start) / length, 0.0, 1.0);
        sum += piece_integral(c, i, to) - piece_integral(c, i, from);
    }
    return sum;
}

} // namespace

std::optional<BdRate> bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test) {
    anchor = rising(std::move(anchor));
    test = rising(std::move(test));
    if (anchor.size() < 2 || test.size() < 2)
        return std::nullopt;
    const double low = std::max(anchor.front().psnr, test.front().psnr);
    const double high = std::min(anchor.back().psnr, test.back().psnr);
    if (low >= high)
        return std::nullopt;
    const double difference =
        integral(make_curve(test), low, high) - integral(make_curve(anchor), low, high);
    return BdRate{(std::pow(10.0, difference / (high - low)) - 1) * 100, low, high};
}

} // namespace tessera
