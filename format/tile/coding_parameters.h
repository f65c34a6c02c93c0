// Everything a decoder needs besides a tile's own bytes: the section CODE (FORMAT.md 3.5, 4.1).
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
    std::array<StepCode, max_planes> step{};
    StepCode rotated_step;        // of the first three planes of blocks with rotated colour
    bool colour_rotation = false; // blocks say which colour axes they use (3 or 4 planes)
    bool prediction = false;      // blocks say what they copy (required feature 4)
    bool smooth_copies = false; // copies go through the smooth filter of 4.6; with prediction only
    BasePictures base;          // with prediction only
    TileFilter filter;          // of the decoded tile
    bool dependent = false;     // levels depend on the ones before: format/tile/code_tables.h
    std::array<ReconstructionOffsets, plane_classes> offsets{};
    ScanWeights scan_weights = default_scan_weights;
    std::uint16_t correction_error = 0; // E of 3.6, in sample codes; used with corrections
    Parameters parameters = default_parameters();
};

// The section's bytes. Parameters are coded as differences to the built-in defaults.
std::vector<std::byte> write_coding_parameters(const CodingParameters& coding);

// Errors: invalid_file, with the field.
Result<CodingParameters> read_coding_parameters(std::span<const std::byte> bytes);

// Those of a coarse level: every step times 2^step_shift (FORMAT.md 1.4). Errors: invalid_file, where
// that is more than a step can be.
Result<CodingParameters> with_coarser_steps(CodingParameters coding, unsigned step_shift);

// What the header says of the file's tools must be what the section says. Errors: invalid_file.
Status check_features(const CodingParameters& coding, std::uint64_t required_features);

} // namespace tessera
