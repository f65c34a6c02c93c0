// FORMAT.md 5.2, "Sampling on a mesh", written from that text alone.
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

// (s, t) of the direction d; angular_map is 3 or 4.
std::array<double, 2> place_of_direction(int angular_map, const Frame& frame, const Vector& d);
Vector direction_of_place(int angular_map, const Frame& frame, double s, double t);

// The 16 texels seen at (u, v) from direction d.
std::array<Tap, 16> mesh_taps(const std::uint32_t size[4], int angular_map, const Frame& frame,
                              double u, double v, const Vector& d);

// "Mips": which chart each texel of an atlas shows, and the texels sampled in one mip.
struct AtlasTriangle {
    std::uint32_t vertices[3];
    double uv[3][2];
};

class Charts {
public:
    Charts(const std::vector<AtlasTriangle>& triangles, std::uint32_t width, std::uint32_t height);
    // -1, or the number of the chart's first triangle.
    long shown_by(unsigned mip, std::uint32_t x, std::uint32_t y) const;
    std::array<std::uint32_t, 2> size(unsigned mip) const;

private:
    std::uint32_t width_, height_;
    std::vector<long> texels_; // of mip 0
};

struct MipTaps {
    unsigned mip; // that was sampled after all
    std::array<Tap, 16> taps;
};
MipTaps mip_taps(const Charts& charts, const std::uint32_t size[4], int angular_map,
                 const Frame& frame, double u, double v, const Vector& d, unsigned mip);

// How often tiles that begin at these texels, along one axis, can be halved.
unsigned mips_of(const std::vector<std::uint32_t>& begins);
double mip_of_pixel(double a, double b, unsigned mips);

} // namespace tessera_reference
