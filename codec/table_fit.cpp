#include "codec/table_fit.h"

#include <cmath>

namespace tessera {
namespace {

constexpr double difference_bits = 4.0; // about what one costs in section CODE
constexpr double bits_per_unit = 0.7;

} // namespace

Parameters fit_parameters(const Statistics& statistics) {
    Parameters fitted = default_parameters();
    for (std::size_t i = 0; i < fitted.size(); ++i) {
        const auto stops = static_cast<double>(statistics.stops[i]);
        const auto goes = static_cast<double>(statistics.goes[i]);
        if (stops + goes == 0)
            continue;
        const int standard = default_parameters()[i];
        double least = 1e300;
        for (int p = 0; p < parameter_count_of_odds; ++p) {
            const double stop = stop_frequency(static_cast<std::uint8_t>(p)) /
                                static_cast<double>(probability_total);
            const double change =
                p == standard ? 0 : difference_bits + bits_per_unit * std::abs(p - standard);
            const double bits = change - stops * std::log2(stop) - goes * std::log2(1.0 - stop);
            if (bits < least) {
                least = bits;
                fitted[i] = static_cast<std::uint8_t>(p);
            }
        }
    }
    return fitted;
}

} // namespace tessera
