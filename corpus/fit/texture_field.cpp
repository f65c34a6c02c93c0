#include "corpus/fit/texture_field.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::corpus {
namespace {

// The two texels around a coordinate, and the weight of the second.
struct Between {
    int low;
    float share;
};

Between between(float coordinate, std::uint32_t count) {
    const float x = coordinate * static_cast<float>(count) - 0.5f;
    const float low = std::floor(x);
    return {static_cast<int>(low), x - low};
}

// Beyond the edge of the octahedral square, (s, t) continue on the same side, mirrored.
std::uint32_t folded(int s, int t, int n) {
    if (s < 0 || s >= n) {
        s = std::clamp(s, 0, n - 1);
        t = n - 1 - t;
    }
    if (t < 0 || t >= n) {
        t = std::clamp(t, 0, n - 1);
        s = n - 1 - s;
    }
    return static_cast<std::uint32_t>(t * n + s);
}

// The four places around a sample, and their weights. Fields with one place have only the first.
struct NearPlaces {
    std::array<std::uint32_t, 4> places;
    std::array<float, 4> weights{1.0f, 0.0f, 0.0f, 0.0f};
    std::size_t count = 1;
};

NearPlaces places_around(const TextureField& field, const PhotoSample& sample) {
    const Between u = between(sample.u, field.width), v = between(sample.v, field.height);
    const int width = static_cast<int>(field.width), bottom = static_cast<int>(field.height) - 1;
    const bool wraps = field.map == AngularMap::hemisphere_alpha_beta;
    NearPlaces near;
    for (int i = 0; i < 4; ++i) {
        const bool far_u = (i & 1) != 0, far_v = (i & 2) != 0;
        const int x =
            wraps ? (u.low + far_u + width) % width : std::clamp(u.low + far_u, 0, width - 1);
        const int y = std::clamp(v.low + far_v, 0, bottom);
        const auto k = static_cast<std::size_t>(i);
        near.places[k] =
            static_cast<std::uint32_t>(y) * field.width + static_cast<std::uint32_t>(x);
        if (field.places() > 1)
            near.weights[k] =
                (far_u ? u.share : 1.0f - u.share) * (far_v ? v.share : 1.0f - v.share);
    }
    near.count = field.places() == 1 ? 1 : 4;
    return near;
}

// The four directions around (s, t), and their weights.
struct NearDirections {
    std::array<std::uint32_t, 4> texels;
    std::array<float, 4> weights;
};

NearDirections directions_around(const TextureField& field, float at_s, float at_t) {
    const int wide = static_cast<int>(field.directions[0]),
              high = static_cast<int>(field.directions[1]);
    const Between s = between(at_s, field.directions[0]), t = between(at_t, field.directions[1]);
    NearDirections near;
    for (int i = 0; i < 4; ++i) {
        const bool far_s = (i & 1) != 0, far_t = (i & 2) != 0;
        const auto k = static_cast<std::size_t>(i);
        near.texels[k] =
            field.map == AngularMap::octahedral_mirrored
                ? folded(s.low + far_s, t.low + far_t, wide)
                : static_cast<std::uint32_t>(std::clamp(t.low + far_t, 0, high - 1) * wide +
                                             std::clamp(s.low + far_s, 0, wide - 1));
        near.weights[k] = (far_s ? s.share : 1.0f - s.share) * (far_t ? t.share : 1.0f - t.share);
    }
    return near;
}

constexpr float pi = std::numbers::pi_v<float>;

float clamped_arc_sine(float x) {
    return std::asin(std::clamp(x, -1.0f, 1.0f));
}

// direction_angles() in single precision.
std::array<float, 2> angles_in(const std::array<glm::vec3, 3>& frame, const glm::vec3& d) {
    const float x = glm::dot(frame[0], d), z = glm::dot(frame[2], d);
    const float planar = std::sqrt(x * x + z * z);
    float s = 0.5f;
    if (planar > 1e-6f)
        s = z < 0.0f ? (x < 0.0f ? 0.0f : 1.0f) : clamped_arc_sine(x / planar) / pi + 0.5f;
    return {s, clamped_arc_sine(glm::dot(frame[1], d)) / pi + 0.5f};
}

using DirectionTexel = std::array<std::uint32_t, 2>; // along s and t

// The direction of a texel's centre in a frame.
glm::vec3 direction_of(const TextureField& field, std::size_t place, const DirectionTexel& texel) {
    const auto angle = [&](std::size_t axis) {
        return pi * ((static_cast<float>(texel[axis]) + 0.5f) /
                         static_cast<float>(field.directions[axis]) -
                     0.5f);
    };
    const float a = angle(0), b = angle(1);
    const auto& [ex, ey, ez] = field.frames[place];
    return ex * (std::sin(a) * std::cos(b)) + ey * std::sin(b) + ez * (std::cos(a) * std::cos(b));
}

std::uint32_t texel_at(const TextureField& field, std::size_t place, const DirectionTexel& texel) {
    return static_cast<std::uint32_t>(
        (place * field.directions[1] + texel[1]) * field.directions[0] + texel[0]);
}

// The texel whose place on a sphere of radius 1 and whose direction are nearest.
std::uint32_t nearest_texel(const TextureField& field, const glm::vec3& normal,
                            const glm::vec3& direction) {
    const auto nearest = [](double x, std::uint32_t n) {
        return std::min(static_cast<std::uint32_t>(std::max(x, 0.0) * n), n - 1);
    };
    const glm::dvec2 uv = sphere_place(glm::dvec3(normal));
    const std::uint32_t place =
        nearest(uv.y, field.height) * field.width + nearest(uv.x, field.width);
    const auto [s, t] = angles_in(field.frames[place], direction);
    return texel_at(field, place,
                    {nearest(static_cast<double>(s), field.directions[0]),
                     nearest(static_cast<double>(t), field.directions[1])});
}

// The texel whose direction is a step further and which shows the same point of the sphere of the
// radius `focus`. The texel itself where there is no further direction.
std::uint32_t neighbour_in_focus(const TextureField& field, std::size_t place,
                                 const DirectionTexel& texel, const DirectionTexel& step,
                                 double focus) {
    const DirectionTexel next{texel[0] + step[0], texel[1] + step[1]};
    if (next[0] >= field.directions[0] || next[1] >= field.directions[1])
        return texel_at(field, place, texel);
    if (focus >= 1.0)
        return texel_at(field, place, next);
    const glm::vec3 normal = field.frames[place][2], from = direction_of(field, place, texel),
                    to = direction_of(field, place, next);
    // Rays that miss the inner sphere count where they are nearest to it.
    const float cosine = glm::dot(normal, from);
    const float square = cosine * cosine - 1.0f + static_cast<float>(focus * focus);
    const glm::vec3 point = normal - (cosine - std::sqrt(std::max(square, 0.0f))) * from;
    const float along = glm::dot(point, to);
    const float outwards =
        std::sqrt(std::max(along * along + 1.0f - glm::dot(point, point), 0.0f)) - along;
    return nearest_texel(field, point + outwards * to, to);
}

} // namespace

