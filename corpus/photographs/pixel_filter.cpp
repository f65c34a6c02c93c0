#include "corpus/photographs/pixel_filter.h"

#include "corpus/model/text_lines.h"

#include <cmath>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr std::size_t filter_steps = 1024;

// Weights for x from -0.5 to 0.5 widths.
double gauss_weight(double x) {
    return std::exp(-72 * x * x); // falls to e^-18 at the ends
}

double blackman_harris_weight(double x) {
    const double v = 2 * std::numbers::pi * (x + 0.5);
    return 0.35875 - 0.48829 * std::cos(v) + 0.14128 * std::cos(2 * v) - 0.01168 * std::cos(3 * v);
}

// The inverse of the weights' cumulative sum, which is symmetric about the centre.
std::vector<double> inverse_sum(double (*weight)(double)) {
    constexpr std::size_t fine = 16 * filter_steps;
    std::vector<double> sums{0.0}; // over the right half
    for (std::size_t i = 0; i < fine; ++i)
        sums.push_back(sums.back() + weight(0.5 * (static_cast<double>(i) + 0.5) / fine));
    std::vector<double> places(filter_steps + 1);
    std::size_t at = 0;
    for (std::size_t i = 0; i <= filter_steps / 2; ++i) {
        const double wanted = sums.back() * static_cast<double>(2 * i) / filter_steps;
        while (at + 1 < fine && sums[at + 1] < wanted)
            ++at;
        const double share = (wanted - sums[at]) / (sums[at + 1] - sums[at]);
        const double place = 0.5 * (static_cast<double>(at) + std::min(share, 1.0)) / fine;
        places[filter_steps / 2 + i] = place;
        places[filter_steps / 2 - i] = -place;
    }
    return places;
}

} // namespace

Result<PixelFilter> PixelFilter::parse(std::string_view text) {
    const std::size_t colon = text.find(':');
    const std::string_view name = text.substr(0, colon);
    const bool is_box = name == "box", is_gauss = name == "gauss";
    if (!is_box && !is_gauss && name != "blackman-harris")
        return Status(ErrorCode::bad_argument,
                      in_quotes(text) + " is no pixel filter: box, gauss or blackman-harris");
    double width = is_box ? 1 : is_gauss ? 4.5 : 3;
    if (colon != std::string_view::npos &&
        (!parse_word(text.substr(colon + 1), width) || !(width >= 0.01 && width <= 100)))
        return Status(ErrorCode::bad_argument,
                      in_quotes(text) + ": the width of a pixel filter is 0.01 to 100 pixels");
    return PixelFilter(width, is_box     ? std::vector<double>()
                              : is_gauss ? inverse_sum(gauss_weight)
                                         : inverse_sum(blackman_harris_weight));
}

double PixelFilter::place(double u) const {
    if (is_default())
        return u;
    if (places_.empty())
        return 0.5 + (u - 0.5) * width_;
    const double step = u * filter_steps;
    const auto before = std::min(static_cast<std::size_t>(step), filter_steps - 1);
    const double share = step - static_cast<double>(before);
    return 0.5 + width_ * (places_[before] + share * (places_[before + 1] - places_[before]));
}

} // namespace tessera::corpus
