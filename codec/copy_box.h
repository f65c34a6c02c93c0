// Copies texels between dense boxes.
#pragma once

#include "format/texture.h"

#include <cstring>
#include <span>

namespace tessera {

// Copies a run; runs are mostly eight texels, too short for a call of memcpy to pay.
inline void copy_run(std::byte* to, const std::byte* from, std::size_t bytes) {
    if (bytes >= 16 && bytes <= 32) {
        std::memcpy(to, from, 16);
        std::memcpy(to + bytes - 16, from + bytes - 16, 16);
    } else {
        std::memcpy(to, from, bytes);
    }
}

// Copies the texels of `part`, which lies in both boxes, from the dense texels of one box to those
// of another.
inline void copy_box(const Box4& part, const Box4& from_box, std::span<const std::byte> from,
                     const Box4& to_box, std::span<std::byte> to, std::size_t texel_bytes) {
    const Extent4 f = from_box.extent(), d = to_box.extent();
    const std::size_t run = (part.end[axis_s] - part.begin[axis_s]) * texel_bytes;
    const auto offset = [&](const Box4& box, const Extent4& n, std::uint64_t v, std::uint64_t u,
                            std::uint64_t t) {
        return ((((v - box.begin[axis_v]) * n[axis_u] + (u - box.begin[axis_u])) * n[axis_t] +
                 (t - box.begin[axis_t])) *
                    n[axis_s] +
                (part.begin[axis_s] - box.begin[axis_s])) *
               texel_bytes;
    };
    for (std::uint64_t v = part.begin[axis_v]; v < part.end[axis_v]; ++v)
        for (std::uint64_t u = part.begin[axis_u]; u < part.end[axis_u]; ++u)
            for (std::uint64_t t = part.begin[axis_t]; t < part.end[axis_t]; ++t)
                copy_run(to.data() + offset(to_box, d, v, u, t),
                         from.data() + offset(from_box, f, v, u, t), run);
}

} // namespace tessera
