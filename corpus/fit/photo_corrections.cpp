#include "corpus/fit/photo_corrections.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <unordered_map>

namespace tessera::corpus {
namespace {

constexpr double most_gain = 2.0, most_shift = 2.0; // pixels
// Of the squared error that a shift has to remove; less may be chance.
constexpr double least_removed = 0.05;

double square_error(const PhotoPixel& pixel, const std::array<float, 3>& predicted) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double e = static_cast<double>(pixel.colour[c]) - static_cast<double>(predicted[c]);
        sum += e * e;
    }
    return sum / 3.0;
}

// Finds pixels of one photograph by their place.
class PixelPlaces {
public:
    PixelPlaces(const PhotoSamples& samples, std::size_t photograph) {
        for (std::size_t i = samples.first[photograph]; i < samples.first[photograph + 1]; ++i)
            numbers_.emplace(key(samples.pixels[i].x, samples.pixels[i].y), i);
    }
    // The pixel's index; nothing if it is not among the samples.
    const std::size_t* find(std::uint32_t x, std::uint32_t y) const {
        const auto found = numbers_.find(key(x, y));
        return found == numbers_.end() ? nullptr : &found->second;
    }

private:
    static std::uint64_t key(std::uint32_t x, std::uint32_t y) {
        return std::uint64_t{y} << 32 | x;
    }
    std::unordered_map<std::uint64_t, std::size_t> numbers_;
};

// By least squares: moving the picture by a small step changes its colours by the step times their
// slopes (Lucas and Kanade 1981).
glm::dvec2 shift_of(const PhotoSamples& samples, const PixelColours& predicted,
                    std::size_t photograph) {
    const PixelPlaces places(samples, photograph);
    glm::dmat2 squares(0.0);
    glm::dvec2 products(0.0);
    double errors = 0;
    for (std::size_t i = samples.first[photograph]; i < samples.first[photograph + 1]; ++i) {
        const PhotoPixel& pixel = samples.pixels[i];
        const std::size_t* const left = places.find(pixel.x - 1, pixel.y);
        const std::size_t* const right = places.find(pixel.x + 1, pixel.y);
        const std::size_t* const above = places.find(pixel.x, pixel.y - 1);
        const std::size_t* const below = places.find(pixel.x, pixel.y + 1);
        if (pixel.weight <= 0.0f || !left || !right || !above || !below)
            continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto slope = [&](std::size_t before, std::size_t after) {
                return 0.5 * (static_cast<double>(predicted[after][c]) -
                              static_cast<double>(predicted[before][c]));
            };
            const glm::dvec2 slopes(slope(*left, *right), slope(*above, *below));
            const double error =
                static_cast<double>(pixel.colour[c]) - static_cast<double>(predicted[i][c]);
            const auto weight = static_cast<double>(pixel.weight);
            squares += weight * glm::outerProduct(slopes, slopes);
            products += weight * error * slopes;
            errors += weight * error * error;
        }
    }
    const double trace = squares[0][0] + squares[1][1];
    if (glm::determinant(squares) <= 1e-6 * trace * trace)
        return glm::dvec2(0.0); // nothing in the picture shows a shift in all directions
    const glm::dvec2 step = glm::inverse(squares) * products, shift = -step;
    if (glm::dot(step, products) < least_removed * errors)
        return glm::dvec2(0.0);
    return glm::clamp(shift, glm::dvec2(-most_shift), glm::dvec2(most_shift));
}

} // namespace

std::vector<PhotoDifference> photo_differences(const PhotoSamples& samples,
                                               const PixelColours& predicted) {
    std::vector<PhotoDifference> all(samples.photographs());
    for (std::size_t n = 0; n < all.size(); ++n) {
        double error = 0, weights = 0;
        std::array<double, 3> products{}, squares{};
        for (std::size_t i = samples.first[n]; i < samples.first[n + 1]; ++i) {
            const PhotoPixel& pixel = samples.pixels[i];
            const auto weight = static_cast<double>(pixel.weight);
            error += weight * square_error(pixel, predicted[i]);
            weights += weight;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto p = static_cast<double>(predicted[i][c]);
                products[c] += weight * static_cast<double>(pixel.colour[c]) * p;
                squares[c] += weight * p * p;
            }
        }
        all[n].error = weights > 0 ? std::sqrt(error / weights) : 0.0;
        for (std::size_t c = 0; c < 3; ++c)
            if (squares[c] > 0)
                all[n].gain[c] = std::clamp(products[c] / squares[c], 1.0 / most_gain, most_gain);
        all[n].shift = shift_of(samples, predicted, n);
    }
    return all;
}

void weigh_outliers(PhotoSamples& samples, const PixelColours& predicted, double times) {
    double error = 0, weights = 0;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
        const auto weight = static_cast<double>(samples.pixels[i].weight);
        error += weight * square_error(samples.pixels[i], predicted[i]);
        weights += weight;
    }
    if (weights <= 0.0 || error <= 0.0)
        return;
    const double scale = times * times * error / weights;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
        const double share = 1.0 / (1.0 + square_error(samples.pixels[i], predicted[i]) / scale);
        samples.pixels[i].weight *= static_cast<float>(share * share);
    }
}

} // namespace tessera::corpus
