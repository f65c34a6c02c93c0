// One 8-bit PNG picture: grey, grey + alpha, RGB or RGB + alpha. Values pass through untouched; no
// gamma, no palette, no 16 bits.
#pragma once

#include "format/byte_source.h"
#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

struct PngShape {
    std::uint32_t width = 0, height = 0;
    std::uint8_t channels = 0; // 1..4
    bool operator==(const PngShape&) const = default;
    std::size_t row_bytes() const { return std::size_t{width} * channels; }
};

// Reads the first 29 bytes. Errors: io, invalid_file, unsupported (palette, other bit depths).
Result<PngShape> read_png_shape(ByteSource& file);
Result<PngShape> read_png_shape(const std::string& path);

// Calls row(y, bytes) for the first `rows` rows from the top. The picture must have this shape.
Status read_png(ByteSource& file, const PngShape& shape, std::uint32_t rows,
                const std::function<void(std::uint32_t, std::span<const std::byte>)>& row);
Status read_png(const std::string& path, const PngShape& shape, std::uint32_t rows,
                const std::function<void(std::uint32_t, std::span<const std::byte>)>& row);

// `pixels` holds height * row_bytes() bytes.
Result<std::vector<std::byte>> encode_png(const PngShape& shape, std::span<const std::byte> pixels);

} // namespace tessera
