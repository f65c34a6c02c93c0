// How far drawn pictures are from photographs.
#pragma once

#include "codec/metrics.h"
#include "corpus/photographs/photograph.h"

#include <optional>
#include <string>
#include <vector>

namespace tessera {

// One photograph beside a drawn picture.
struct ComparedPhotograph {
    std::string name;
    double mse = 0;             // of codes of 8 bits
    double weight = 0;          // pixels that count
    std::optional<double> ssim; // absent where a mask leaves pixels out
    double psnr() const { return psnr_of(mse, 255); }
};

struct PhotographFigures {
    double psnr = 0, worst_psnr = 0; // mean over the photographs
    double pixel_psnr = 0;           // of the mean error of all pixels
    std::string worst;
    std::optional<double> ssim;
};

// "R,G,B" in 0..1, white or black; "": black. Errors: bad_argument.
Result<glm::dvec3> parse_background(const std::string& text);

// Compares 8-bit codes of pictures of the same size. The result has no name.
ComparedPhotograph compare_pixels(const corpus::PhotoPixels& photograph,
                                  const corpus::PhotoPixels& drawn);

// Precondition: there are photographs.
PhotographFigures figures_of(const std::vector<ComparedPhotograph>& photographs);

// A table with a row for each photograph and the means, to standard output. `heading` is that of the
// names.
void print_photographs(const char* heading, const PhotographFigures& figures,
                       const std::vector<ComparedPhotograph>& photographs);

} // namespace tessera
