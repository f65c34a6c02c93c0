#include "corpus/layers/distant_lights.h"

#include "corpus/trace/sampled_sums.h"

#include <cmath>
#include <list>
#include <numbers>

namespace tessera::corpus {
namespace {

// The environment is sampled on a grid of this many rows and twice as many columns.
constexpr std::uint32_t rows = 128, columns = 2 * rows;

struct Sum {
    glm::dvec3 light{0.0};  // times solid angle
    glm::dvec3 toward{0.0}; // directions times brightness times solid angle
    double brightness = 0;

    Sum& operator+=(const Sum& other) {
        light += other.light;
        toward += other.toward;
        brightness += other.brightness;
        return *this;
    }
    Sum operator-(const Sum& other) const {
        return {light - other.light, toward - other.toward, brightness - other.brightness};
    }
    // Brightness times the cosine of the mean deviation: the larger, the less spread.
    double together() const { return glm::length(toward); }
};

using Cells = std::vector<Sum>;

Cells cells_of(const Environment& environment) {
    Cells cells;
    for (std::uint32_t y = 0; y < rows; ++y)
        for (std::uint32_t x = 0; x < columns; ++x) {
            const double top = std::numbers::pi * y / rows;
            const double bottom = std::numbers::pi * (y + 1) / rows;
            const double angle = (std::cos(top) - std::cos(bottom)) * 2.0 * std::numbers::pi /
                                 columns; // of the cell
            Sum sum;
            // The picture may be finer than the grid.
            constexpr int part = 8;
            for (int j = 0; j < part; ++j)
                for (int i = 0; i < part; ++i) {
                    const double polar = top + (bottom - top) * (j + 0.5) / part;
                    const double round =
                        2.0 * std::numbers::pi * ((x + (i + 0.5) / part) / columns - 0.5);
                    const glm::dvec3 d{std::sin(polar) * std::cos(round), std::cos(polar),
                                       std::sin(polar) * std::sin(round)};
                    const glm::dvec3 light = environment.light(d) * (angle / (part * part));
                    const double bright = glm::dot(light, {0.2126, 0.7152, 0.0722});
                    sum += {light, d * bright, bright};
                }
            cells.push_back(sum);
        }
    return cells;
}

struct EnvironmentPatch {
    std::uint32_t x0, y0, x1, y1;
    Sum sum;
    // The best place to split it, and what that gains.
    bool along_x = true;
    std::uint32_t at = 0;
    double gain = 0;
};

void find_split(const Cells& cells, EnvironmentPatch& p) {
    const auto cell = [&](std::uint32_t x, std::uint32_t y) -> const Sum& {
        return cells[std::size_t{y} * columns + x];
    };
    p.sum = {};
    for (std::uint32_t y = p.y0; y < p.y1; ++y)
        for (std::uint32_t x = p.x0; x < p.x1; ++x)
            p.sum += cell(x, y);
    p.gain = 0;
    const auto consider = [&](const Sum& part, bool along_x, std::uint32_t at) {
        const double gain = part.together() + (p.sum - part).together() - p.sum.together();
        if (gain > p.gain * (1.0 + 1e-9)) {
            p.gain = gain;
            p.along_x = along_x;
            p.at = at;
        }
    };
    Sum part;
    for (std::uint32_t x = p.x0; x + 1 < p.x1; ++x) {
        for (std::uint32_t y = p.y0; y < p.y1; ++y)
            part += cell(x, y);
        consider(part, true, x + 1);
    }
    part = {};
    for (std::uint32_t y = p.y0; y + 1 < p.y1; ++y) {
        for (std::uint32_t x = p.x0; x < p.x1; ++x)
            part += cell(x, y);
        consider(part, false, y + 1);
    }
}

DistantLight light_of(const Sum& sum) {
    const double together = sum.together();
    DistantLight light;
    if (together > 0.0)
        light.direction = glm::vec3(sum.toward / together);
    light.spread = static_cast<float>(
        std::sqrt(std::max(0.0, 1.0 - together / std::max(sum.brightness, 1e-30))));
    light.irradiance = glm::vec3(sum.light);
    return light;
}

// Splits patches until there are `count`.
void split(const Cells& cells, unsigned count, std::list<EnvironmentPatch>& patches) {
    while (patches.size() < count) {
        auto best = patches.begin();
        for (auto it = patches.begin(); it != patches.end(); ++it)
            if (it->gain > best->gain)
                best = it;
        if (!(best->gain > 0.0))
            break;
        EnvironmentPatch second = *best;
        (best->along_x ? best->x1 : best->y1) = best->at;
        (second.along_x ? second.x0 : second.y0) = second.at;
        find_split(cells, *best);
        find_split(cells, second);
        patches.insert(std::next(best), second);
    }
}

// The mean square of the spreads, weighted by brightness.
double spread_of(const std::list<EnvironmentPatch>& patches) {
    double spread = 0, brightness = 0;
    for (const EnvironmentPatch& patch : patches) {
        spread += patch.sum.brightness - patch.sum.together();
        brightness += patch.sum.brightness;
    }
    return brightness > 0.0 ? spread / brightness : 0.0;
}

std::list<EnvironmentPatch> split(const Cells& cells, std::optional<unsigned> count) {
    std::list<EnvironmentPatch> patches{{0, 0, columns, rows, {}}};
    find_split(cells, patches.front());
    split(cells, count.value_or(DistantLights::least), patches);
    // That of three softboxes is 0.004, that of skies and rooms with windows about 0.05.
    constexpr double most_spread = 0.02;
    if (!count && spread_of(patches) > most_spread)
        split(cells, DistantLights::most, patches);
    return patches;
}

} // namespace

DistantLights::DistantLights(const ModelLight& light, std::optional<unsigned> count)
    : cosines_(row_cosines(rows)) {
    const Cells cells = cells_of(*light.environment);
    for (const EnvironmentPatch& patch : split(cells, count)) {
        if (!(patch.sum.brightness > 0.0))
            continue;
        Part part{light_of(patch.sum), {}, {}};
        double sum = 0;
        for (std::uint32_t y = patch.y0; y < patch.y1; ++y) {
            Row row{y, patch.x0, {}, {}};
            double bright = 0;
            for (std::uint32_t x = patch.x0; x < patch.x1; ++x) {
                const Sum& cell = cells[std::size_t{y} * columns + x];
                bright += cell.brightness;
                row.brightness.push_back(bright);
                row.light.push_back(cell.brightness > 0.0
                                        ? cell.light * (patch.sum.brightness / cell.brightness)
                                        : glm::dvec3(0.0));
            }
            if (!(bright > 0.0))
                continue;
            sum += bright;
            part.brightness.push_back(sum);
            part.rows.push_back(std::move(row));
        }
        parts_.push_back(std::move(part));
    }
    const auto add_sharp = [&](const glm::dvec3& direction, const glm::dvec3& irradiance) {
        parts_.push_back({{.direction = glm::vec3(direction),
                           .spread = 0.0f,
                           .irradiance = glm::vec3(irradiance)},
                          {},
                          {}});
    };
    if (light.sun)
        add_sharp(light.sun->direction, light.sun->irradiance);
    for (const ModelLamp& lamp : light.lamps)
        if (lamp.kind == ModelLamp::Kind::directional)
            add_sharp(-lamp.direction, lamp.strength);
}

std::vector<DistantLight> DistantLights::lights(double exposure) const {
    std::vector<DistantLight> lights;
    for (const Part& part : parts_) {
        lights.push_back(part.light);
        lights.back().irradiance = glm::vec3(glm::dvec3(part.light.irradiance) * exposure);
    }
    return lights;
}

DistantLights::Sample DistantLights::sample(std::size_t number, const glm::dvec2& random) const {
    const Part& part = parts_[number];
    if (part.rows.empty())
        return {glm::dvec3(part.light.direction), glm::dvec3(part.light.irradiance)};
    const auto [y, along_y] = sample_sums(part.brightness, random.y * part.brightness.back());
    const Row& row = part.rows[y];
    const auto [x, along_x] = sample_sums(row.brightness, random.x * row.brightness.back());
    return {direction_in_cell(row.x0 + x, row.y, columns, cosines_, {along_x, along_y}),
            row.light[x]};
}

} // namespace tessera::corpus
