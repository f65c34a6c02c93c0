#include "codec/reconstruct/tile_filter.h"

#include "codec/kernels/kernels.h"
#include "codec/tile/padded_plane.h"

namespace tessera {
namespace {

FilterTaps taps_of(const TileCoding& coding, int plane) {
    FilterTaps taps{};
    const auto& rings = coding.parameters.filter.ring[static_cast<std::size_t>(plane_class(plane))];
    for (std::size_t i = 0; i < filter_rings; ++i) {
        taps.strength[i] = rings[i].strength;
        taps.slope[i] = filter_slope(
            rings[i], coding.parameters.step[static_cast<std::size_t>(plane)], coding.type);
    }
    return taps;
}

template <class Value, class Kernel>
void filter_planes(const TileCoding& coding, Kernel kernel, std::vector<Value>& memory,
                   TilePlanes& planes) {
    const int page = planes.shape.n[0] * planes.shape.n[1];
    PaddedPlane<Value> padded(memory);
    for (int plane = 0; plane < coding.planes; ++plane) {
        std::int32_t* values = planes.plane[static_cast<std::size_t>(plane)].data();
        if (!padded.fill(planes.shape, values, value_limit(coding.type)))
            continue;
        const FilterTaps taps = taps_of(coding, plane);
        padded.for_each_band([&](int view, int first, const FilterView<Value>& in) {
            kernel(in, taps, values + view * page + first * planes.shape.n[0]);
        });
    }
}

} // namespace

void filter_tile(const TileCoding& coding, FilterScratch& scratch, TilePlanes& planes) {
    if (!coding.parameters.filter.is_on())
        return;
    switch (coding.type) { // each kernel has the constants of one type
    case SampleType::unorm8:
        return filter_planes(coding, kernels().filter_view, scratch.narrow, planes);
    case SampleType::half16:
        return filter_planes(coding, kernels().filter_wide_view, scratch.wide, planes);
    }
}

} // namespace tessera
