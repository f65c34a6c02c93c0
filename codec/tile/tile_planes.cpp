#include "codec/tile/tile_planes.h"

#include "codec/kernels/kernels.h"
#include "format/tile/dequantizer.h"

#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

// Calls visit(index in planes, texel address) for each texel of a box. u is the innermost loop, so
// that planes are walked along their rows.
template <class Byte, class Visit>
void for_each_texel(const BlockShape& shape, Byte* texels, std::size_t texel_bytes, Visit visit) {
    const auto [nu, nv, ns, nt] = shape.n;
    const std::size_t images = std::size_t{ns} * nt, page = std::size_t{nu} * nv;
    for (std::size_t v = 0; v < nv; ++v)
        for (std::size_t image = 0; image < images; ++image)
            for (std::size_t u = 0; u < nu; ++u)
                visit(image * page + v * nu + u,
                      texels + ((v * nu + u) * images + image) * texel_bytes);
}

template <SampleType type, int channels, bool ycocg>
void to_planes(std::span<const std::byte> texels, const TexelCodes& background,
               const BlockShape& shape, TilePlanes& planes) {
    for_each_texel(shape, texels.data(), channels * sample_bytes(type),
                   [&](std::size_t i, const std::byte* at) {
                       TexelCodes c{};
                       for (int k = 0; k < channels; ++k)
                           c[k] = sample_code(load_sample(at + k * sample_bytes(type), type), type);
                       if constexpr (ycocg)
                           forward_ycocg(c);
                       for (int k = 0; k < channels; ++k)
                           planes.plane[k][i] = (c[k] - background[k]) * (1 << value_bits(type));
                   });
}

template <SampleType type, int channels, bool ycocg>
void to_texels(const TilePlanes& planes, const TexelCodes& background,
               std::span<std::byte> texels) {
    constexpr int bits = value_bits(type);
    for_each_texel(planes.shape, texels.data(), channels * sample_bytes(type),
                   [&](std::size_t i, std::byte* at) {
                       TexelCodes c{};
                       for (int k = 0; k < channels; ++k)
                           c[k] = ((planes.plane[k][i] + (1 << bits >> 1)) >> bits) + background[k];
                       if constexpr (ycocg)
                           inverse_ycocg(c);
                       for (int k = 0; k < channels; ++k)
                           store_sample(at + k * sample_bytes(type), code_sample(c[k], type), type);
                   });
}

// Calls body<type, channels, ycocg>() for the samples of `colour`.
template <class Body> void dispatch(const ColourCoding& colour, const Body& body) {
    with_type(colour.desc.type, [&]<SampleType type>() {
        const bool ycocg = colour.transform == ColourTransform::ycocg_r;
        switch (colour.desc.channels) {
        case 1:
            return body.template operator()<type, 1, false>();
        case 2:
            return body.template operator()<type, 2, false>();
        case 3:
            return ycocg ? body.template operator()<type, 3, true>()
                         : body.template operator()<type, 3, false>();
        default:
            return ycocg ? body.template operator()<type, 4, true>()
                         : body.template operator()<type, 4, false>();
        }
    });
}

} // namespace

TexelCodes background_planes(const ColourCoding& colour) {
    return texel_planes(colour.background, colour.desc, colour.transform);
}

bool is_ycocg8(const ColourCoding& colour) {
    return sample_bytes(colour.desc.type) == 1 && colour.desc.channels == 3 &&
           colour.transform == ColourTransform::ycocg_r;
}

void TilePlanes::resize(const BlockShape& new_shape, int planes) {
    shape = new_shape;
    done.reset();
    for (int i = 0; i < planes; ++i)
        plane[static_cast<std::size_t>(i)].resize(static_cast<std::size_t>(shape.texels()));
}

void TilePlanes::resize_base(const BlockShape& new_shape, int planes) {
    base_shape = new_shape;
    base_done.reset();
    for (int i = 0; i < planes; ++i)
        base[static_cast<std::size_t>(i)].resize(static_cast<std::size_t>(base_shape.texels()));
}

void planes_from_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                        const BlockShape& shape, TilePlanes& planes) {
    planes.resize(shape, colour.desc.channels);
    const TexelCodes background = background_planes(colour);
    if (is_ycocg8(colour)) {
        const auto& [nu, nv, ns, nt] = shape.n;
        std::int32_t* const to[3] = {planes.plane[0].data(), planes.plane[1].data(),
                                     planes.plane[2].data()};
        kernels().load_ycocg8(reinterpret_cast<const unsigned char*>(texels.data()), nu * nv,
                              ns * nt, background.data(), to);
        return;
    }
    dispatch(colour, [&]<SampleType type, int channels, bool ycocg>() {
        to_planes<type, channels, ycocg>(texels, background, shape, planes);
    });
}

void texels_from_planes(const TilePlanes& planes, const ColourCoding& colour,
                        std::span<std::byte> texels) {
    const TexelCodes background = background_planes(colour);
    if (is_ycocg8(colour)) {
        const auto& [nu, nv, ns, nt] = planes.shape.n;
        kernels().store_ycocg8(
            {.plane = {planes.plane[0].data(), planes.plane[1].data(), planes.plane[2].data()},
             .background = {background[0], background[1], background[2]}},
            nu * nv, ns * nt, reinterpret_cast<unsigned char*>(texels.data()));
        return;
    }
    dispatch(colour, [&]<SampleType type, int channels, bool ycocg>() {
        to_texels<type, channels, ycocg>(planes, background, texels);
    });
}

} // namespace tessera
