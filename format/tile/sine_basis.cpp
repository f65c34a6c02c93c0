#include "format/tile/sine_basis.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tessera {
namespace {

using SineBases = std::array<std::vector<std::int32_t>, max_sine_side + 1>;

SineBases make_sine_bases() {
    SineBases bases;
    for (int n = 1; n <= max_sine_side; ++n) {
        // All values occur in a quarter of the wave, in steps of pi / (2n + 1).
        const int half = 2 * n + 1;
        const double amplitude = std::ldexp(std::sqrt(2.0 * n / half), basis_bits);
        std::array<std::int32_t, max_sine_side + 1> wave;
        for (int i = 0; i <= n; ++i)
            wave[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(
                std::lround(amplitude * std::sin(i * std::numbers::pi / half)));
        const auto value = [&](int angle) {
            const int i = angle % (2 * half), rest = i % half; // the second half is negative
            const auto near = static_cast<std::size_t>(rest <= n ? rest : half - rest);
            return i < half ? wave[near] : -wave[near];
        };
        std::vector<std::int32_t>& rows = bases[static_cast<std::size_t>(n)];
        for (int k = 0; k < n; ++k)
            for (int x = 0; x < n; ++x)
                rows.push_back(value((2 * k + 1) * (x + 1)));
    }
    return bases;
}

} // namespace

const std::int32_t* sine_basis(int n) {
    static const SineBases bases = make_sine_bases();
    return bases[static_cast<std::size_t>(n)].data();
}

} // namespace tessera