TextureField make_sphere_field(std::uint32_t width, std::uint32_t height,
                               std::array<std::uint32_t, 2> directions, double focus) {
    TextureField field = make_window_field(width, height, directions);
    field.map = AngularMap::hemisphere_alpha_beta;
    for (std::uint32_t v = 0; v < height; ++v)
        for (std::uint32_t u = 0; u < width; ++u) {
            const SurfaceFrame frame =
                sphere_frame(Proxy::sphere, (u + 0.5) / width, (v + 0.5) / height);
            field.frames.push_back({glm::vec3(frame.ex), glm::vec3(frame.ey), glm::vec3(frame.ez)});
        }
    for (std::size_t place = 0; place < field.places(); ++place)
        for (std::uint32_t t = 0; t < directions[1]; ++t)
            for (std::uint32_t s = 0; s < directions[0]; ++s)
                field.next_directions.push_back(
                    {neighbour_in_focus(field, place, {s, t}, {1, 0}, focus),
                     neighbour_in_focus(field, place, {s, t}, {0, 1}, focus)});
    return field;
}

TextureField make_window_field(std::uint32_t width, std::uint32_t height,
                               std::array<std::uint32_t, 2> directions) {
    TextureField field;
    field.width = width;
    field.height = height;
    field.directions = directions;
    field.map = AngularMap::planar_views;
    field.charts.assign(field.places(), 1);
    field.clear();
    return field;
}

FieldTaps taps(const TextureField& field, const PhotoSample& sample) {
    const NearPlaces near = places_around(field, sample);
    FieldTaps all;
    const auto per_place = static_cast<std::uint32_t>(field.texels_per_place());
    if (per_place == 1) {
        for (std::size_t i = 0; i < near.count; ++i) {
            all.first[i] = 3 * near.places[i];
            all.weight[i] = near.weights[i];
        }
        all.count = static_cast<unsigned>(near.count);
        return all;
    }
    if (field.map == AngularMap::hemisphere_alpha_beta) {
        // The direction has its own angles in the frame of each place.
        const glm::vec3 d = direction_at(sample.s, sample.t);
        for (std::size_t i = 0; i < near.count; ++i) {
            const auto [s, t] = angles_in(field.frames[near.places[i]], d);
            const NearDirections around = directions_around(field, s, t);
            for (std::size_t k = 0; k < 4; ++k) {
                all.first[all.count] = 3 * (near.places[i] * per_place + around.texels[k]);
                all.weight[all.count++] = near.weights[i] * around.weights[k];
            }
        }
        return all;
    }
    const NearDirections around = directions_around(field, sample.s, sample.t);
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t i = 0; i < near.count; ++i) {
            all.first[all.count] = 3 * (near.places[i] * per_place + around.texels[k]);
            all.weight[all.count++] = near.weights[i] * around.weights[k];
        }
    return all;
}

