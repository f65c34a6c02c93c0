#include "codec/tile/tile_coding.h"

#include "codec/tile/tile_planes.h"

#include <mutex>

namespace tessera {

std::vector<std::uint32_t> ShapeCoding::find_places(const ScanOrder& order) {
    std::vector<std::uint32_t> places;
    places.reserve(order.entry.size());
    for (const auto& [k] : order.entry)
        places.push_back(
            static_cast<std::uint32_t>(plane_index(order.shape, k[0], k[1], k[2], k[3])));
    return places;
}

TileCoding::TileCoding(const CodingParameters& coding_parameters, SampleType sample_type,
                       int plane_count)
    : parameters(coding_parameters),
      tables(coding_parameters.parameters, coding_parameters.leaves_out_transforms),
      type(sample_type), planes(plane_count),
      rotates(coding_parameters.colour_rotation && plane_count >= 3),
      predicts(coding_parameters.prediction) {}

const ShapeCoding& TileCoding::shape(const BlockShape& shape) const {
    {
        const std::shared_lock lock(mutex_);
        if (const auto found = shapes_.find(shape); found != shapes_.end())
            return *found->second;
    }
    auto made = std::make_unique<ShapeCoding>();
    made->order = make_scan_order(shape, parameters.scan_weights);
    for (int plane = 0; plane < planes; ++plane)
        made->scales[plane] =
            make_scales(parameters.step[plane], shape, type, parameters.dependent);
    made->rotated_scales = make_scales(parameters.rotated_step, shape, type, parameters.dependent);
    const std::unique_lock lock(mutex_);
    return *shapes_.try_emplace(shape, std::move(made)).first->second;
}

const TileCoding& TileCoding::of_plane(int plane) const {
    const auto p = static_cast<std::size_t>(plane);
    std::call_once(has_plane_[p], [&] {
        CodingParameters own = parameters;
        own.step[0] = parameters.step[p];
        own.offsets[0] = parameters.offsets[static_cast<std::size_t>(plane_class(plane))];
        own.plane_trees = false;
        of_plane_[p] = std::make_unique<const TileCoding>(own, type, 1);
    });
    return *of_plane_[p];
}

} // namespace tessera
