#include "format/sampler.h"

#include "format/samples.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// Two neighbours on one axis.
struct Neighbours {
    std::uint32_t texel[2];
    double weight[2];
};

// `coordinate` in 0..1; texel i of n lies at (i + 0.5) / n.
Neighbours neighbours(double coordinate, std::uint32_t n, bool wraps) {
    const double position = coordinate * n - 0.5;
    const double low = std::floor(position);
    Neighbours out{};
    out.weight[1] = position - low;
    out.weight[0] = 1 - out.weight[1];
    for (int i = 0; i < 2; ++i) {
        const auto texel = static_cast<std::int64_t>(low) + i; // -1..n
        const std::int64_t last = std::int64_t{n} - 1;
        out.texel[i] = static_cast<std::uint32_t>(wraps ? (texel < 0 ? last : texel % n)
                                                        : std::clamp<std::int64_t>(texel, 0, last));
    }
    return out;
}

} // namespace

Footprint sample_footprint(const Extent4& size, const glm::dvec3& from_centre, const glm::dvec3& d,
                           Proxy proxy) {
    const glm::dvec3 unit = glm::normalize(d);
    const glm::dvec2 place = sphere_place(from_centre);
    const Neighbours u = neighbours(place.x, size[axis_u], true);
    const Neighbours v = neighbours(place.y, size[axis_v], false);
    Footprint out;
    std::size_t next = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const SurfaceFrame frame = sphere_frame(proxy, (u.texel[i] + 0.5) / size[axis_u],
                                                    (v.texel[j] + 0.5) / size[axis_v]);
            const glm::dvec2 angles = direction_angles(frame, unit);
            const Neighbours s = neighbours(angles.x, size[axis_s], false);
            const Neighbours t = neighbours(angles.y, size[axis_t], false);
            for (int l = 0; l < 2; ++l)
                for (int k = 0; k < 2; ++k)
                    out[next++] = {.u = u.texel[i],
                                   .v = v.texel[j],
                                   .s = s.texel[k],
                                   .t = t.texel[l],
                                   .weight = u.weight[i] * v.weight[j] * s.weight[k] * t.weight[l]};
        }
    return out;
}

glm::dvec4 texel_value(const TextureDesc& desc, const std::byte* texel) {
    glm::dvec4 value{0.0};
    for (int c = 0; c < desc.channels; ++c, texel += sample_bytes(desc.type))
        value[c] = sample_value(load_sample(texel, desc.type), desc.type);
    return value;
}

Result<glm::dvec4> sample(TexelLookup& lookup, const Footprint& footprint) {
    glm::dvec4 sum{0.0};
    for (const WeightedTexel& w : footprint) {
        if (w.weight == 0)
            continue;
        TESSERA_TRY_ASSIGN(const glm::dvec4 texel, lookup.texel(w.u, w.v, w.s, w.t));
        sum += texel * w.weight;
    }
    return sum;
}

Result<glm::dvec4> sample(TexelLookup& lookup, const glm::dvec3& from_centre, const glm::dvec3& d,
                          Proxy proxy) {
    return sample(lookup, sample_footprint(lookup.desc().size, from_centre, d, proxy));
}

} // namespace tessera
