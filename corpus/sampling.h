// The rays of a texel.
//
// Samples lie on a grid of 1/256 texel along each axis, which is fine enough for 65536 samples in
// four dimensions. The addition theorems give the sine and cosine of their angles from those of the
// texel's centre and a table of 256 offsets, so that libm is not called for each sample.
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

// An offset along u, v, s, t: a value in 0..255 stands for (value + 0.5) / 256 - 0.5 texels.
using Jitter = std::array<std::uint8_t, 4>;

// Longitude, latitude, alpha and beta of a texel's centre or a sample.
using Angles = std::array<SinCos, 4>;

// The samples of all texels of one texture. Immutable and thread-safe.
class Sampler {
public:
    Sampler(const Extent4& size, unsigned samples, std::uint64_t seed);

    unsigned count() const { return static_cast<unsigned>(points_.size()); }
    // Sine and cosine of the angle at the centre of texel `index` along `axis`.
    SinCos centre(int axis, std::uint32_t index) const;
    // Half the width of a texel along `axis`, in radians.
    double half_width(int axis) const { return half_width_[static_cast<std::size_t>(axis)]; }

    // The shift of all samples of the texel with the number `key` (Cranley-Patterson rotation).
    Jitter rotation(std::uint64_t key) const;
    // The angles of one sample of the texel whose centre has the angles `centre`.
    Angles angles(const Angles& centre, unsigned sample, const Jitter& rotation) const;

private:
    Extent4 size_;
    std::uint64_t seed_;
    std::array<double, 4> half_width_;
    std::vector<Jitter> points_;
    std::array<std::array<SinCos, 256>, 4> offset_;
};

// The ray from the place on the window into the scene, along -d. These are the formulas of
// format/sampler.h on sines and cosines; they agree except on the axis, where no sample lies. For
// a window that is seen from inside, the frame is that of the opposite place.
Ray window_ray(const SphereWindow& window, const Angles& angles);
glm::dvec3 place_normal(const SinCos& longitude, const SinCos& latitude);

} // namespace tessera::corpus
