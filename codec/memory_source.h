// Texels in memory as a source.
#pragma once

#include "codec/copy_box.h"
#include "format/texture.h"

#include <span>

namespace tessera {

// The caller keeps the texels (dense, all of the texture) alive. Thread-safe.
class MemorySource : public TexelSource {
public:
    MemorySource(const TextureDesc& desc, std::span<const std::byte> texels)
        : desc_(desc), texels_(texels) {}
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        const Box4 whole = Box4::whole(desc_.size);
        if (!is_inside(box, desc_.size) || out.size() != desc_.box_bytes(box) ||
            texels_.size() != desc_.box_bytes(whole))
            return {ErrorCode::bad_argument, "box or buffer does not fit the texture"};
        copy_box(box, whole, texels_, box, out, desc_.texel_bytes());
        return {};
    }

private:
    TextureDesc desc_;
    std::span<const std::byte> texels_;
};

} // namespace tessera
