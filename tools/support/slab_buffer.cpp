#include "tools/support/slab_buffer.h"

#include "format/texture.h"

namespace tessera {

Status SlabBuffer::reset(const TextureDesc& desc, const Box4& box) {
    if (!is_inside(box, desc.size))
        return {ErrorCode::bad_argument,
                "slab " + to_string(box) + " is not inside the texture of " + to_string(desc.size)};
    desc_ = desc;
    box_ = box;
    size_ = desc.box_bytes(box);
    if (size_ <= room_)
        return {};
    memory_.reset(); // frees it before the next allocation
    memory_.reset(allocate_slab(size_));
    room_ = size_;
    if (memory_ == nullptr) {
        const std::size_t wished = size_;
        clear();
        return {ErrorCode::runtime, "no memory for a slab of " + std::to_string(wished) + " bytes"};
    }
    return {};
}

void SlabBuffer::clear() {
    box_ = {};
    memory_.reset();
    size_ = room_ = 0;
}

Status SlabBuffer::check(const Box4& box, std::size_t bytes) const {
    if (intersect(box, box_) != box || box.texels() == 0 || bytes != desc_.box_bytes(box))
        return {ErrorCode::runtime, "box " + to_string(box) + " with " + std::to_string(bytes) +
                                        " bytes does not fit the slab " + to_string(box_)};
    return {};
}

Status SlabBuffer::copy_in(const Box4& box, std::span<const std::byte> texels) {
    TESSERA_TRY(check(box, texels.size()));
    copy_box(box, box, texels, box_, bytes(), desc_.texel_bytes());
    return {};
}

Status SlabBuffer::copy_out(const Box4& box, std::span<std::byte> out) const {
    TESSERA_TRY(check(box, out.size()));
    copy_box(box, box_, {memory_.get(), size_}, box, out, desc_.texel_bytes());
    return {};
}

std::byte* SlabBuffer::texel(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) {
    return memory_.get() + box_.index_of({u, v, s, t}) * desc_.texel_bytes();
}

} // namespace tessera
