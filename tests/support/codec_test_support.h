// What the tests of the codec share: random numbers, textures by name, random tiles, slow twins.
#pragma once

#include "format/texture.h"
#include "codec/entropy/tile_entropy.h"
#include "format/tile/colour_rotation.h"
#include "format/samples.h"
#include "format/tile/tile_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace tessera::test {

using Bytes = std::vector<std::byte>;

// The same numbers on every platform, unlike the standard distributions.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }
    // first..last
    int range(int first, int last) {
        const auto span = static_cast<std::int64_t>(last) - first + 1;
        return static_cast<int>(first + static_cast<std::int64_t>((*this)() % span));
    }
    double unit() { return (*this)() / 4294967296.0; }
    bool chance(double p) { return unit() < p; }
    Bytes bytes(std::size_t count) {
        Bytes result(count);
        for (std::byte& b : result)
            b = static_cast<std::byte>((*this)() & 255);
        return result;
    }

private:
    std::mt19937 engine_;
};

// A texture in memory.
class MemoryTexture : public TexelSource {
public:
    // sample(u, v, s, t, channel) gives a value that is clamped to 0..1 for unorm8.
    using Function = std::function<double(int, int, int, int, int)>;

    MemoryTexture(const TextureDesc& description, const Function& sample) : desc_(description) {
        texels.resize(desc_.box_bytes(Box4::whole(desc_.size)));
        std::size_t at = 0;
        for (int v = 0; v < side(1); ++v)
            for (int u = 0; u < side(0); ++u)
                for (int t = 0; t < side(3); ++t)
                    for (int s = 0; s < side(2); ++s)
                        for (int c = 0; c < desc_.channels; ++c)
                            at = store(at, sample(u, v, s, t, c));
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        copy_box(box, Box4::whole(desc_.size), texels, box, out, desc_.texel_bytes());
        return {};
    }

    Bytes texels; // the whole texture, box order

private:
    int side(int axis) const {
        return static_cast<int>(desc_.size[static_cast<std::size_t>(axis)]);
    }
    std::size_t store(std::size_t at, double value) {
        if (desc_.type == SampleType::unorm8) {
            texels[at] = static_cast<std::byte>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
            return at + 1;
        }
        const std::uint16_t half = float_to_half(static_cast<float>(value));
        texels[at] = static_cast<std::byte>(half & 255);
        texels[at + 1] = static_cast<std::byte>(half >> 8);
        return at + 2;
    }

    const TextureDesc desc_;
};

// Textures that are hard in one way each, for any size; half floats are scaled to the HDR range.
struct NamedTexture {
    const char* name;
    MemoryTexture::Function sample;
};
inline std::vector<NamedTexture> named_textures(const TextureDesc& desc) {
    const double gain = desc.type == SampleType::half16 ? 1000 : 1;
    const auto n = desc.size;
    const auto wave = [](double x) { return 0.5 + 0.5 * std::sin(x); };
    std::vector<NamedTexture> all = {
        {"black", [](int, int, int, int, int) { return 0.0; }},
        {"constant", [=](int, int, int, int, int c) { return gain * (0.2 + 0.17 * c); }},
        {"lambert",
         [=](int u, int v, int, int, int c) { return gain * wave(0.2 * u + 0.3 * v + c); }},
        {"smooth",
         [=](int u, int v, int s, int t, int c) {
             return gain * wave(0.11 * u + 0.07 * v + 0.3 * s - 0.2 * t + c) *
                    wave(0.05 * u - 0.1 * v + 0.1 * t);
         }},
        {"checkerboard",
         [=](int u, int v, int s, int t, int) { return gain * ((u + v + s + t) & 1); }},
        {"bright_texel",
         [=](int u, int v, int s, int t, int) {
             const auto middle = [&](int x, std::size_t a) {
                 return x == static_cast<int>(n[a] / 2);
             };
             return middle(u, 0) && middle(v, 1) && middle(s, 2) && middle(t, 3) ? gain : 0.0;
         }},
        {"grazing_ramp",
         [=](int u, int v, int s, int t, int c) {
             const double edge = 1.0 - (s + 0.5) / n[2];
             return gain * std::pow(edge, 8) * wave(0.9 * u + 0.4 * v + 0.1 * t + c);
         }},
    };
    const auto random = std::make_shared<Random>(7);
    all.push_back({"noise", [=](int, int, int, int, int) { return gain * random->unit(); }});
    return all;
}
inline MemoryTexture named_texture(const TextureDesc& desc, const std::string& name) {
    for (const NamedTexture& texture : named_textures(desc))
        if (texture.name == name)
            return MemoryTexture(desc, texture.sample);
    std::abort();
}

// A tile with a random tree and random levels.
struct RandomTileOptions {
    double split = 0.5, density = 0.2, empty = 0.2;
    int magnitude_bits = 4; // up to 20
    bool full_length = false;
};

class RandomTile {
public:
    RandomTile(Random& random, const TileCoding& coding, const RandomTileOptions& options)
        : random_(random), coding_(coding), options_(options) {}

