// The kinds of pictures that textures are written to: PNG, JPEG and EXR.
#pragma once

#include "corpus/picture_file.h"
#include "format/texture.h"
#include "tools/picture/picture_encoders.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace tessera {

// From the ending of a name, in either case: .png, .jpg, .jpeg or .exr; else none.
corpus::PictureKind picture_kind_of_name(std::string_view name);

// Whether the kind can hold such samples. PNG and JPEG hold unorm8 only, JPEG holds no alpha.
// Errors: unsupported.
Status check_picture_kind(corpus::PictureKind kind, SampleType type, std::uint8_t channels);

// The bytes of a file with these samples, rows from the top. Errors: unsupported, runtime.
Result<std::vector<std::byte>> encode_picture(corpus::PictureKind kind, const PixelSize& size,
                                              SampleType type, std::span<const std::byte> samples);

} // namespace tessera
