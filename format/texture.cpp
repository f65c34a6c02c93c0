#include "format/texture.h"

#include <algorithm>

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
    if (desc.type != SampleType::unorm8 && desc.type != SampleType::half16)
        return {ErrorCode::bad_argument, "unknown sample type"};
    return {};
}

} // namespace tessera