    TileLevels make(const BlockShape& shape) {
        TileLevels tile;
        tile.shape = shape;
        leaves_ = 1;
        grow(Block{{0, 0, 0, 0}, shape, 0, 0}, tile);
        for (const Block& block : tile.blocks)
            fill(block.shape, tile);
        return tile;
    }

private:
    void grow(const Block& block, TileLevels& tile) {
        const auto wish = static_cast<Split>(random_.range(1, 2));
        if (leaves_ + 3 > max_leaves || !random_.chance(options_.split) ||
            !can_split(block.shape, wish)) {
            tile.splits.push_back(static_cast<std::uint8_t>(Split::none));
            tile.blocks.push_back(block);
            return;
        }
        tile.splits.push_back(static_cast<std::uint8_t>(wish));
        const Children children = children_of(block, wish);
        leaves_ += children.count - 1;
        for (int i = 0; i < children.count; ++i)
            grow(children.block[static_cast<std::size_t>(i)], tile);
    }

    void fill(const BlockShape& shape, TileLevels& tile) {
        const int scan = coding_.shape(shape).order.length();
        const int most = std::min(scan, 7 * (max_coded_length / 8)); // within a segment's work
        for (int plane = 0; plane < coding_.planes; ++plane) {
            PlaneLevels levels;
            levels.first = static_cast<std::uint32_t>(tile.nonzeros.size());
            if (!random_.chance(options_.empty)) {
                const int last = options_.full_length ? most - 1 : random_.range(0, most - 1);
                int state = 0;
                for (int i = 0; i <= last; ++i) {
                    int magnitude = 0;
                    if (i == last || random_.chance(options_.density)) {
                        magnitude = this->magnitude();
                        const int level = coding_.parameters.dependent
                                              ? 2 * magnitude - quantiser_of(state)
                                              : magnitude;
                        tile.nonzeros.push_back(
                            {static_cast<std::uint16_t>(i), random_.chance(0.5) ? level : -level});
                    }
                    if (coding_.parameters.dependent)
                        state = next_state[static_cast<std::size_t>(state)]
                                          [static_cast<std::size_t>(magnitude & 1)];
                }
                levels.count = static_cast<std::uint16_t>(tile.nonzeros.size() - levels.first);
                levels.coded_length =
                    static_cast<std::uint16_t>(round_up_coded_length(last + 1, scan));
            }
            tile.planes.push_back(levels);
            if (plane == 0) // no levels, no colour
                tile.colours.push_back(static_cast<std::uint8_t>(
                    coding_.rotates && levels.coded_length > 0 ? random_.range(0, rotation_count)
                                                               : 0));
        }
    }
    // Dependent levels are up to twice as large.
    int magnitude() {
        const int most = options_.magnitude_bits - (coding_.parameters.dependent ? 1 : 0);
        const int bits = random_.range(1, std::max(1, most));
        return random_.range(1, (1 << bits) - 1);
    }

    Random& random_;
    const TileCoding& coding_;
    const RandomTileOptions options_;
    int leaves_ = 1;
};

inline Parameters random_parameters(Random& random) {
    Parameters parameters;
    for (std::uint8_t& p : parameters)
        p = static_cast<std::uint8_t>(random.range(0, parameter_count_of_odds - 1));
    return parameters;
}

// Any filter that a file may have; in half of all cases with an influence that reaches far.
inline TileFilter random_filter(Random& random) {
    TileFilter filter;
    for (auto& rings : filter.ring)
        for (FilterRing& ring : rings)
            ring = {static_cast<std::int8_t>(random.range(-127, 127)),
                    static_cast<std::uint8_t>(random.chance(0.5) ? random.range(1, 32)
                                                                 : random.range(1, 255))};
    return filter;
}

inline BlockShape shape_of(int u, int v, int s, int t) {
    return {{static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v),
             static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(t)}};
}
inline std::string name_of(const BlockShape& shape) {
    return to_string(Extent4{shape.n[0], shape.n[1], shape.n[2], shape.n[3]});
}

// Orthonormal DCT-II in double precision: matrix[k * n + x].
inline const std::vector<double>& dct_matrix(int n) {
    static std::array<std::vector<double>, max_tile_side + 1> matrices;
    std::vector<double>& matrix = matrices[static_cast<std::size_t>(n)];
    for (int k = 0; k < n && static_cast<int>(matrix.size()) < n * n; ++k)
        for (int x = 0; x < n; ++x)
            matrix.push_back(std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n)) *
                             std::sqrt((k == 0 ? 1.0 : 2.0) / n));
    return matrix;
}

// One pass along an axis of an array with u fastest, in place.
inline void slow_dct_axis(std::vector<double>& x, const BlockShape& shape, int axis, bool inverse) {
    const std::size_t n = shape.n[static_cast<std::size_t>(axis)];
    std::size_t inner = 1;
    for (int a = 0; a < axis; ++a)
        inner *= shape.n[static_cast<std::size_t>(a)];
    const std::vector<double>& matrix = dct_matrix(static_cast<int>(n));
    const std::size_t row = inverse ? 1 : n, column = inverse ? n : 1;
    std::vector<double> line(n);
    for (std::size_t block = 0; block < x.size(); block += inner * n)
        for (std::size_t i = 0; i < inner; ++i) {
            for (std::size_t a = 0; a < n; ++a) {
                line[a] = 0;
                for (std::size_t b = 0; b < n; ++b)
                    line[a] += matrix[a * row + b * column] * x[block + b * inner + i];
            }
            for (std::size_t a = 0; a < n; ++a)
                x[block + a * inner + i] = line[a];
        }
}
inline void slow_dct(std::vector<double>& x, const BlockShape& shape, bool inverse) {
    for (int axis = 0; axis < 4; ++axis)
        if (shape.n[static_cast<std::size_t>(axis)] > 1)
            slow_dct_axis(x, shape, axis, inverse);
}

} // namespace tessera::test
