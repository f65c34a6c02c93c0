#include "corpus/fit/texture_field.h"

#include <algorithm>
#include <cmath>

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

} // namespace

FieldTaps taps(const TextureField& field, const PhotoSample& sample) {
    const Between u = between(sample.u, field.width), v = between(sample.v, field.height);
    const int right = static_cast<int>(field.width) - 1,
              bottom = static_cast<int>(field.height) - 1;
    std::array<std::uint32_t, 4> places;
    std::array<float, 4> place_weights;
    for (int i = 0; i < 4; ++i) {
        const bool far_u = (i & 1) != 0, far_v = (i & 2) != 0;
        const int x = std::clamp(u.low + far_u, 0, right), y = std::clamp(v.low + far_v, 0, bottom);
        const auto k = static_cast<std::size_t>(i);
        places[k] = static_cast<std::uint32_t>(y) * field.width + static_cast<std::uint32_t>(x);
        place_weights[k] = (far_u ? u.share : 1.0f - u.share) * (far_v ? v.share : 1.0f - v.share);
    }
    FieldTaps all;
    const std::size_t seen_places = field.places() == 1 ? 1 : 4;
    if (seen_places == 1)
        place_weights[0] = 1.0f;
    if (field.directions == 1) {
        for (std::size_t i = 0; i < seen_places; ++i) {
            all.first[i] = 3 * places[i];
            all.weight[i] = place_weights[i];
        }
        all.count = static_cast<unsigned>(seen_places);
        return all;
    }
    const Between s = between(sample.s, field.directions), t = between(sample.t, field.directions);
    const auto per_place = static_cast<std::uint32_t>(field.texels_per_place());
    for (int k = 0; k < 4; ++k) {
        const bool far_s = (k & 1) != 0, far_t = (k & 2) != 0;
        const std::uint32_t texel =
            folded(s.low + far_s, t.low + far_t, static_cast<int>(field.directions));
        const float weight =
            (far_s ? s.share : 1.0f - s.share) * (far_t ? t.share : 1.0f - t.share);
        for (std::size_t i = 0; i < seen_places; ++i) {
            all.first[all.count] = 3 * (places[i] * per_place + texel);
            all.weight[all.count++] = place_weights[i] * weight;
        }
    }
    return all;
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
    const int n = static_cast<int>(field.directions);
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
            if (n == 1)
                continue;
            // Each texel and the next along s and t, and along two edges the neighbours before it,
            // which lie on the same edge. Those of the other edges are its neighbours behind.
            for (int t = 0; t < n; ++t)
                for (int s = 0; s < n; ++s) {
                    const std::size_t at = place * per_place + static_cast<std::size_t>(t * n + s);
                    const auto pull_to = [&](int to_s, int to_t) {
                        pull(at, place * per_place + folded(to_s, to_t, n), 1,
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
