#include "codec/texels/aligned_texels.h"

#include "codec/texels/slabs.h"
#include "codec/texels/texel_mask.h"
#include "format/work.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace tessera {
namespace {

constexpr Extent4 read_extent{64, 64, 32, 32}; // size of the boxes that are read

// The coordinate in a view, shifted by `shift`, that is nearest to a grid coordinate.
std::uint32_t nearest(std::uint32_t place, std::uint32_t shift, std::uint32_t size) {
    return std::min(place - std::min(place, shift), size - 1);
}

// The smallest box of the texture that has the nearest texel of every position of a grid box.
Box4 texels_around(const AlignedViews& views, const Box4& grid_box) {
    Box4 box = grid_box;
    const auto move = [&](Axis axis, std::uint32_t a, std::uint32_t b) {
        const std::uint32_t size = views.texture_size()[axis];
        box.begin[axis] = nearest(box.begin[axis], std::max(a, b), size);
        box.end[axis] = nearest(box.end[axis] - 1, std::min(a, b), size) + 1;
    };
    move(axis_u, views.shift_u(box.begin[axis_s]), views.shift_u(box.end[axis_s] - 1));
    move(axis_v, views.shift_v(box.begin[axis_t]), views.shift_v(box.end[axis_t] - 1));
    return box;
}

// The mask of the grid: 0 where there is no view, else the value of the texture's mask.
class ViewMask final : public TexelSource {
public:
    ViewMask(const AlignedViews& views, TexelSource* matters)
        : views_(views), matters_(matters), desc_{views.grid_size(), SampleType::unorm8, 1} {}
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        const Box4 around = texels_around(views_, box);
        std::vector<std::byte> matters;
        TESSERA_TRY(read_mask(matters_, around, matters));
        if (matters.empty())
            matters.assign(static_cast<std::size_t>(around.texels()), std::byte{255});
        std::ranges::fill(out, std::byte{0});
        views_.copy_to_grid(around, matters, box, out, 1);
        return {};
    }

private:
    AlignedViews views_;
    TexelSource* matters_;
    TextureDesc desc_;
};

// A source of Locality::any as a texture in the grid.
class GridSource final : public TexelSource {
public:
    GridSource(TexelSource& source, const AlignedViews& views)
        : source_(source), views_(views), desc_(source.desc()) {
        desc_.size = views.grid_size();
    }
    const TextureDesc& desc() const override { return desc_; }
    bool cheap_to_reread() const override { return source_.cheap_to_reread(); }
    Status begin_slab(const Box4&) override {
        return source_.begin_slab(Box4::whole(views_.texture_size()));
    }
    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        const Box4 around = texels_around(views_, box);
        const std::size_t bytes = desc_.texel_bytes();
        std::vector<std::byte> texels(static_cast<std::size_t>(desc_.box_bytes(around)));
        TESSERA_TRY(source_.read(around, texels));
        const Extent4 size = views_.texture_size();
        std::byte* to = out.data();
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t) {
                    const std::uint32_t row = nearest(v, views_.shift_v(t), size[axis_v]);
                    for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s) {
                        const std::uint32_t column = nearest(u, views_.shift_u(s), size[axis_u]);
                        const std::uint64_t from = around.index_of({column, row, s, t});
                        std::memcpy(to, texels.data() + from * bytes, bytes);
                        to += bytes;
                    }
                }
        return {};
    }

private:
    TexelSource& source_;
    AlignedViews views_;
    TextureDesc desc_;
};

// Reads a whole source, slab by slab.
Result<std::vector<std::byte>> read_all(TexelSource& source, unsigned threads,
                                        std::uint64_t slab_bytes) {
    const TextureDesc& desc = source.desc();
    const Box4 whole = Box4::whole(desc.size);
    const TileGrid boxes(desc.size, read_extent);
    TESSERA_TRY_ASSIGN(const auto slabs, make_slabs(boxes, whole, source.locality(),
                                                    {slab_bytes / desc.texel_bytes(), true}));
    std::vector<std::byte> all(static_cast<std::size_t>(desc.box_bytes(whole)));
    std::vector<std::vector<std::byte>> workers(thread_count(threads));
    for (const Slab& slab : slabs) {
        TESSERA_TRY(source.begin_slab(slab.box));
        TESSERA_TRY(parallel_for(
            workers, slab.tiles.size(),
            [&](std::vector<std::byte>& texels, std::size_t i) -> Status {
                const Box4 box = boxes.box(slab.tiles[i]);
                texels.resize(static_cast<std::size_t>(desc.box_bytes(box)));
                TESSERA_TRY(source.read(box, texels));
                copy_box(box, box, texels, whole, all, desc.texel_bytes());
                return {};
            },
            [](std::size_t) {}));
    }
    return all;
}

class HeldTexels final : public TexelSource {
public:
    HeldTexels(const TextureDesc& desc, std::vector<std::byte> texels)
        : texels_(std::move(texels)), source_(desc, texels_) {}
    const TextureDesc& desc() const override { return source_.desc(); }
    Status read(const Box4& box, std::span<std::byte> out) override {
        return source_.read(box, out);
    }

private:
    std::vector<std::byte> texels_;
    MemorySource source_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> hold_slabs(TexelSource& source, unsigned threads,
                                                std::uint64_t slab_bytes) {
    if (source.locality() == Locality::any)
        return std::unique_ptr<TexelSource>();
    const TextureDesc& desc = source.desc();
    const std::uint64_t allowed = slab_bytes / desc.texel_bytes(), needed = texel_count(desc.size);
    if (needed > allowed)
        return Status(ErrorCode::over_budget,
                      "aligned views must all be in memory: " + std::to_string(needed) +
                          " texels, but only " + std::to_string(allowed) + " are allowed");
    TESSERA_TRY_ASSIGN(std::vector<std::byte> texels, read_all(source, threads, slab_bytes));
    return std::unique_ptr<TexelSource>(std::make_unique<HeldTexels>(desc, std::move(texels)));
}

std::unique_ptr<TexelSource> texels_in_grid(TexelSource& source, const AlignedViews& views) {
    return std::make_unique<GridSource>(source, views);
}

std::unique_ptr<TexelSource> mask_of_grid(TexelSource* mask, const AlignedViews& views) {
    return std::make_unique<ViewMask>(views, mask);
}

} // namespace tessera
