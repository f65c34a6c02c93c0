#include "tools/support/slab_buffer.h"

#include "format/texture.h"

#include <exception>

namespace tessera {
namespace {

std::uint64_t texel_index(const Box4& box, std::uint32_t u, std::uint32_t v, std::uint32_t s,
                          std::uint32_t t) {
    const Extent4 e = box.extent();
    const std::uint64_t place =
        std::uint64_t{v - box.begin[axis_v]} * e[axis_u] + (u - box.begin[axis_u]);
    return (place * e[axis_t] + (t - box.begin[axis_t])) * e[axis_s] + (s - box.begin[axis_s]);
}

} // namespace

Status SlabBuffer::reset(const TextureDesc& desc, const Box4& box) {
    if (!is_inside(box, desc.size))
        return {ErrorCode::bad_argument,
                "slab " + to_string(box) + " leaves the texture of " + to_string(desc.size)};
    desc_ = desc;
    box_ = box;
    try {
        bytes_.resize(desc.box_bytes(box));
    } catch (const std::exception&) { // bad_alloc or length_error
        clear();
        return {ErrorCode::runtime,
                "no memory for a slab of " + std::to_string(desc.box_bytes(box)) + " bytes"};
    }
    return {};
}

void SlabBuffer::clear() {
    box_ = {};
    bytes_ = {};
}

Status SlabBuffer::check(const Box4& box, std::size_t bytes) const {
    if (intersect(box, box_) != box || box.texels() == 0 || bytes != desc_.box_bytes(box))
        return {ErrorCode::runtime, "box " + to_string(box) + " with " + std::to_string(bytes) +
                                        " bytes does not fit the slab " + to_string(box_)};
    return {};
}

Status SlabBuffer::copy_in(const Box4& box, std::span<const std::byte> texels) {
    TESSERA_TRY(check(box, texels.size()));
    copy_box(box, box, texels, box_, bytes_, desc_.texel_bytes());
    return {};
}

Status SlabBuffer::copy_out(const Box4& box, std::span<std::byte> out) const {
    TESSERA_TRY(check(box, out.size()));
    copy_box(box, box_, bytes_, box, out, desc_.texel_bytes());
    return {};
}

std::byte* SlabBuffer::texel(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) {
    return bytes_.data() + texel_index(box_, u, v, s, t) * desc_.texel_bytes();
}

} // namespace tessera
