#include "codec/texels/texel_mask.h"

#include "codec/tile/tile_texels.h"
#include "format/levels.h"
#include "format/work.h"

#include <array>
#include <atomic>
#include <string>
#include <vector>

namespace tessera {
namespace {

constexpr Extent4 walk_extent{64, 64, 16, 16}; // of the boxes that are counted

// Repeats a dense box along its sides of 1, so that it gets the size `extent`.
std::vector<std::byte> broadcast(const std::vector<std::byte>& from, const Extent4& from_extent,
                                 const Extent4& extent) {
    std::array<std::size_t, 4> stride{}; // of `from`; 0 along sides of 1
    std::size_t texels = 1;
    for (const Axis axis : {axis_s, axis_t, axis_u, axis_v}) {
        stride[axis] = from_extent[axis] == 1 ? 0 : texels;
        texels *= from_extent[axis];
    }
    std::vector<std::byte> to;
    to.reserve(texel_count(extent));
    for (std::size_t v = 0; v < extent[axis_v]; ++v)
        for (std::size_t u = 0; u < extent[axis_u]; ++u)
            for (std::size_t t = 0; t < extent[axis_t]; ++t)
                for (std::size_t s = 0; s < extent[axis_s]; ++s)
                    to.push_back(from[v * stride[axis_v] + u * stride[axis_u] + t * stride[axis_t] +
                                      s * stride[axis_s]]);
    return to;
}

} // namespace

Status check_mask(const TexelSource* mask, const Extent4& texture_size) {
    const auto bad = [](const std::string& what) {
        return Status(ErrorCode::bad_argument, what).with_context("the mask");
    };
    if (mask == nullptr)
        return {};
    const TextureDesc& desc = mask->desc();
    if (desc.channels != 1 || sample_bytes(desc.type) != 1)
        return bad("must have one channel of 8 bits");
    for (std::size_t axis = 0; axis < 4; ++axis)
        if (desc.size[axis] != texture_size[axis] && desc.size[axis] != 1)
            return bad("the size " + to_string(desc.size) + " does not fit a texture of " +
                       to_string(texture_size) + ": each side must be equal, or 1");
    if (mask->locality() != Locality::any)
        return bad("must be readable box by box in any order");
    return {};
}

Status read_mask(TexelSource* mask, const Box4& box, std::vector<std::byte>& matters) {
    matters.clear();
    if (mask == nullptr)
        return {};
    Box4 part = box;
    for (std::size_t axis = 0; axis < 4; ++axis)
        if (mask->desc().size[axis] == 1) {
            part.begin[axis] = 0;
            part.end[axis] = 1;
        }
    matters.resize(part.texels());
    TESSERA_TRY(mask->read(part, matters));
    forget_needless_mask(matters);
    if (!matters.empty() && part.extent() != box.extent())
        matters = broadcast(matters, part.extent(), box.extent());
    return {};
}

Result<std::uint64_t> count_texels_that_matter(TexelSource* mask, const Extent4& texture_size,
                                               unsigned threads) {
    if (mask == nullptr)
        return texel_count(texture_size);
    const Extent4& size = mask->desc().size;
    const TileGrid grid(size, walk_extent);
    std::vector<std::vector<std::byte>> workers(thread_count(threads));
    std::atomic<std::uint64_t> free_texels{0};
    TESSERA_TRY(mask->begin_slab(Box4::whole(size)));
    TESSERA_TRY(parallel_for(
        workers, grid.tiles(),
        [&](std::vector<std::byte>& matters, std::size_t i) -> Status {
            TESSERA_TRY(read_mask(mask, grid.box(i), matters));
            free_texels += free_count(matters);
            return {};
        },
        [](std::size_t) {}));
    return (texel_count(size) - free_texels) * (texel_count(texture_size) / texel_count(size));
}

} // namespace tessera
