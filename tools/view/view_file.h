// Views as pictures: on the screen, as PNG, as EXR.
#pragma once

#include "format/texture.h"
#include "tools/picture/picture.h"
#include "tools/view/view_renderer.h"

#include <string>

namespace tessera {

// As displayed, 8 bits: unorm8 rounded and clamped to 0..1, half16 tone-mapped (picture.h).
Picture to_picture(const View& view, SampleType type);

// By the name's ending: .png, as to_picture() shows it; .exr, the RGB values themselves as 32-bit
// floats. Appears under that name when it is whole. Errors: bad_argument for another ending; io,
// runtime.
Status write_view(const std::string& path, const View& view, SampleType type);
Status check_view_path(const std::string& path);

} // namespace tessera
