#include "codec/fit/table_fit.h"

#include <array>
#include <cmath>

namespace tessera {
namespace {

constexpr double difference_bits = 4.0; // of a changed parameter in section CODE, about
constexpr double bits_per_unit = 0.7;

// The bits of both outcomes of a decision, by parameter value. Tabulated, because each of thousands
// of decisions tries every value.
struct Surprise {
    double stops, goes;
};
std::array<Surprise, parameter_count_of_odds> make_surprises() {
    std::array<Surprise, parameter_count_of_odds> all;
    for (std::size_t p = 0; p < all.size(); ++p) {
        const double stop =
            stop_frequency(static_cast<std::uint8_t>(p)) / static_cast<double>(probability_total);
        all[p] = {-std::log2(stop), -std::log2(1.0 - stop)};
    }
    return all;
}

} // namespace

Parameters fit_parameters(const Statistics& statistics, DefaultSet defaults) {
    static const auto surprise = make_surprises();
    const Parameters& standards = default_parameters(defaults);
    Parameters fitted = standards;
    for (std::size_t i = 0; i < fitted.size(); ++i) {
        const auto stops = static_cast<double>(statistics.stops[i]);
        const auto goes = static_cast<double>(statistics.goes[i]);
        if (stops + goes == 0)
            continue;
        const int standard = standards[i];
        double least = 1e300;
        for (int p = 0; p < parameter_count_of_odds; ++p) {
            const double change =
                p == standard ? 0 : difference_bits + bits_per_unit * std::abs(p - standard);
            const Surprise& of = surprise[p];
            const double bits = change + stops * of.stops + goes * of.goes;
            if (bits < least) {
                least = bits;
                fitted[i] = static_cast<std::uint8_t>(p);
            }
        }
    }
    return fitted;
}

Parameters dense_parameters(DefaultSet defaults) {
    constexpr std::uint8_t of_quantiser[quantisers] = {23, 40}; // 0 in 9 of 10, in 1 of 7
    Parameters parameters = default_parameters(defaults);
    for (int copies = 0; copies < copy_classes; ++copies)
        for (int quantiser = 0; quantiser < quantisers; ++quantiser)
            for (int row = 0; row <= cross_classes; ++row)
                for (int position = 1; position < zero_positions; ++position) // not DC
                    for (int neighbours = 1; neighbours < neighbour_classes; ++neighbours) {
                        const int plane = row == 0 ? 0 : 1, cross = row == 0 ? 0 : row - 1;
                        parameters[zero_parameter(copies != 0, quantiser, plane, position,
                                                  neighbours, cross)] = of_quantiser[quantiser];
                    }
    return parameters;
}

} // namespace tessera
