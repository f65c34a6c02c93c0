// What a 4D texture is, and how texels move: box by box, never the whole texture.
//
// T(u,v,s,t): (u,v) is the place on the surface, (s,t) the direction leaving it.
// Sizes are written UxVxSxT. A box of texels is stored dense in the order v, u, t, s with s fastest
// and the channels of one texel adjacent:
//   index = ((((v - v0) * U' + (u - u0)) * T' + (t - t0)) * S' + (s - s0)) * channels + channel
// Samples are one byte (unorm8) or one IEEE 754 binary16, little-endian (half16).
#pragma once

#include "format/samples.h"
#include "format/status.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace TESSERA_PUBLIC tessera {

// The four axes in the order in which sizes are written.
enum Axis { axis_u = 0, axis_v = 1, axis_s = 2, axis_t = 3 };
constexpr char axis_name(int axis) {
    return "uvst"[axis];
}

// Number of texels along u, v, s, t.
using Extent4 = std::array<std::uint32_t, 4>;

// Largest extent along one axis, and the largest number of texels, that Tessera accepts. The
// product of all four extents and the bytes of any box then fit 64 bits with room to spare.
constexpr std::uint32_t max_extent = 1u << 20;
constexpr std::uint64_t max_texels = 1ull << 48;

// Product of the extents. Exact for extents accepted by check_extent.
constexpr std::uint64_t texel_count(const Extent4& e) {
    return std::uint64_t{e[0]} * e[1] * e[2] * e[3];
}

std::string to_string(const Extent4& extent); // "512x256x32x32"

// Half-open box of texels: begin[axis] <= coordinate < end[axis].
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
    bool operator==(const Box4&) const = default;
};

std::string to_string(const Box4& box);       // "u0:u1,v0:v1,s0:s1,t0:t1"
Box4 intersect(const Box4& a, const Box4& b); // empty (end == begin) where they do not meet
// Whether begin < end on every axis and end fits `extent`.
bool is_inside(const Box4& box, const Extent4& extent);

struct TextureDesc {
    Extent4 size{0, 0, 0, 0};
    SampleType type = SampleType::unorm8;
    std::uint8_t channels = 3; // 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha

    std::size_t texel_bytes() const { return channels * sample_bytes(type); }
    std::uint64_t box_bytes(const Box4& box) const { return box.texels() * texel_bytes(); }
    bool operator==(const TextureDesc&) const = default;
};

// Refuses zero extents, extents above max_extent, products above max_texels, channels outside 1..4.
Status check_desc(const TextureDesc& desc);
// Of a read or write of `box` through a buffer of so many bytes. Errors: bad_argument.
Status check_box(const TextureDesc& desc, const Box4& box, std::size_t bytes);

// How a source or sink likes to be walked, so that it holds a bounded part of the texture.
enum class Locality {
    any,           // every box costs the same (raw files, memory, a baker)
    spatial_rows,  // slabs that span all of u, s, t over a few v (scanline mosaics)
    angular_cells, // slabs that span all of u, v over a few s, t (one picture per view)
    places,        // slabs that span all of s, t over some u, v (raw files; sinks only)
};
// A driver short of memory cuts slabs further (codec/texels/slabs.h): sources get parts of them.

// Somewhere texels come from.
//
// The driver calls begin_slab(box), then read() for boxes inside it from several threads at once,
// then the next begin_slab. Slabs never overlap and follow locality(). A source that does not care
// keeps the default begin_slab.
class TexelSource {
public:
    virtual ~TexelSource() = default;
    virtual const TextureDesc& desc() const = 0;
    virtual Locality locality() const { return Locality::any; }
    // Whether reading a box a second time is cheap (false for a baker).
    virtual bool cheap_to_reread() const { return true; }
    virtual Status begin_slab(const Box4&) { return {}; }
    // Fills `out`, which holds exactly desc().box_bytes(box) bytes. Thread-safe.
    virtual Status read(const Box4& box, std::span<std::byte> out) = 0;
};

// Somewhere texels go. Same protocol; write() is called concurrently for disjoint boxes, and
// finish() once, after which the output exists under its final name. A sink that is destroyed
// without finish() leaves nothing behind.
class TexelSink {
public:
    virtual ~TexelSink() = default;
    virtual Locality locality() const { return Locality::any; }
    virtual Status begin_slab(const Box4&) { return {}; }
    virtual Status write(const Box4& box, std::span<const std::byte> texels) = 0;
    virtual Status end_slab() { return {}; }
    virtual Status finish() { return {}; }
};

// Copies the texels of `part`, which lies in both boxes, from the dense texels of one box to those
// of another.
void copy_box(const Box4& part, const Box4& from_box, std::span<const std::byte> from,
              const Box4& to_box, std::span<std::byte> to, std::size_t texel_bytes);

// Texels in memory as a source. The caller keeps the texels (dense, all of the texture) alive.
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
