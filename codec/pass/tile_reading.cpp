#include "codec/pass/tile_reading.h"

#include "codec/texels/texel_mask.h"

#include <string>

namespace tessera {
namespace {

bool is_not_finite(const std::byte* half) {
    return (std::to_integer<unsigned>(half[1]) & 0x7C) == 0x7C;
}

bool is_infinite(const std::byte* half) {
    return (std::to_integer<unsigned>(half[1]) & 0x7F) == 0x7C && half[0] == std::byte{0};
}

// "texel u 3, v 0, s 1, t 2, channel 0 is NaN" for the first non-finite sample in box order, with its
// coordinates in the texture; "" if there is none.
std::string first_not_finite(std::span<const std::byte> texels, const Box4& box,
                             const TextureDesc& desc, const AlignedViews& views) {
    if (!traits_of(desc.type).is_float)
        return "";
    std::size_t at = 0;
    while (at + 1 < texels.size() && !is_not_finite(&texels[at]))
        at += 2;
    if (at + 1 >= texels.size())
        return "";
    const Extent4 extent = box.extent();
    std::size_t left = at / 2 / desc.channels;
    Extent4 place{};
    for (const Axis axis : {axis_s, axis_t, axis_u, axis_v}) {
        place[axis] = box.begin[axis] + static_cast<std::uint32_t>(left % extent[axis]);
        left /= extent[axis];
    }
    place[axis_u] -= views.shift_u(place[axis_s]);
    place[axis_v] -= views.shift_v(place[axis_t]);
    return "texel u " + std::to_string(place[axis_u]) + ", v " + std::to_string(place[axis_v]) +
           ", s " + std::to_string(place[axis_s]) + ", t " + std::to_string(place[axis_t]) +
           ", channel " + std::to_string(at / 2 % desc.channels) +
           (is_infinite(&texels[at]) ? " is infinite" : " is NaN");
}

// Masked texels become finite without being counted.
Status read_texels(TexelSource& source, TexelSource* mask, const Box4& box, TileTexels& tile) {
    const TextureDesc& desc = source.desc();
    tile.texels.resize(desc.box_bytes(box));
    TESSERA_TRY(source.read(box, tile.texels));
    TESSERA_TRY(read_mask(mask, box, tile.matters));
    CodedTile ignored;
    const std::span<std::byte> texels = tile.texels;
    for (std::size_t i = 0; i < tile.matters.size(); ++i)
        if (tile.is_free(i))
            make_finite(texels.subspan(i * desc.texel_bytes(), desc.texel_bytes()), desc.type,
                        ignored);
    return {};
}

} // namespace

void make_finite(std::span<std::byte> texels, SampleType type, CodedTile& counts) {
    if (!traits_of(type).is_float)
        return;
    for (std::size_t i = 0; i + 1 < texels.size(); i += 2) {
        if (!is_not_finite(&texels[i]))
            continue;
        const bool infinite = is_infinite(&texels[i]);
        const std::byte sign = texels[i + 1] & std::byte{0x80};
        ++(infinite ? counts.infinity_count : counts.nan_count);
        texels[i] = infinite ? std::byte{0xFF} : std::byte{0};
        texels[i + 1] = infinite ? sign | std::byte{0x7B} : std::byte{0};
    }
}

Result<TileTexels> read_finite(TexelSource& source, TexelSource* mask, const Box4& box) {
    TileTexels tile;
    TESSERA_TRY(read_texels(source, mask, box, tile));
    CodedTile ignored;
    make_finite(tile.texels, source.desc().type, ignored);
    return tile;
}

Status read_tile(const EncodePlan& plan, const Box4& box, TileTexels& texels, CodedTile& tile) {
    TESSERA_TRY(check_cancelled(plan));
    const TextureDesc& desc = plan.colour.desc;
    TESSERA_TRY(read_texels(plan.source, plan.mask, box, texels));
    const std::string first =
        plan.options.strict ? first_not_finite(texels.texels, box, desc, plan.views) : "";
    make_finite(texels.texels, desc.type, tile);
    if (first.empty())
        return {};
    return about_texels(plan, {ErrorCode::invalid_file,
                               first + "; the texels " + to_string(box) + " hold " +
                                   std::to_string(tile.nan_count) + " NaN and " +
                                   std::to_string(tile.infinity_count) +
                                   " infinite samples (without --strict they are replaced)"});
}

Result<std::vector<Slab>> slabs_of(const EncodePlan& plan) {
    const TextureDesc& desc = plan.colour.desc;
    auto slabs = make_slabs(plan.grid, Box4::whole(desc.size), plan.source.locality(),
                            {plan.options.slab_bytes / desc.texel_bytes(), true});
    return slabs.ok() ? std::move(slabs) : about_texels(plan, slabs.status());
}

} // namespace tessera
