#include "tools/web/decoder/atlas.h"

#include "format/samples.h"
#include "tools/picture/tone_map.h"

#include <vector>

namespace tessera {
namespace {

// Grey, grey and alpha, RGB or RGBA of a byte a sample.
template <int channels>
void bytes_to_rgba(const std::uint8_t* in, std::uint32_t count, std::uint8_t* out) {
    for (std::uint32_t i = 0; i < count; ++i, in += channels, out += 4) {
        out[0] = in[0];
        out[1] = in[channels > 2 ? 1 : 0];
        out[2] = in[channels > 2 ? 2 : 0];
        out[3] = channels == 4 ? in[3] : channels == 2 ? in[1] : 255;
    }
}

// What every half is shown as, and as alpha.
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

} // namespace

AtlasSink::RowWriter AtlasSink::row_writer(const TextureDesc& desc) {
    constexpr RowWriter writers[2][4] = {
        {bytes_to_rgba<1>, bytes_to_rgba<2>, bytes_to_rgba<3>, bytes_to_rgba<4>},
        {halves_to_rgba<1>, halves_to_rgba<2>, halves_to_rgba<3>, halves_to_rgba<4>}};
    return writers[desc.type == SampleType::half16 ? 1 : 0][desc.channels - 1];
}

AtlasSink::AtlasSink(const TextureDesc& desc, const Box4& box, std::span<std::byte> rgba)
    : texel_bytes_(desc.texel_bytes()), box_(box), rgba_(rgba), write_row_(row_writer(desc)) {}

Status AtlasSink::write(const Box4& part, std::span<const std::byte> texels) {
    const auto [all_u, all_v, all_s, all_t] = box_.extent();
    const auto [nu, nv, ns, nt] = part.extent();
    const auto* in = reinterpret_cast<const std::uint8_t*>(texels.data());
    const std::size_t width = std::size_t{all_u} * all_s;
    for (std::uint32_t v = 0; v < nv; ++v)
        for (std::uint32_t u = 0; u < nu; ++u) {
            const std::size_t x = std::size_t{part.begin[axis_u] - box_.begin[axis_u] + u} * all_s +
                                  part.begin[axis_s];
            const std::size_t y = std::size_t{part.begin[axis_v] - box_.begin[axis_v] + v} * all_t +
                                  part.begin[axis_t];
            for (std::uint32_t t = 0; t < nt; ++t, in += ns * texel_bytes_)
                write_row_(in, ns,
                           reinterpret_cast<std::uint8_t*>(rgba_.data()) +
                               ((y + t) * width + x) * 4);
        }
    return {};
}

} // namespace tessera
