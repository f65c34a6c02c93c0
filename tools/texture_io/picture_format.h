// The kinds of pictures by the endings of their names, and those that textures are written to: PNG,
// JPEG and EXR.
#pragma once

#include "corpus/picture_file.h"
#include "format/texture.h"
#include "tools/picture/picture_encoders.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// The endings of pictures that can be read, for messages.
inline constexpr const char* picture_endings =
    ".png, .jpg, .exr, .tif, .webp, .ppm, .pgm, .pfm, .bmp or .hdr";

// From the ending of a name, in either case; none for others than those.
corpus::PictureKind picture_kind_of_name(std::string_view name);

// The name with an ending of a kind that can be written: .png or, for floats, .exr instead of others.
std::string writable_picture_name(const std::string& name, SampleType type);

// Whether the kind can be written and hold such samples. PNG and JPEG hold unorm8 only, JPEG holds
// no alpha. Errors: unsupported.
Status check_picture_kind(corpus::PictureKind kind, SampleType type, std::uint8_t channels);

// The bytes of a file with these samples, rows from the top. Errors: unsupported, runtime.
Result<std::vector<std::byte>> encode_picture(corpus::PictureKind kind, const PixelSize& size,
                                              SampleType type, std::span<const std::byte> samples);

} // namespace tessera
