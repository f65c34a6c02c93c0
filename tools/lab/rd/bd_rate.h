// The Bjontegaard difference of two rate-distortion curves (VCEG-M33, with the monotone cubic
// interpolation of JCTVC-L1100): how many bits more or fewer a codec needs for the same PSNR.
#pragma once

#include <optional>
#include <vector>

namespace tessera {

struct RatePoint {
    double rate = 0; // above 0, any unit
    double psnr = 0; // dB; points that are not finite are left out
};

struct BdRate {
    double percent = 0;       // of rate, against the anchor: -50 is half the bits
    double low = 0, high = 0; // dB: the interval that both curves cover
};

// Nothing where a curve has fewer than two points left or they share no interval. Points that cost
// more bits than another of higher PSNR are left out first: a curve must rise.
std::optional<BdRate> bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test);

} // namespace tessera
