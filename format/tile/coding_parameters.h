// Section CODE (FORMAT.md 3.5): everything that a decoder needs besides the header and a tile's
// bytes.
#pragma once

#include "format/status.h"
#include "format/tile/base_picture.h"
#include "format/tile/code_tables.h"
#include "format/tile/dequantizer.h"
#include "format/tile/scan_order.h"
#include "format/tile/tile_filter.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

struct CodingParameters {
    // Not an aggregate: GCC 12 destroys members of a default member twice if a later one throws.
    CodingParameters() {}

    std::array<StepCode, max_planes> step{}; // per plane
    StepCode rotated_step;                   // of planes 0 to 2 of blocks with rotated colour
    bool colour_rotation = false;            // blocks have colour symbols (3 or 4 planes)
    bool prediction = false;                 // blocks have prediction symbols (required feature 4)
    bool leaves_out_transforms = false; // of axes of blocks (required feature 8); with prediction
    // A block's transform symbol follows the length of its first plane that has one, not that of plane
    // 0 (required feature 9); with prediction.
    bool transforms_any_plane = false;
    // Each plane of a tile of one view may have a split tree of its own (required feature 10); with
    // prediction, in files of two planes.
    bool plane_trees = false;
    bool smooth_copies = false; // copies use the smooth filter of 4.6; only with prediction
    BasePictures base;          // only with prediction
    TileFilter filter;          // of decoded tiles
    bool dependent = false;     // dependent quantisation, see format/tile/code_tables.h
    std::array<ReconstructionOffsets, plane_classes> offsets{};
    ScanWeights scan_weights = default_scan_weights;
    std::uint16_t correction_error = 0;      // E of FORMAT.md 3.6, in sample codes
    DefaultSet defaults = DefaultSet::views; // which parameters are stored as differences
    Parameters parameters = default_parameters();

    void use_defaults(DefaultSet set) {
        defaults = set;
        parameters = default_parameters(set);
    }
};

// The bytes of section CODE of a file with 1..4 planes. It leaves out what such a file does not use:
// the steps and offsets of other planes, the rotated step without colour_rotation, the correction
// error without `corrections` (required feature 1), and parameters that have their defaults.
std::vector<std::byte> write_coding_parameters(const CodingParameters& coding, int planes,
                                               bool corrections);

// The inverse. What the section leaves out keeps its default. Errors: invalid_file, which names the
// field.
Result<CodingParameters> read_coding_parameters(std::span<const std::byte> bytes, int planes,
                                                bool corrections);

// The parameters of a coarse level, with every step multiplied by 2^step_shift (FORMAT.md 1.5).
// Errors: invalid_file if a step would be too large.
Result<CodingParameters> with_coarser_steps(CodingParameters coding, unsigned step_shift);

// The required features that the header of a file with such a section CODE announces for it.
std::uint64_t features_of(const CodingParameters& coding);

// Checks that section CODE uses the tools that the header announces. Errors: invalid_file.
Status check_features(const CodingParameters& coding, std::uint64_t required_features);

} // namespace tessera
