#include "corpus/trace/sheen.h"

#include "corpus/trace/lobes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

constexpr double sheen_pi = std::numbers::pi;

// The exponents of the paper's fit of Smith's lambda.
double lambda_exponent(double alpha, double cosine) {
    const double t = (1.0 - alpha) * (1.0 - alpha);
    const double a = glm::mix(21.5473, 25.3245, t), b = glm::mix(3.82987, 3.32435, t),
                 c = glm::mix(0.19823, 0.16801, t), d = glm::mix(-1.97760, -1.27393, t),
                 e = glm::mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * std::pow(cosine, c)) + d * cosine + e;
}

double sheen_lambda(double alpha, double cosine) {
    return std::exp(cosine < 0.5
                        ? lambda_exponent(alpha, cosine)
                        : 2.0 * lambda_exponent(alpha, 0.5) - lambda_exponent(alpha, 1.0 - cosine));
}

// Albedos for evenly spaced roughnesses, and cosines whose roots are evenly spaced.
constexpr int table_side = 16;
constexpr double least_sheen_roughness = 0.2; // the root of least_sheen_alpha

struct SheenTable {
    std::array<std::array<double, table_side>, table_side> albedo{}; // [roughness][cosine]
    std::array<double, table_side> mean{};
    SheenTable() {
        for (int j = 0; j < table_side; ++j) {
            const double roughness =
                least_sheen_roughness + (1.0 - least_sheen_roughness) * j / (table_side - 1);
            auto& row = albedo[static_cast<std::size_t>(j)];
            for (int i = 0; i < table_side; ++i) {
                const double root = std::max(static_cast<double>(i), 0.1) / (table_side - 1);
                row[static_cast<std::size_t>(i)] = integrated(roughness * roughness, root * root);
            }
            constexpr int steps = 256;
            double sum = 0, weights = 0;
            for (int k = 0; k < steps; ++k) {
                const double cosine = (k + 0.5) / steps;
                sum += at(row, std::sqrt(cosine)) * cosine;
                weights += cosine;
            }
            mean[static_cast<std::size_t>(j)] = sum / weights;
        }
    }
    static double integrated(double alpha, double nv) {
        constexpr int cosines = 64, angles = 32; // half of the circle is the mirror of the other
        double sum = 0;
        for (int j = 0; j < cosines; ++j)
            for (int i = 0; i < angles; ++i) {
                const double nl = (j + 0.5) / cosines, round = sheen_pi * (i + 0.5) / angles;
                const double both =
                    std::sqrt((1.0 - nl * nl) * (1.0 - nv * nv)) * std::cos(round) + nl * nv;
                const double nh = (nl + nv) / std::sqrt(2.0 + 2.0 * both);
                sum += sheen_lobe(alpha, nh, nl, nv) * nl;
            }
        return std::min(1.0, sum * 2.0 * sheen_pi / (cosines * angles));
    }
    template <class Row> static double at(const Row& row, double position) {
        const double place = std::clamp(position, 0.0, 1.0) * (table_side - 1);
        const auto first = std::min(static_cast<std::size_t>(place), std::size_t{table_side - 2});
        return glm::mix(row[first], row[first + 1], place - static_cast<double>(first));
    }
};

const SheenTable& sheen_table() {
    static const SheenTable table;
    return table;
}

double table_row(double alpha) {
    return (std::sqrt(alpha) - least_sheen_roughness) / (1.0 - least_sheen_roughness);
}

} // namespace

double sheen_lobe(double alpha, double nh, double nl, double nv) {
    if (nl <= 0.0 || nv <= 0.0)
        return 0.0;
    const double sine = std::sqrt(std::max(0.0, 1.0 - nh * nh));
    const double density = (2.0 + 1.0 / alpha) * std::pow(sine, 1.0 / alpha) / (2.0 * sheen_pi);
    const double visibility =
        1.0 / ((1.0 + sheen_lambda(alpha, nl) + sheen_lambda(alpha, nv)) * 4.0 * nl * nv);
    return density * std::min(visibility, 1.0);
}

double sheen_albedo(double alpha, double nv) {
    const double position = std::sqrt(std::clamp(nv, 0.0, 1.0));
    std::array<double, table_side> column{};
    for (std::size_t j = 0; j < column.size(); ++j)
        column[j] = SheenTable::at(sheen_table().albedo[j], position);
    return SheenTable::at(column, table_row(alpha));
}

double mean_sheen_albedo(double alpha) {
    return SheenTable::at(sheen_table().mean, table_row(alpha));
}

} // namespace tessera::corpus