PhotoSample centre_of_texel(const TextureField& field, std::size_t texel) {
    const std::size_t per_place = field.texels_per_place(), place = texel / per_place;
    const auto centre = [](std::size_t i, std::uint32_t n) {
        return (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
    };
    const std::size_t wide = field.directions[0], direction = texel % per_place;
    PhotoSample sample{centre(place % field.width, field.width),
                       centre(place / field.width, field.height),
                       centre(direction % wide, field.directions[0]),
                       centre(direction / wide, field.directions[1]), 1.0f};
    if (field.map == AngularMap::hemisphere_alpha_beta) {
        const auto [s, t] =
            place_of_direction(direction_of(field, place,
                                            {static_cast<std::uint32_t>(direction % wide),
                                             static_cast<std::uint32_t>(direction / wide)}));
        sample.s = s;
        sample.t = t;
    }
    return sample;
}

void add_smoothness(const TextureField& field, const std::vector<float>& values,
                    std::vector<float>& out) {
    const auto shrink = static_cast<float>(field.shrink);
    for (std::size_t i = 0; i < values.size(); ++i)
        out[i] += shrink * values[i];
    // Pulls `count` texels and their neighbours together.
    const auto pull = [&](std::size_t a, std::size_t b, std::size_t count, double cost) {
        const auto factor = static_cast<float>(cost);
        for (std::size_t i = 0; i < 3 * count; ++i) {
            const float difference = factor * (values[3 * a + i] - values[3 * b + i]);
            out[3 * a + i] += difference;
            out[3 * b + i] -= difference;
        }
    };
    const std::size_t per_place = field.texels_per_place();
    const int wide = static_cast<int>(field.directions[0]),
              high = static_cast<int>(field.directions[1]);
    const bool is_sphere = field.map == AngularMap::hemisphere_alpha_beta;
    for (std::uint32_t y = 0; y < field.height; ++y)
        for (std::uint32_t x = 0; x < field.width; ++x) {
            const std::size_t place = std::size_t{y} * field.width + x;
            const std::uint32_t chart = field.charts[place];
            if (chart == 0)
                continue;
            if (x + 1 < field.width && field.charts[place + 1] == chart)
                pull(place * per_place, (place + 1) * per_place, per_place, field.smooth_places);
            if (y + 1 < field.height && field.charts[place + field.width] == chart)
                pull(place * per_place, (place + field.width) * per_place, per_place,
                     field.smooth_places);
            if (is_sphere && x + 1 == field.width && x > 0)
                pull(place * per_place, (place - x) * per_place, per_place, field.smooth_places);
            if (per_place == 1)
                continue;
            const auto texel = [&](int s, int t) {
                return place * per_place + static_cast<std::size_t>(t * wide + s);
            };
            if (is_sphere) {
                for (std::size_t i = place * per_place; i < (place + 1) * per_place; ++i)
                    for (const std::uint32_t next : field.next_directions[i])
                        pull(i, next, 1, field.smooth_directions);
                continue;
            }
            if (field.map != AngularMap::octahedral_mirrored) {
                for (int t = 0; t < high; ++t)
                    for (int s = 0; s < wide; ++s) {
                        if (s + 1 < wide)
                            pull(texel(s, t), texel(s + 1, t), 1, field.smooth_directions);
                        if (t + 1 < high)
                            pull(texel(s, t), texel(s, t + 1), 1, field.smooth_directions);
                    }
                continue;
            }
            // Each texel and the next along s and t, and along two edges the neighbours before it,
            // which lie on the same edge. Those of the other edges are its neighbours behind.
            const int n = wide;
            for (int t = 0; t < n; ++t)
                for (int s = 0; s < n; ++s) {
                    const auto pull_to = [&](int to_s, int to_t) {
                        pull(texel(s, t), place * per_place + folded(to_s, to_t, n), 1,
                             field.smooth_directions);
                    };
                    if (s + 1 < n || t < n / 2)
                        pull_to(s + 1, t);
                    if (t + 1 < n || s < n / 2)
                        pull_to(s, t + 1);
                    if (s == 0 && t < n / 2)
                        pull_to(-1, t);
                    if (t == 0 && s < n / 2)
                        pull_to(s, -1);
                }
        }
}

} // namespace tessera::corpus
