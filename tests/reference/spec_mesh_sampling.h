// Sampling on a mesh, written from FORMAT.md 5.2 alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tessera_reference {

using Vector = std::array<double, 3>;

struct Frame {
    Vector ex, ey, ez;
};

struct Tap {
    std::uint32_t texel[4]; // u, v, s, t
    double weight;
};

// The position (s, t) of the direction d. angular_map is 3 or 4.
std::array<double, 2> place_of_direction(int angular_map, const Frame& frame, const Vector& d);
Vector direction_of_place(int angular_map, const Frame& frame, double s, double t);

// The 16 texels, with weights, that show (u, v) from direction d.
std::array<Tap, 16> mesh_taps(const std::uint32_t size[4], int angular_map, const Frame& frame,
                              double u, double v, const Vector& d);

// The charts that the texels of an atlas show, for "Mips" in FORMAT.md 5.2.
struct AtlasTriangle {
    std::uint32_t vertices[3];
    double uv[3][2];
};

class Charts {
public:
    Charts(const std::vector<AtlasTriangle>& triangles, std::uint32_t width, std::uint32_t height);
    // The number of the chart's first triangle, or -1 if the texel shows none.
    long shown_by(unsigned mip, std::uint32_t x, std::uint32_t y) const;
    std::array<std::uint32_t, 2> size(unsigned mip) const;

private:
    std::uint32_t width_, height_;
    std::vector<long> texels_; // of mip 0
};

struct MipTaps {
    unsigned mip; // the mip that was sampled; 0 if the requested one shows other charts
    std::array<Tap, 16> taps;
};
MipTaps mip_taps(const Charts& charts, const std::uint32_t size[4], int angular_map,
                 const Frame& frame, double u, double v, const Vector& d, unsigned mip);

// How often tiles can be halved along an axis. `begins` are the first texels of the tiles.
unsigned mips_of(const std::vector<std::uint32_t>& begins);
double mip_of_pixel(double a, double b, unsigned mips);

} // namespace tessera_reference
