// Which rays make up a texel.
//
// A sample is displaced from the texel's centre by 1/256ths of the texel along each axis. That is
// fine enough for 65536 samples in four dimensions, and lets the sine and cosine of its angles come
// from the texel's own and a table of 256 by the addition theorems instead of from libm.
#pragma once

#include "corpus/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tessera::corpus {

struct SinCos {
    double sin = 0.0;
    double cos = 1.0;
};

inline SinCos sum_of(const SinCos& a, const SinCos& b) {
    return {a.sin * b.cos + a.cos * b.sin, a.cos * b.cos - a.sin * b.sin};
}

// Displacement along u, v, s, t: 0..255 stands for (value + 0.5) / 256 - 0.5 texels.
using Jitter = std::array<std::uint8_t, 4>;

// Longitude, latitude, alpha and beta of a texel or a sample.
using Angles = std::array<SinCos, 4>;

// The rays of every texel of one texture. Immutable, hence thread-safe.
class Sampler {
public:
    Sampler(const Extent4& size, unsigned samples, std::uint64_t seed);

    unsigned count() const { return static_cast<unsigned>(points_.size()); }
    // Sine and cosine of the angle at the centre of texel `index` along `axis`.
    SinCos centre(int axis, std::uint32_t index) const;
    // Half of a texel's width along `axis`, in radians.
    double half_width(int axis) const { return half_width_[static_cast<std::size_t>(axis)]; }

    // The displacement common to all samples of a texel (Cranley-Patterson rotation). `key` names
    // the texel.
    Jitter rotation(std::uint64_t key) const;
    // Angles of sample `sample` of the texel at `centre`.
    Angles angles(const Angles& centre, unsigned sample, const Jitter& rotation) const;

private:
    Extent4 size_;
    std::uint64_t seed_;
    std::array<double, 4> half_width_;
    std::vector<Jitter> points_;
    std::array<std::array<SinCos, 256>, 4> offset_;
};

// Along the direction -d, from the surface place to what lies behind it; format/geometry.h's formulas on
// sines and cosines, which agree with it everywhere but on the axis, where no sample lies. From inside, the
// frame at a place is that of its antipode.
Ray window_ray(const SphereWindow& window, const Angles& angles);
glm::dvec3 place_normal(const SinCos& longitude, const SinCos& latitude);

} // namespace tessera::corpus
