// Converts views to 8-bit pictures and writes them as PNG or EXR files.
#pragma once

#include "format/texture.h"
#include "tools/picture/picture.h"
#include "tools/view/view_renderer.h"

#include <string>

namespace tessera {

// The view as displayed with 8 bits. `type` is the texture's sample type: unorm8 is clamped to 0..1
// and rounded, half16 is tone-mapped (picture.h).
Picture to_picture(const View& view, SampleType type);

// Writes a .png file with the result of to_picture(), or an .exr file with linear RGB as 32-bit
// floats. The file appears under its name only when it is complete. Errors: bad_argument (another
// extension), io, runtime.
Status write_view(const std::string& path, const View& view, SampleType type);
// Errors: bad_argument (another extension) and those of check_output_path().
Status check_view_path(const std::string& path);

} // namespace tessera
