// The texels of one slab in memory. It connects picture files, which are read and written in long
// rows, with the codec, which reads and writes small 4D boxes.
#pragma once

#include "format/status.h"
#include "format/texture.h"
#include "tools/support/system.h"

#include <cstddef>
#include <memory>
#include <span>

namespace tessera {

// Dense texels of one box. copy_in and copy_out are thread-safe for disjoint boxes.
class SlabBuffer {
public:
    // Errors: bad_argument if `box` is not inside the texture, runtime if memory is short.
    Status reset(const TextureDesc& desc, const Box4& box);
    void clear();

    // Errors: runtime, if `box` is not inside the slab or the sizes do not match, because the
    // caller broke the protocol of TexelSource or TexelSink.
    Status copy_in(const Box4& box, std::span<const std::byte> texels);
    Status copy_out(const Box4& box, std::span<std::byte> out) const;

    const Box4& box() const { return box_; }
    std::span<std::byte> bytes() { return {memory_.get(), size_}; }
    // First byte of a texel. Precondition: the texel is inside the slab.
    std::byte* texel(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t);

private:
    Status check(const Box4& box, std::size_t bytes) const;
    TextureDesc desc_;
    Box4 box_;
    // Not a vector, which would first write zeros to all of it, on one thread.
    struct Free {
        void operator()(std::byte* memory) const { free_slab(memory); }
    };
    std::unique_ptr<std::byte, Free> memory_;
    std::size_t size_ = 0, room_ = 0;
};

// Whether a slab spans the whole texture along two axes, which is the shape that a Locality
// requires.
inline bool spans(const Box4& box, const Extent4& size, Axis a, Axis b) {
    return box.begin[a] == 0 && box.end[a] == size[a] && box.begin[b] == 0 && box.end[b] == size[b];
}

} // namespace tessera
