#include "corpus/trace/environment.h"

#include "corpus/trace/sampled_sums.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

using std::numbers::pi;
// This share of the mean light is added to every weight, so that dark directions are sampled, too.
constexpr double floor_share = 0.02;

glm::dvec2 place_of(const glm::dvec3& d) {
    return {std::atan2(d.z, d.x) / (2.0 * pi) + 0.5, std::acos(std::clamp(d.y, -1.0, 1.0)) / pi};
}

std::size_t cell_of(double place, std::uint32_t count) {
    return std::min(static_cast<std::size_t>(std::max(place, 0.0) * count), std::size_t{count} - 1);
}

Status check(LightImage& image) {
    for (std::size_t i = 0; i < image.texels.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            float& x = image.texels[i][c];
            if (!std::isfinite(x))
                return {ErrorCode::invalid_file,
                        "texel " + std::to_string(i % image.width) + ", " +
                            std::to_string(i / image.width) +
                            (std::isnan(x) ? " is not a number" : " is infinite")};
            x = std::max(x, 0.0f);
        }
    return {};
}

} // namespace

Environment::Environment(LightImage image)
    : image_(std::move(image)), cosines_(row_cosines(image_.height)) {
    const std::size_t w = image_.width, h = image_.height;
    const auto brightness = [&](std::size_t x, std::size_t y) {
        const glm::vec3& t = image_.texels[y * w + x];
        return 0.2126 * static_cast<double>(t.x) + 0.7152 * static_cast<double>(t.y) +
               0.0722 * static_cast<double>(t.z);
    };
    double mean = 0;
    for (std::size_t y = 0; y < h; ++y)
        for (std::size_t x = 0; x < w; ++x)
            mean += brightness(x, y) / static_cast<double>(w * h);
    double all = 0;
    for (std::size_t y = 0; y < h; ++y) {
        double row = 0;
        const double area = std::sin(pi * (static_cast<double>(y) + 0.5) / static_cast<double>(h));
        for (std::size_t x = 0; x < w; ++x) {
            // Light is interpolated between texels, so a cell also contains light of its
            // neighbours.
            double near = 0;
            for (std::size_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, h - 1); ++j)
                for (const std::size_t i : {x == 0 ? w - 1 : x - 1, x, x + 1 == w ? 0 : x + 1})
                    near = std::max(near, brightness(i, j));
            row += area * (0.5 * (near + brightness(x, y)) + floor_share * mean + 1e-12);
            cells_.push_back(row);
        }
        all += row;
        rows_.push_back(all);
    }
}

Result<Environment> Environment::load(const std::string& path, const std::string& layer) {
    TESSERA_TRY_ASSIGN(const auto file, open_file(path));
    TESSERA_TRY_ASSIGN(LightImage image, read_light_image(*file, layer));
    TESSERA_TRY(check(image).with_context(path));
    return Environment(std::move(image));
}

Environment Environment::studio() {
    LightImage image{128, 64, {}};
    const glm::dvec3 box = glm::normalize(glm::dvec3(0.8, 0.9, 0.5));
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const double polar = pi * (y + 0.5) / image.height;
            const double round = 2.0 * pi * ((x + 0.5) / image.width - 0.5);
            const glm::dvec3 d{std::sin(polar) * std::cos(round), std::cos(polar),
                               std::sin(polar) * std::sin(round)};
            const double sky = 0.25 + 0.35 * std::clamp(0.5 + 2.0 * d.y, 0.0, 1.0);
            const double near = std::clamp((glm::dot(d, box) - 0.9) / 0.03, 0.0, 1.0);
            image.texels.emplace_back(glm::dvec3(0.95, 0.98, 1.05) * sky +
                                      glm::dvec3(8.0, 7.6, 7.0) * near);
        }
    return Environment(std::move(image));
}

glm::dvec3 Environment::light(const glm::dvec3& direction) const {
    const std::size_t w = image_.width, h = image_.height;
    const glm::dvec2 place = place_of(direction);
    const double x = place.x * static_cast<double>(w) - 0.5;
    const double y =
        std::clamp(place.y * static_cast<double>(h) - 0.5, 0.0, static_cast<double>(h) - 1.0);
    const double fx = x - std::floor(x), fy = y - std::floor(y);
    const auto y0 = static_cast<std::size_t>(y), y1 = std::min(y0 + 1, h - 1);
    const auto x0 = static_cast<std::size_t>(std::floor(x) + static_cast<double>(w)) % w;
    const std::size_t x1 = x0 + 1 == w ? 0 : x0 + 1;
    const auto at = [&](std::size_t i, std::size_t j) {
        return glm::dvec3(image_.texels[j * w + i]);
    };
    return (at(x0, y0) * (1.0 - fx) + at(x1, y0) * fx) * (1.0 - fy) +
           (at(x0, y1) * (1.0 - fx) + at(x1, y1) * fx) * fy;
}

LightSample Environment::sample(const glm::dvec2& random) const {
    const std::size_t w = image_.width;
    const auto [y, along_y] = sample_sums(rows_, random.y * rows_.back());
    const std::span<const double> row = std::span(cells_).subspan(y * w, w);
    const auto [x, along_x] = sample_sums(row, random.x * row.back());
    const glm::dvec3 d = direction_in_cell(x, y, w, cosines_, {along_x, along_y});
    return {d, light(d), cell_density(x, y)};
}

double Environment::cell_density(std::size_t x, std::size_t y) const {
    const std::size_t w = image_.width;
    const double weight = cells_[y * w + x] - (x == 0 ? 0.0 : cells_[y * w + x - 1]);
    const double area = 2.0 * pi / static_cast<double>(w) * (cosines_[y] - cosines_[y + 1]);
    return weight / rows_.back() / area;
}

double Environment::density(const glm::dvec3& direction) const {
    const glm::dvec2 place = place_of(direction);
    return cell_density(cell_of(place.x, image_.width), cell_of(place.y, image_.height));
}

} // namespace tessera::corpus
