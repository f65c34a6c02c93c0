// Compares photographs with drawn pictures of the same names, as `tessera compare` does.
#pragma once

#include "format/status.h"

#include <optional>
#include <string>

namespace tessera {

struct PhotographComparison {
    // A description of photographs (corpus::read_photographs()), or a folder with their pictures.
    std::string photographs;
    std::string images;     // the folder of its pictures; empty: where the description says
    std::string drawn;      // the folder of the drawn pictures
    std::string background; // "R,G,B" in 0..1, white or black; empty: black
    std::optional<double> min_psnr, min_ssim; // of the means
    unsigned threads = 0;
    bool quiet = false, json = false, strict = false; // strict: warnings are errors
};

// Whether the arguments of the verb are a description of photographs and a folder, and not textures.
bool are_photographs(const std::string& a, const std::string& b);

// Prints PSNR and SSIM of each photograph, and their means. Errors: bad_argument (--background, no
// pictures), difference (a threshold is missed, a drawn picture is missing or has another size), and
// those of reading the pictures.
Status compare_photographs(const PhotographComparison& comparison);

} // namespace tessera
