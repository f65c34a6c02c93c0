// The coding parameters of a file, with tables per block shape that are built on first use.
#pragma once

#include "format/texture.h"
#include "format/tile/block_colour.h"
#include "format/tile/coding_parameters.h"

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <utility>
#include <vector>

namespace tessera {

// Tables for coding blocks of one shape. Thread-safe; some are computed on first use.
class ShapeCoding {
public:
    ScanOrder order;
    const ScanNeighbours& neighbours() const {
        std::call_once(has_neighbours_, [this] { neighbours_ = find_neighbours(order); });
        return neighbours_;
    }
    // The index of each entry of `order` in a dense block, u fastest.
    const std::vector<std::uint32_t>& places() const {
        std::call_once(has_places_, [this] { places_ = find_places(order); });
        return places_;
    }
    std::array<ScaleSet, max_planes> scales;
    ScaleSet rotated_scales; // for the first three planes of blocks with rotated colour

private:
    mutable std::once_flag has_neighbours_;
    mutable ScanNeighbours neighbours_; // only encoders need them
    mutable std::once_flag has_places_;
    mutable std::vector<std::uint32_t> places_; // only encoders need them
    static std::vector<std::uint32_t> find_places(const ScanOrder& order);
};

constexpr int plane_class(int plane) {
    return plane == 0 ? 0 : 1;
}

// Thread-safe. Immutable apart from the cache of shapes. References from shape() stay valid.
class TileCoding {
public:
    TileCoding(const CodingParameters& parameters, SampleType type, int planes);

    const ShapeCoding& shape(const BlockShape& shape) const;
    // The coding of one plane as if it were a file of its own.
    const TileCoding& of_plane(int plane) const;

    const CodingParameters parameters;
    const CodeTables tables;
    const SampleType type;
    const int planes;    // one per channel
    const bool rotates;  // blocks carry a colour symbol
    const bool predicts; // blocks carry a prediction

    // The tables that levels of a plane of a block are coded with; the plane of a block that has only
    // one is 0.
    int table_class(int plane) const { return parameters.plane_trees ? 0 : plane_class(plane); }

    const ScaleSet& scales(const ShapeCoding& shape, int plane, BlockColour colour) const {
        return colour.is_rotated() && plane < 3 ? shape.rotated_scales
                                                : shape.scales[static_cast<std::size_t>(plane)];
    }

private:
    mutable std::shared_mutex mutex_;
    mutable std::map<BlockShape, std::unique_ptr<ShapeCoding>> shapes_;
    mutable std::array<std::once_flag, max_planes> has_plane_;
    mutable std::array<std::unique_ptr<const TileCoding>, max_planes> of_plane_;
};

// The shapes that one thread has used. A tile has few, and the shared cache takes a lock.
class RecentShapes {
public:
    const ShapeCoding& get(const TileCoding& coding, const BlockShape& shape) {
        for (const auto& [known, found] : recent_)
            if (known == shape)
                return *found;
        recent_.emplace_back(shape, &coding.shape(shape));
        return *recent_.back().second;
    }
    void clear() { recent_.clear(); }

private:
    std::vector<std::pair<BlockShape, const ShapeCoding*>> recent_;
};

} // namespace tessera
