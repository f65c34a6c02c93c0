// The decoded views of a tile, displaced by whole and half texels, beside its source: measures the
// error of copies.
#pragma once

#include "codec/search_kernels/forward_dct.h"
#include "format/tile/prediction.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// Squared errors are in codes. Holds scratch memory: one per thread.
class DisplacedViews {
public:
    // Takes plane 0 of a tile's source, in codes and tile order, and the same decoded, of which a
    // value is `unit` codes. smooth: the filter of the file's copies.
    void begin(const BlockShape& tile, const std::vector<float>& source,
               const std::vector<std::int32_t>& reconstructed, float unit, bool smooth);

    // The angular cell that follows is about, and along which axis (0 s, 1 t) it copies.
    void enter(int direction, const Segment& s, const Segment& t) {
        direction_ = direction;
        s_ = s;
        t_ = t;
    }
    // The error of a spatial cell. Stops early: above `enough` it may return a lower bound.
    float error(const Displacement& d, const Segment& u, const Segment& v, float enough) const;
    // The errors of all spatial cells, u fastest, `stride` floats apart.
    void errors(const Displacement& d, const std::array<std::vector<Segment>, 2>& cells, float* to,
                std::size_t stride);

private:
    void make_phases(const std::vector<std::int32_t>& reconstructed, float unit, bool smooth);
    template <class Visit>
    void for_each_view(const Displacement& d, int first_u, const Visit& visit) const;

    BlockShape tile_;
    int direction_ = 0;
    Segment s_, t_;
    // The source in units as fine as its texels allow, and the square of one in codes.
    std::vector<std::int16_t> source_;
    float squared_unit_ = 1;
    // The decoded plane in the same units at whole and half texels: [half along v][half along u].
    // Rows reach a tile's width past both edges.
    std::array<std::array<std::vector<std::int16_t>, 2>, 2> phase_;
    std::vector<float> sums_;
};

} // namespace tessera
