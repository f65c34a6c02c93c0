#include "format/texture.h"

#include <algorithm>
#include <cstring>

namespace tessera {

std::string to_string(const Extent4& e) {
    return std::to_string(e[0]) + "x" + std::to_string(e[1]) + "x" + std::to_string(e[2]) + "x" +
           std::to_string(e[3]);
}

std::string to_string(const Box4& box) {
    std::string text;
    for (int axis = 0; axis < 4; ++axis) {
        if (axis > 0)
            text += ',';
        text += std::to_string(box.begin[axis]) + ":" + std::to_string(box.end[axis]);
    }
    return text;
}

Box4 intersect(const Box4& a, const Box4& b) {
    Box4 result;
    for (int axis = 0; axis < 4; ++axis) {
        result.begin[axis] = std::max(a.begin[axis], b.begin[axis]);
        result.end[axis] = std::max(result.begin[axis], std::min(a.end[axis], b.end[axis]));
    }
    return result;
}

bool is_inside(const Box4& box, const Extent4& extent) {
    for (int axis = 0; axis < 4; ++axis)
        if (box.begin[axis] >= box.end[axis] || box.end[axis] > extent[axis])
            return false;
    return true;
}

Status check_box(const TextureDesc& desc, const Box4& box, std::size_t bytes) {
    if (!is_inside(box, desc.size) || bytes != desc.box_bytes(box))
        return {ErrorCode::bad_argument, "box " + to_string(box) + " does not fit a texture of " +
                                             to_string(desc.size) + " or its buffer"};
    return {};
}

Status check_desc(const TextureDesc& desc) {
    std::uint64_t texels = 1;
    for (int axis = 0; axis < 4; ++axis) {
        const std::uint32_t n = desc.size[axis];
        if (n == 0 || n > max_extent)
            return {ErrorCode::bad_argument, std::string("extent ") + axis_name(axis) + " is " +
                                                 std::to_string(n) + ", outside 1.." +
                                                 std::to_string(max_extent)};
        if (texels > max_texels / n)
            return {ErrorCode::bad_argument,
                    "a texture of " + to_string(desc.size) + " has more than 2^48 texels"};
        texels *= n;
    }
    if (desc.channels < 1 || desc.channels > 4)
        return {ErrorCode::bad_argument,
                std::to_string(desc.channels) + " channels, only 1 to 4 are defined"};
    if (!is_known(desc.type))
        return {ErrorCode::bad_argument, "unknown sample type"};
    return {};
}

namespace {

// Most runs have four or eight texels, which is too short for a call of memcpy() to pay off.
void copy_run(std::byte* to, const std::byte* from, std::size_t bytes) {
    if (bytes >= 16 && bytes <= 32) {
        std::memcpy(to, from, 16);
        std::memcpy(to + bytes - 16, from + bytes - 16, 16);
    } else if (bytes >= 8 && bytes < 16) {
        std::memcpy(to, from, 8);
        std::memcpy(to + bytes - 8, from + bytes - 8, 8);
    } else {
        std::memcpy(to, from, bytes);
    }
}

} // namespace

void copy_box(const Box4& part, const Box4& from_box, std::span<const std::byte> from,
              const Box4& to_box, std::span<std::byte> to, std::size_t texel_bytes) {
    const Extent4 f = from_box.extent(), d = to_box.extent(), n = part.extent();
    // An axis along which all of both boxes is copied forms one run with the next axis.
    const auto is_whole = [&](std::size_t axis) {
        return n[axis] == f[axis] && n[axis] == d[axis];
    };
    const bool whole_views = is_whole(axis_s), whole_texels = whole_views && is_whole(axis_t);
    const std::uint64_t t_step = whole_views ? n[axis_t] : 1, u_step = whole_texels ? n[axis_u] : 1;
    const std::size_t run = n[axis_s] * t_step * u_step * texel_bytes;
    const auto offset = [&](const Box4& box, const Extent4& size, std::uint64_t v, std::uint64_t u,
                            std::uint64_t t) {
        return ((((v - box.begin[axis_v]) * size[axis_u] + (u - box.begin[axis_u])) * size[axis_t] +
                 (t - box.begin[axis_t])) *
                    size[axis_s] +
                (part.begin[axis_s] - box.begin[axis_s])) *
               texel_bytes;
    };
    for (std::uint64_t v = part.begin[axis_v]; v < part.end[axis_v]; ++v)
        for (std::uint64_t u = part.begin[axis_u]; u < part.end[axis_u]; u += u_step)
            for (std::uint64_t t = part.begin[axis_t]; t < part.end[axis_t]; t += t_step)
                copy_run(to.data() + offset(to_box, d, v, u, t),
                         from.data() + offset(from_box, f, v, u, t), run);
}

Status MemorySource::read(const Box4& box, std::span<std::byte> out) {
    const Box4 whole = Box4::whole(desc_.size);
    TESSERA_TRY(check_box(desc_, box, out.size()));
    TESSERA_TRY(check_box(desc_, whole, texels_.size()));
    copy_box(box, whole, texels_, box, out, desc_.texel_bytes());
    return {};
}

} // namespace tessera
