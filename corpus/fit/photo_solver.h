// Finds the texture fields that explain photographs best, on any surface, and what is wrong with the
// photographs.
#pragma once

#include "corpus/fit/photo_corrections.h"

#include <optional>
#include <span>
#include <vector>

namespace tessera::corpus {

struct PhotoSolveOptions {
    // How alike neighbours are kept: 1 suits most; higher is smoother. 0: chosen by keeping every
    // fifth photograph out of trial fits.
    double smoothness = 0;
    unsigned iterations = 40;
    PixelFilter filter;
    std::optional<glm::dvec3> background; // display values; absent: looked for at the borders
    // Whether exposures, poses and outliers are estimated.
    bool corrects = true;
    BakeRun run;
};

// What a fit found out, besides the texture.
struct PhotoFindings {
    std::optional<glm::dvec3> background;
    double smoothness = 0;
    std::size_t pixels = 0;                   // that were fitted
    std::vector<PhotoDifference> differences; // of each photograph, before its correction
    std::vector<std::size_t> left_out;        // photographs that fit none of the others
    double error = 0;                         // root mean square of the fitted pixels
};

// The fields whose sum an observer sees. The first one has a single direction.
class FittedFields {
public:
    virtual ~FittedFields() = default;
    std::vector<TextureField> fields;
    // Set by solve_photographs(): of each field, the texels that a photograph shows.
    std::vector<std::vector<bool>> seen;
    // Sets the costs of neighbours in all fields.
    virtual void set_costs(const PhotoSamples& samples, double smoothness) = 0;
    // How many rays a fit may trace, and how many pixels it may use. More takes longer.
    double most_samples = 16e6, most_pixels = 4e6;
    // Along each side of a pixel. With 1, rays go through the middle of the pixel.
    unsigned least_rays = 2, most_rays = 4;
};

// Fits all fields to the photographs. The result depends only on the arguments, not on the number of
// threads. Errors: those of trace_photographs() and solve_least_squares(); bad_argument (no
// photograph, an option out of its range, no pixel that counts).
Result<PhotoFindings> solve_photographs(const SeenSurface& surface, FittedFields& fields,
                                        std::span<const PosedPhotograph> photographs,
                                        const PhotoSolveOptions& options);

// Fits without every fifth photograph and returns the median of the errors with which these are
// predicted; 0 if there are fewer than three photographs. Takes half the pixels and iterations of a
// fit. Errors: those of trace_photographs() and solve_least_squares().
Result<double> error_of_trial(const SeenSurface& surface, FittedFields& fields,
                              std::span<const PosedPhotograph> photographs,
                              const PhotoSolveOptions& options, const char* stage);

} // namespace tessera::corpus
