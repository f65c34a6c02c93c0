// PNG and JPEG files of 8-bit samples.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

struct PixelSize {
    std::uint32_t width = 0, height = 0; // pixels
    std::uint8_t channels = 0;           // 1..4: grey, grey + alpha, RGB, RGB + alpha
    std::size_t row_bytes() const { return std::size_t{width} * channels; }
};

// The bytes of a file. `pixels` holds height * row_bytes() bytes, rows from the top. Errors:
// bad_argument, runtime.
Result<std::vector<std::byte>> encode_png(const PixelSize& size, std::span<const std::byte> pixels);

// `channels` is 1 or 3, `quality` 1..100; colour keeps its full resolution. Errors: bad_argument,
// unsupported (a side above 65500), runtime.
Result<std::vector<std::byte>> encode_jpeg(const PixelSize& size, std::span<const std::byte> pixels,
                                           int quality);

} // namespace tessera
