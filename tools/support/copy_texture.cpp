#include "tools/support/copy_texture.h"

#include "format/work.h"

namespace tessera {
namespace {

constexpr std::uint64_t usual_slab_bytes = 64ull << 20;
constexpr std::uint64_t box_texels = 1 << 14; // most that one task copies

// Halves the longest of `axes` until the box has at most `max_count` texels. No axis goes below 1.
Extent4 shrink(Extent4 e, std::initializer_list<Axis> axes, std::uint64_t max_count) {
    while (texel_count(e) > max_count) {
        Axis longest = *axes.begin();
        for (Axis axis : axes)
            if (e[axis] > e[longest])
                longest = axis;
        if (e[longest] == 1)
            break;
        e[longest] = (e[longest] + 1) / 2;
    }
    return e;
}

Extent4 slab_extent(const TextureDesc& desc, Locality locality, std::uint64_t bytes) {
    const std::uint64_t texels = std::max<std::uint64_t>(1, bytes / desc.texel_bytes());
    switch (locality) {
    case Locality::spatial_rows:
        return shrink(desc.size, {axis_v}, texels);
    case Locality::places:
        return shrink(shrink(desc.size, {axis_v}, texels), {axis_u}, texels);
    case Locality::angular_cells:
        return shrink(desc.size, {axis_s, axis_t}, texels);
    case Locality::any:
        break;
    }
    return shrink(desc.size, {axis_v, axis_u, axis_t, axis_s}, texels);
}

// Box number `index` when `whole` is cut into boxes of `step`; v varies slowest. False past the
// last one.
bool box_at(const Box4& whole, const Extent4& step, std::uint64_t index, Box4& out) {
    for (Axis axis : {axis_s, axis_t, axis_u, axis_v}) {
        const std::uint32_t extent = whole.end[axis] - whole.begin[axis];
        const std::uint32_t count = (extent + step[axis] - 1) / step[axis];
        out.begin[axis] =
            whole.begin[axis] + static_cast<std::uint32_t>(index % count) * step[axis];
        out.end[axis] = std::min(whole.end[axis], out.begin[axis] + step[axis]);
        index /= count;
    }
    return index == 0;
}

std::uint64_t box_count(const Box4& whole, const Extent4& step) {
    std::uint64_t count = 1;
    for (std::size_t axis = 0; axis < 4; ++axis)
        count *= (whole.extent()[axis] + step[axis] - 1) / step[axis];
    return count;
}

Status move_box(TexelSource& source, TexelSink& sink, const Box4& box) {
    std::vector<std::byte> texels(source.desc().box_bytes(box));
    TESSERA_TRY(source.read(box, texels));
    return sink.write(box, texels);
}

} // namespace

Status copy_texture(TexelSource& source, TexelSink& sink, unsigned threads,
                    const ProgressFunction& progress, const char* stage, std::uint64_t slab_bytes) {
    const TextureDesc desc = source.desc();
    const Extent4 slab_step =
        slab_extent(desc, sink.locality(), std::min(slab_bytes, usual_slab_bytes));
    if (const std::uint64_t needed = desc.box_bytes(Box4::whole(slab_step)); needed > slab_bytes)
        return {ErrorCode::over_budget, std::to_string(needed) +
                                            " bytes of texels must be held in memory, but only " +
                                            std::to_string(slab_bytes) + " are allowed"};
    const double total = static_cast<double>(texel_count(desc.size));
    std::mutex mutex;
    double done = 0;
    Box4 slab;
    for (std::uint64_t i = 0; box_at(Box4::whole(desc.size), slab_step, i, slab); ++i) {
        TESSERA_TRY(source.begin_slab(slab));
        TESSERA_TRY(sink.begin_slab(slab));
        const Extent4 step = shrink(slab.extent(), {axis_v, axis_u, axis_t, axis_s}, box_texels);
        TESSERA_TRY(parallel_for(box_count(slab, step), threads, [&](std::uint64_t index) {
            Box4 box;
            box_at(slab, step, index, box);
            const Status status = move_box(source, sink, box);
            const std::lock_guard lock(mutex);
            done += static_cast<double>(box.texels());
            if (progress && status.ok())
                progress(stage, done, total);
            return status;
        }));
        TESSERA_TRY(sink.end_slab());
    }
    return sink.finish();
}

} // namespace tessera
