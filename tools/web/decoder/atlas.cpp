#include "tools/web/decoder/atlas.h"

#include "format/samples.h"
#include "tools/picture/tone_map.h"

#include <cstring>
#include <vector>

namespace tessera {
namespace {

// Converts `count` texels of grey, grey and alpha, RGB or RGBA, with one byte per sample.
template <int channels>
void bytes_to_rgba(const std::uint8_t* in, std::uint32_t count, std::uint8_t* out) {
    for (std::uint32_t i = 0; i < count; ++i, in += channels, out += 4) {
        out[0] = in[0];
        out[1] = in[channels > 2 ? 1 : 0];
        out[2] = in[channels > 2 ? 2 : 0];
        out[3] = channels == 4 ? in[3] : channels == 2 ? in[1] : 255;
    }
}

// The same for RGB, the most frequent case, with 128-bit vectors.
void rgb_to_rgba(const std::uint8_t* in, std::uint32_t count, std::uint8_t* out) {
    typedef std::uint8_t Byte16 __attribute__((vector_size(16)));
    constexpr Byte16 opaque = {255};
    if (count < 8 || count % 4 != 0)
        return bytes_to_rgba<3>(in, count, out);
    std::uint32_t i = 0;
    for (; i + 4 < count; i += 4, in += 12, out += 16) {
        Byte16 rgb;
        std::memcpy(&rgb, in, 16);
        const Byte16 rgba = __builtin_shufflevector(rgb, opaque, 0, 1, 2, 16, 3, 4, 5, 16, 6, 7, 8,
                                                    16, 9, 10, 11, 16);
        std::memcpy(out, &rgba, 16);
    }
    Byte16 rgb; // starts before the last four texels, so that no byte past the end is read
    std::memcpy(&rgb, in - 4, 16);
    const Byte16 rgba = __builtin_shufflevector(rgb, opaque, 4, 5, 6, 16, 7, 8, 9, 16, 10, 11, 12,
                                                16, 13, 14, 15, 16);
    std::memcpy(out, &rgba, 16);
}

// For each half float, its tone-mapped colour and its value as alpha, both 0..255.
struct HalfTables {
    std::vector<std::uint8_t> colour, alpha;
    HalfTables() : colour(65536), alpha(65536) {
        for (std::uint32_t half = 0; half < 65536; ++half) {
            const auto x = static_cast<double>(half_to_float(static_cast<std::uint16_t>(half)));
            colour[half] = std::to_integer<std::uint8_t>(tone_mapped(x));
            alpha[half] = static_cast<std::uint8_t>(x >= 1 ? 255 : x > 0 ? 255 * x + 0.5 : 0);
        }
    }
    static const HalfTables& get() {
        static const HalfTables tables;
        return tables;
    }
};

template <int channels>
void halves_to_rgba(const std::uint8_t* in, std::uint32_t count, std::uint8_t* out) {
    const HalfTables& tables = HalfTables::get();
    const auto half = [&](int channel) {
        return std::size_t{in[2 * channel]} + 256u * in[2 * channel + 1];
    };
    for (std::uint32_t i = 0; i < count; ++i, in += 2 * channels, out += 4) {
        out[0] = tables.colour[half(0)];
        out[1] = tables.colour[half(channels > 2 ? 1 : 0)];
        out[2] = tables.colour[half(channels > 2 ? 2 : 0)];
        out[3] = channels % 2 == 0 ? tables.alpha[half(channels - 1)] : 255;
    }
}

// Writes the angular image of one surface position. `stride` is the number of bytes per row of
// `rgba`.
template <void (*write_row)(const std::uint8_t*, std::uint32_t, std::uint8_t*), int texel_bytes>
void write_place(const std::uint8_t* texels, std::uint32_t ns, std::uint32_t nt, std::uint8_t* rgba,
                 std::size_t stride) {
    for (std::uint32_t t = 0; t < nt; ++t)
        write_row(texels + std::size_t{t} * ns * texel_bytes, ns, rgba + t * stride);
}

} // namespace

AtlasSink::PlaceWriter AtlasSink::place_writer(const TextureDesc& desc) {
    constexpr PlaceWriter writers[2][4] = {
        {write_place<bytes_to_rgba<1>, 1>, write_place<bytes_to_rgba<2>, 2>,
         write_place<rgb_to_rgba, 3>, write_place<bytes_to_rgba<4>, 4>},
        {write_place<halves_to_rgba<1>, 2>, write_place<halves_to_rgba<2>, 4>,
         write_place<halves_to_rgba<3>, 6>, write_place<halves_to_rgba<4>, 8>}};
    return writers[traits_of(desc.type).is_float ? 1 : 0][desc.channels - 1];
}

AtlasSink::AtlasSink(const TextureDesc& desc, const Box4& box, std::span<std::byte> rgba)
    : texel_bytes_(desc.texel_bytes()), box_(box), rgba_(rgba), write_place_(place_writer(desc)) {}

Status AtlasSink::write(const Box4& part, std::span<const std::byte> texels) {
    const auto [all_u, all_v, all_s, all_t] = box_.extent();
    const auto [nu, nv, ns, nt] = part.extent();
    const auto* in = reinterpret_cast<const std::uint8_t*>(texels.data());
    auto* const out = reinterpret_cast<std::uint8_t*>(rgba_.data());
    const std::size_t width = std::size_t{all_u} * all_s;
    for (std::uint32_t v = 0; v < nv; ++v)
        for (std::uint32_t u = 0; u < nu; ++u, in += std::size_t{nt} * ns * texel_bytes_) {
            const std::size_t x = std::size_t{part.begin[axis_u] - box_.begin[axis_u] + u} * all_s +
                                  part.begin[axis_s];
            const std::size_t y = std::size_t{part.begin[axis_v] - box_.begin[axis_v] + v} * all_t +
                                  part.begin[axis_t];
            write_place_(in, ns, nt, out + (y * width + x) * 4, width * 4);
        }
    return {};
}

} // namespace tessera
