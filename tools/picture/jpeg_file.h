// One JPEG picture: grey or RGB, 8 bits a sample. Turning marks of cameras (EXIF) are not followed.
#pragma once

#include "format/byte_source.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace tessera {

struct JpegShape {
    std::uint32_t width = 0, height = 0;
    std::uint8_t channels = 0; // 1 or 3
    bool operator==(const JpegShape&) const = default;
    std::size_t row_bytes() const { return std::size_t{width} * channels; }
};

// Reads what stands before the pixels, and looks for the mark at the end. Errors: io; invalid_file,
// also where the file is cut off; unsupported (CMYK, progressive and too large to be held).
Result<JpegShape> read_jpeg_shape(ByteSource& file);

// Calls row(y, bytes) for the first `rows` rows from the top. The picture must have this shape. What
// other programs show as grey after some damage is an error here. Errors: those above; runtime,
// when interrupted.
Status read_jpeg(ByteSource& file, const JpegShape& shape, std::uint32_t rows,
                 const std::function<void(std::uint32_t, std::span<const std::byte>)>& row);

// `pixels` holds height * row_bytes() bytes; `quality` is 1..100. Colour is kept at full resolution.
// Errors: bad_argument, unsupported (a side above 65500), runtime.
Result<std::vector<std::byte>> encode_jpeg(const JpegShape& shape,
                                           std::span<const std::byte> pixels, int quality);

} // namespace tessera
