#include "format/surface_mesh.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// Two neighbouring texels on an axis. The first may be -1, and the second may be the axis's extent.
struct Taps {
    std::int64_t texel[2];
    double weight[2];
};

Taps taps_at(double coordinate, std::uint32_t extent) {
    const double position = std::clamp(coordinate, 0.0, 1.0) * extent - 0.5;
    const double low = std::floor(position);
    const auto first = static_cast<std::int64_t>(low);
    return {{first, first + 1}, {1 - (position - low), position - low}};
}

std::uint32_t clamped(std::int64_t texel, std::uint32_t extent) {
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(texel, 0, std::int64_t{extent} - 1));
}

// In the mirrored map, the texels beyond an edge of the square are those along the same edge in
// reverse order.
std::array<std::uint32_t, 2> folded(std::int64_t s, std::int64_t t, const Extent4& size) {
    const std::int64_t last_s = std::int64_t{size[axis_s]} - 1;
    const std::int64_t last_t = std::int64_t{size[axis_t]} - 1;
    if (s < 0 || s > last_s) {
        s = std::clamp<std::int64_t>(s, 0, last_s);
        t = last_t - t;
    }
    if (t < 0 || t > last_t) {
        t = std::clamp<std::int64_t>(t, 0, last_t);
        s = last_s - s;
    }
    return {static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(t)};
}

} // namespace

Footprint mesh_footprint(const Extent4& size, AngularMap map, const glm::dvec2& uv,
                         const glm::dvec2& st) {
    const Taps u = taps_at(uv.x, size[axis_u]), v = taps_at(uv.y, size[axis_v]);
    const Taps s = taps_at(st.x, size[axis_s]), t = taps_at(st.y, size[axis_t]);
    const bool folds = map == AngularMap::octahedral_mirrored;
    Footprint out;
    std::size_t next = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i)
            for (int l = 0; l < 2; ++l)
                for (int k = 0; k < 2; ++k) {
                    const std::array<std::uint32_t, 2> angle =
                        folds ? folded(s.texel[k], t.texel[l], size)
                              : std::array{clamped(s.texel[k], size[axis_s]),
                                           clamped(t.texel[l], size[axis_t])};
                    out[next++] = {.u = clamped(u.texel[i], size[axis_u]),
                                   .v = clamped(v.texel[j], size[axis_v]),
                                   .s = angle[0],
                                   .t = angle[1],
                                   .weight = u.weight[i] * v.weight[j] * s.weight[k] * t.weight[l]};
                }
    return out;
}

} // namespace tessera
