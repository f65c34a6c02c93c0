// The places of a surface that photographs show, and the directions in which they show them.
#pragma once

#include "corpus/fit/seen_surface.h"
#include "corpus/layers/rows.h"
#include "corpus/photographs/photograph.h"
#include "corpus/photographs/pixel_filter.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tessera::corpus {

struct PhotoPixel {
    std::uint32_t x, y;          // from the top left corner
    std::uint32_t begin, end;    // its samples; never none
    float coverage;              // the share of its rays that meet the surface, above 0
    std::array<float, 3> colour; // RGB as displayed, without the share of the background
    float weight;                // of its error; 0: it does not count
};

// Pixels of several photographs, photograph by photograph, row by row.
struct PhotoSamples {
    std::vector<PhotoSample> samples;
    std::vector<PhotoPixel> pixels;
    std::vector<std::size_t> first; // pixel of each photograph, and the end
    std::size_t photographs() const { return first.size() - 1; }
    std::span<const PhotoSample> of(const PhotoPixel& pixel) const {
        return {samples.data() + pixel.begin, samples.data() + pixel.end};
    }
};

struct PhotoTraceOptions {
    PixelFilter filter;
    unsigned rays = 2;  // along each side of a pixel
    double share = 1.0; // of the pixels, spread evenly; 0..1
    // Whether rays go through the middle of their parts of the pixel, instead of random places.
    bool is_centred = false;
    // The colour where the surface is not seen, in display values. Without one, pixels count only where
    // the surface covers them and their neighbours.
    std::optional<glm::dvec3> background;
    BakeRun run;
};

// The colour that all borders of some of the photographs have; nothing if they differ. Errors: those
// of read_photograph().
Result<std::optional<glm::dvec3>> common_background(std::span<const PosedPhotograph> photographs);

// Traces rays through all photographs. The result depends only on the arguments. Takes 24 bytes per
// ray that meets the mesh. Errors: those of read_photograph() and for_rows(); bad_argument if no
// photograph sees the surface; unsupported (more than 2^32 samples).
Result<PhotoSamples> trace_photographs(const SeenSurface& surface,
                                       std::span<const PosedPhotograph> photographs,
                                       const PhotoTraceOptions& options);

} // namespace tessera::corpus
