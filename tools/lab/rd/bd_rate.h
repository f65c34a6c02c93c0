// The Bjontegaard difference of two rate-distortion curves (VCEG-M33, with the monotone cubic
// interpolation of JCTVC-L1100): how many bits more or fewer a codec needs for the same PSNR.
#pragma once

#include <optional>
#include <vector>

namespace tessera {

struct RatePoint {
    double rate = 0; // above 0, any unit
    double psnr = 0; // dB; bd_rate() ignores points that are not finite
};

struct BdRate {
    double percent = 0;       // rate relative to the anchor: -50 means half the bits
    double low = 0, high = 0; // dB: the interval that both curves cover
};

// First drops each point that another point beats in rate and PSNR, because a curve must rise.
// Returns nothing if a curve has fewer than two points left, or if the curves share no interval.
std::optional<BdRate> bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test);

} // namespace tessera
