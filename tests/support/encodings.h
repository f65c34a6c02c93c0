// Small textures that together exercise every decision of the encoder. Their encodings are frozen
// in tests/golden/encodings.txt; every machine and compiler must produce the same bytes.
#pragma once

#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/support/fnv1a.h"
#include "tests/support/memory_texture.h"

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace tessera::test {

// Computes texels, 0..1023, with integers only, because floating-point functions of the C library
// differ in their last bits.
using Pattern = int (*)(int u, int v, int s, int t, int c);

// Smooth noise, 0..255: random values at every 4th position, interpolated between.
inline int smooth_noise(int x, int y, int seed) {
    const auto at = [seed](int i, int j) {
        std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1u ^
                          static_cast<std::uint32_t>(j) * 0x85EBCA77u ^
                          static_cast<std::uint32_t>(seed) * 0xC2B2AE3Du;
        h = (h ^ h >> 15) * 0x2C1B3C6Du;
        return static_cast<int>(h >> 24);
    };
    x += 4096, y += 4096; // avoids negative remainders
    const int i = x / 4, j = y / 4, a = x % 4, b = y % 4;
    return ((at(i, j) * (4 - a) + at(i + 1, j) * a) * (4 - b) +
            (at(i, j + 1) * (4 - a) + at(i + 1, j + 1) * a) * b) /
           16;
}

// Painted surface with a highlight that follows the view.
inline int composed(int u, int v, int s, int t, int c) {
    const int paint = (3 * u + 2 * v + 7 * c) / 16 % 3 * 180 + smooth_noise(u, v, 3) / 2;
    const int x = 2 * u - 5 * s - 10, y = 2 * v - 4 * t - 6;
    return paint + std::max(0, 500 - 6 * (x * x + y * y) / (2 + c));
}

// The surroundings as a mirror shows them: they move from view to view.
inline int mirror(int u, int v, int s, int t, int c) {
    const int x = u + 3 * s, y = v + 3 * t;
    return 3 * smooth_noise(x, y, 1) + (x / 5 % 2 == y / 7 % 2 ? 60 * c : 200);
}

// Views of a camera grid: a near disc in front of a far wall. Per view the disc moves by 2 texels
// and the wall by half a texel.
inline int captured(int u, int v, int s, int t, int c) {
    const int x = u + 2 * s - 20, y = v + 2 * t - 14;
    return x * x + y * y < 90 ? 900 - 2 * smooth_noise(x, y, 5 + c / 2)
                              : 2 * smooth_noise(2 * u + s, 2 * v + t, 2) + 100 * c;
}

// Channels that have nothing in common.
inline int unlike(int u, int v, int s, int t, int c) {
    return c == 0 ? composed(u, v, s, t, c) : mirror(u, v, s, t, c);
}

// Noise whose channels are strongly correlated.
inline int noise(int u, int v, int s, int t, int c) {
    return smooth_noise(4 * (u + 31 * s), 4 * (v + 37 * t), 9) * (c + 1) +
           smooth_noise(4 * (u + 31 * s), 4 * (v + 37 * t), 10 + c) / 4;
}

// A few objects on a constant background.
inline int sparse(int u, int v, int s, int t, int c) {
    return u / 6 % 3 == 1 && v / 5 % 2 == 1 ? composed(u, v, s, t, c) : 77;
}

// A mask: only the texels of a disc matter.
inline int disc(int u, int v, int, int, int) {
    return (u - 10) * (u - 10) + (v - 8) * (v - 8) < 80 ? 1023 : 0;
}

// Encoder settings other than the rate.
struct Setting {
    Extent4 tile_extent = tile_by_trial;
    bool layers = false, has_mask = false, is_slow_to_reread = false;
    double gain = 1.0 / 1023; // scale from patterns to samples
};

struct Encoding {
    const char* name; // begins with the effort
    Pattern pattern;
    TextureDesc desc;
    RateTarget rate;
    Setting setting = {};

    int effort() const { return name[0] - '0'; }
};

inline std::vector<Encoding> encodings() {
    using Kind = RateTarget::Kind;
    constexpr SampleType byte = SampleType::unorm8, half = SampleType::half16;
    const Setting dark{.gain = 0.25}, bright_tiles{.tile_extent = {8, 7, 4, 3}, .gain = 37},
        small_tiles{.tile_extent = {8, 7, 4, 3}},
        layers{.tile_extent = {8, 8, 4, 4}, .layers = true}, bright{.gain = 37},
        in_a_disc{.tile_extent = {8, 7, 4, 3}, .has_mask = true},
        baked{.is_slow_to_reread = true, .gain = 0.25};
    return {
        {"0_composed", composed, {{24, 16, 8, 8}, byte, 3}, {Kind::quality, 60}},
        {"0_captured", captured, {{40, 35, 5, 4}, byte, 3}, {Kind::quality, 58}},
        {"0_mirror_rate", mirror, {{17, 12, 5, 8}, byte, 4}, {Kind::bpt, 1.5}},
        {"0_sparse_psnr", sparse, {{30, 21, 4, 3}, half, 3}, {Kind::psnr, 44}, bright_tiles},
        {"0_noise_exact", noise, {{8, 7, 3, 4}, byte, 3}, {Kind::max_error, 0}},

        {"1_composed", composed, {{24, 16, 8, 8}, byte, 3}, {Kind::quality, 60}},
        {"1_captured", captured, {{40, 35, 5, 4}, byte, 3}, {Kind::quality, 58}},
        {"1_sparse_masked", sparse, {{24, 18, 4, 3}, byte, 2}, {Kind::bytes, 1300}, in_a_disc},
        {"1_mirror_bounded", mirror, {{13, 9, 4, 4}, byte, 1}, {Kind::max_error, 2}},
        {"1_half_exact", composed, {{8, 9, 3, 4}, half, 3}, {Kind::max_error, 0}, dark},
        {"1_layers", mirror, {{24, 20, 5, 5}, byte, 3}, {Kind::quality, 50}, layers},

        {"2_mirror", mirror, {{20, 12, 6, 6}, byte, 3}, {Kind::quality, 60}},
        {"2_captured", captured, {{40, 35, 5, 4}, byte, 3}, {Kind::quality, 58}},
        {"2_composed_psnr", composed, {{16, 9, 4, 4}, byte, 4}, {Kind::psnr, 38}, small_tiles},
        {"2_picture", mirror, {{70, 66, 1, 1}, byte, 1}, {Kind::bpt, 1.0}},
        {"2_half", composed, {{20, 16, 3, 3}, half, 3}, {Kind::quality, 70}, bright},

        {"3_mirror", mirror, {{18, 11, 5, 5}, byte, 3}, {Kind::quality, 60}},
        {"3_captured", captured, {{34, 33, 3, 3}, byte, 3}, {Kind::quality, 62}},
        {"3_captured_large", captured, {{60, 48, 5, 5}, byte, 3}, {Kind::quality, 45}},
        {"3_picture", composed, {{70, 40, 1, 1}, byte, 3}, {Kind::quality, 66}},
        {"3_picture_half", mirror, {{33, 21, 1, 1}, half, 4}, {Kind::psnr, 50}, bright},
        {"3_picture_pair", unlike, {{70, 60, 1, 1}, byte, 2}, {Kind::quality, 60}},
        {"3_noise", noise, {{12, 8, 4, 4}, byte, 3}, {Kind::quality, 85}},
        {"3_composed_rate", composed, {{12, 11, 4, 4}, byte, 3}, {Kind::bpt, 4.5}},
        {"3_half_baked", composed, {{9, 12, 5, 4}, half, 3}, {Kind::psnr, 50}, baked},
        {"3_sparse_masked", sparse, {{24, 16, 4, 3}, byte, 3}, {Kind::quality, 70}, in_a_disc},

        {"4_composed", composed, {{14, 10, 4, 5}, byte, 3}, {Kind::quality, 70}},
        {"4_captured", captured, {{20, 16, 4, 3}, byte, 3}, {Kind::quality, 60}},
        {"4_picture", mirror, {{90, 70, 1, 1}, byte, 3}, {Kind::quality, 60}},
    };
}

// Returns a line of encodings.txt: name, size of the file in bytes, hashes of the file and of its
// decoded texels, PSNR.
inline Result<std::string> encoded_line(const Encoding& encoding) {
    class Source : public MemoryTexture {
    public:
        explicit Source(const Encoding& e)
            : MemoryTexture(e.desc,
                            [&e](int u, int v, int s, int t, int c) {
                                return e.pattern(u, v, s, t, c) * e.setting.gain;
                            }),
              is_slow_(e.setting.is_slow_to_reread) {}
        bool cheap_to_reread() const override { return !is_slow_; }

    private:
        const bool is_slow_;
    } source(encoding);
    const TextureDesc& desc = encoding.desc;
    MemoryTexture mask({{desc.size[0], desc.size[1], 1, 1}, SampleType::unorm8, 1}, disc);
    EncodeOptions options;
    options.rate = encoding.rate;
    options.effort = encoding.effort();
    options.tile_extent = encoding.setting.tile_extent;
    options.layers = encoding.setting.layers;
    options.mask = encoding.setting.has_mask ? &mask : nullptr;
    options.metadata = {{"Software", "golden"}}; // fixed: the default contains the version
    Bytes file;
    TESSERA_TRY_ASSIGN(const EncodeReport report, encode_memory(source, file, options));
    TESSERA_TRY_ASSIGN(const Decoder decoder, Decoder::open(wrap_memory(file)));
    const Box4 all = Box4::whole(desc.size);
    Bytes texels(desc.box_bytes(all));
    TESSERA_TRY(decoder.decode_box(all, texels));
    char figures[96];
    std::snprintf(figures, sizeof figures, " %zu %016" PRIx64 " %016" PRIx64 " %.9g", file.size(),
                  fnv1a_64(file), fnv1a_64(texels), report.psnr);
    return encoding.name + std::string(figures);
}

} // namespace tessera::test
