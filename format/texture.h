// What a 4D texture is, and how its texels are read and written: box by box, never all at once.
//
// In T(u,v,s,t), (u,v) is a position on the surface, and (s,t) is the direction in which light
// leaves it. Sizes are written UxVxSxT. The texels of a box are stored densely in the order v, u,
// t, s with s fastest, and the channels of a texel are adjacent. The sample of a channel has the
// index
//   ((((v - v0) * U' + (u - u0)) * T' + (t - t0)) * S' + (s - s0)) * channels + channel
// in a box that begins at (u0, v0, s0, t0) and has the extent U'xV'xS'xT'. samples.h describes
// samples.
#pragma once

#include "format/samples.h"
#include "format/status.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace TESSERA_PUBLIC tessera {

// The axes in the order in which sizes are written.
enum Axis { axis_u = 0, axis_v = 1, axis_s = 2, axis_t = 3 };
constexpr char axis_name(int axis) {
    return "uvst"[axis];
}

// A number along each of u, v, s, t: texels unless a comment says otherwise.
using Extent4 = std::array<std::uint32_t, 4>;

// The largest extent along an axis and the largest number of texels that Tessera accepts. The bytes
// of any box then fit 64 bits.
constexpr std::uint32_t max_extent = 1u << 20;
constexpr std::uint64_t max_texels = 1ull << 48;

// The product of the extents. Exact for extents accepted by check_desc().
constexpr std::uint64_t texel_count(const Extent4& e) {
    return std::uint64_t{e[0]} * e[1] * e[2] * e[3];
}

std::string to_string(const Extent4& extent); // "512x256x32x32"

// A half-open box of texels: begin[axis] <= coordinate < end[axis].
struct Box4 {
    Extent4 begin{0, 0, 0, 0};
    Extent4 end{0, 0, 0, 0};

    static Box4 whole(const Extent4& e) { return {{0, 0, 0, 0}, e}; }
    static Box4 of_texel(const Extent4& at) {
        return {at, {at[0] + 1, at[1] + 1, at[2] + 1, at[3] + 1}};
    }
    Extent4 extent() const {
        return {end[0] - begin[0], end[1] - begin[1], end[2] - begin[2], end[3] - begin[3]};
    }
    std::uint64_t texels() const { return texel_count(extent()); }
    // The index of a texel of this box among the dense texels of the box.
    std::uint64_t index_of(const Extent4& at) const {
        const Extent4 n = extent();
        const std::uint64_t place =
            std::uint64_t{at[axis_v] - begin[axis_v]} * n[axis_u] + (at[axis_u] - begin[axis_u]);
        return (place * n[axis_t] + (at[axis_t] - begin[axis_t])) * n[axis_s] +
               (at[axis_s] - begin[axis_s]);
    }
    bool operator==(const Box4&) const = default;
};

std::string to_string(const Box4& box); // "u0:u1,v0:v1,s0:s1,t0:t1"
// end == begin along axes on which the boxes do not overlap.
Box4 intersect(const Box4& a, const Box4& b);
// Whether begin < end <= extent along every axis.
bool is_inside(const Box4& box, const Extent4& extent);

struct TextureDesc {
    Extent4 size{0, 0, 0, 0};
    SampleType type = SampleType::unorm8;
    std::uint8_t channels = 3; // 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha

    std::size_t texel_bytes() const { return channels * sample_bytes(type); }
    std::uint64_t box_bytes(const Box4& box) const { return box.texels() * texel_bytes(); }
    bool operator==(const TextureDesc&) const = default;
};

// Errors: bad_argument (an extent of 0 or above max_extent, more than max_texels texels, channels
// outside 1..4, an unknown sample type).
Status check_desc(const TextureDesc& desc);
// Checks that `box` lies in the texture and that a buffer of `bytes` bytes holds exactly its
// texels. Errors: bad_argument.
Status check_box(const TextureDesc& desc, const Box4& box, std::size_t bytes);

// The order in which a source or a sink should be walked, so that it holds only a part of the
// texture in memory. A driver that is short of memory cuts slabs further (codec/texels/slabs.h).
enum class Locality {
    any,           // every box costs the same (raw files, memory, a baker)
    spatial_rows,  // slabs of all u, s, t and a few v (scanline mosaics)
    angular_cells, // slabs of all u, v and a few s, t (one picture per view)
    places,        // slabs of all s, t and some u, v (raw files; only for sinks)
};

// Provides texels.
//
// The driver calls begin_slab(box), then read() for boxes inside the slab from several threads at
// once, then begin_slab() for the next slab, and so on. Slabs do not overlap and follow locality().
// A source that does not need slabs keeps the default begin_slab().
class TexelSource {
public:
    virtual ~TexelSource() = default;
    virtual const TextureDesc& desc() const = 0;
    virtual Locality locality() const { return Locality::any; }
    // Whether reading a box again costs little. It does not for a baker, which returns false.
    virtual bool cheap_to_reread() const { return true; }
    virtual Status begin_slab(const Box4&) { return {}; }
    // Fills `out`, which has exactly desc().box_bytes(box) bytes. Thread-safe.
    virtual Status read(const Box4& box, std::span<std::byte> out) = 0;
};

// Receives texels. The driver calls begin_slab(box), then write() for disjoint boxes inside the
// slab from several threads at once, then end_slab(), and so on; at the end it calls finish() once.
// After that the output exists under its final name. A sink that is destroyed without finish()
// leaves nothing behind.
class TexelSink {
public:
    virtual ~TexelSink() = default;
    virtual Locality locality() const { return Locality::any; }
    virtual Status begin_slab(const Box4&) { return {}; }
    virtual Status write(const Box4& box, std::span<const std::byte> texels) = 0;
    virtual Status end_slab() { return {}; }
    virtual Status finish() { return {}; }
};

// Copies the texels of `part`, which lies in both boxes, from the dense texels of `from_box` to
// those of `to_box`.
void copy_box(const Box4& part, const Box4& from_box, std::span<const std::byte> from,
              const Box4& to_box, std::span<std::byte> to, std::size_t texel_bytes);

// A source of texels in memory. The caller keeps the dense texels of the whole texture alive.
// Thread-safe.
class MemorySource : public TexelSource {
public:
    MemorySource(const TextureDesc& desc, std::span<const std::byte> texels)
        : desc_(desc), texels_(texels) {}
    const TextureDesc& desc() const override { return desc_; }
    // Errors: bad_argument (the box, `out` or the texels do not fit the texture).
    Status read(const Box4& box, std::span<std::byte> out) override;

private:
    TextureDesc desc_;
    std::span<const std::byte> texels_;
};

} // namespace tessera
