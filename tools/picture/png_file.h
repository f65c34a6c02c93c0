// One PNG picture. Read: any kind, as grey, grey + alpha, RGB or RGB + alpha; palettes and colours that
// mean "transparent" are resolved, fewer than 8 bits spread. Written: 8 bits. No gamma.
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
    std::uint8_t bits = 8;     // 8 or 16
    bool operator==(const PngShape&) const = default;
    // Of 8-bit rows, whatever `bits`.
    std::size_t row_bytes() const { return std::size_t{width} * channels; }
};

// Reads what stands before the pixels, and the end. Errors: io; invalid_file, also where the file is cut
// off, or much too short for its pixels.
Result<PngShape> read_png_shape(ByteSource& file);
Result<PngShape> read_png_shape(const std::string& path);

// Samples of 16 bits become the nearest of 8, or are handed on as they are, in the machine's order of bytes.
enum class PngSamples { eight, as_they_are };

// Calls row(y, bytes) for the first `rows` rows from the top. The picture must have this shape.
Status read_png(ByteSource& file, const PngShape& shape, std::uint32_t rows,
                const std::function<void(std::uint32_t, std::span<const std::byte>)>& row,
                PngSamples samples = PngSamples::eight);
Status read_png(const std::string& path, const PngShape& shape, std::uint32_t rows,
                const std::function<void(std::uint32_t, std::span<const std::byte>)>& row);

// `pixels` holds height * row_bytes() bytes.
Result<std::vector<std::byte>> encode_png(const PngShape& shape, std::span<const std::byte> pixels);

} // namespace tessera
