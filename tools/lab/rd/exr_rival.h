// OpenEXR's lossy DWAA, through the library that the tool links anyway.
#pragma once

#include "tools/lab/rd/codec_under_test.h"

namespace tessera {

// All views in one picture, view (s,t) at s * U, t * V: neighbours in it are neighbours on the
// surface. `setting`: "level 1000", OpenEXR's dwaCompressionLevel. 8-bit samples as halves of
// value/255. Times include writing and reading the file.
Result<Coded> code_exr_mosaic(const CodingJob& job, const std::string& setting);

} // namespace tessera
