// FORMAT.md 5.2, "Sampling on a mesh", written from that text alone.
#pragma once

#include <array>
#include <cstdint>

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

} // namespace tessera_reference
