// Textures in memory, including a set of textures that are each difficult to code in one way.
#pragma once

#include "format/samples.h"
#include "format/texture.h"
#include "tests/support/random.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tessera::test {

class MemoryTexture : public TexelSource {
public:
    // sample(u, v, s, t, channel) returns a value, which is clamped to 0..1 for unorm8.
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

    Bytes texels; // the whole texture, in box order

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

// Textures that are each difficult in one way, for any size. Half floats are scaled to the HDR
// range.
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

} // namespace tessera::test
